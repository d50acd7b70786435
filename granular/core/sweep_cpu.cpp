// SPDX-License-Identifier: GPL-3.0-or-later
// Time integration on the CPU, a pack of particles at a time, in one pass with the force laws.
#include "granular/core/contact_packs.hpp"
#include "granular/core/sweep.hpp"

namespace hilda::granular {

namespace {

using Float8 __attribute__((vector_size(32))) = float;
using Float4V __attribute__((vector_size(16))) = float;

template <class V, class T>
V as_vector(const T& from)
{
    static_assert(sizeof(V) == sizeof(T));
    V v;
    std::memcpy(&v, &from, sizeof v);
    return v;
}
template <class V, class T>
void add_vector(T& to, const T& term)
{
    const V sum = as_vector<V>(to) + as_vector<V>(term);
    std::memcpy(static_cast<void*>(&to), &sum, sizeof sum);
}
void add(Load& to, const Load& load) { add_vector<Float8>(to, load); }
void add(Float4& to, const Float4& torque) { add_vector<Float4V>(to, torque); }

/// Advances packs of particles.
struct AdvancePacks {
    const AdvanceView& arrays;

    /// Load of a particle from its sums. Action and reaction: F and T of its pairs as j have the opposite
    /// sign; M has the same sign for both particles.
    static void set_total(const Load& as_i, const Load& as_j, Load& to)
    {
        constexpr Float8 sign = {-1, -1, -1, -1, 1, 1, 1, 1};
        const Float8 sum = as_vector<Float8>(as_i) + sign * as_vector<Float8>(as_j);
        std::memcpy(static_cast<void*>(&to), &sum, sizeof sum);
    }
    static void set_total(const Float4& as_i, const Float4& as_j, Float4& to)
    {
        const Float4V sum = as_vector<Float4V>(as_i) - as_vector<Float4V>(as_j);
        std::memcpy(static_cast<void*>(&to), &sum, sizeof sum);
    }

    // The rows of a pack: with `full`, `lanes` consecutive ones in the order of row_of_lane(). Otherwise
    // lanes beyond `valid` repeat the last valid particle and store the same values.
    template <bool full>
    static std::uint32_t row(int k, std::uint32_t valid)
    {
        return full ? static_cast<std::uint32_t>(row_of_lane(k)) : std::min<std::uint32_t>(k, valid - 1);
    }
    template <bool full, class Word, class T>
    static void load4(const T* from, std::uint32_t valid, Word out[4])
    {
        if constexpr (full)
            load_consecutive<Word>(from, out);
        else
            load_rows<Word, T>([&](int k) { return &from[row<full>(k, valid)]; }, out);
    }
    template <bool full, class Word, class T>
    static void store4(T* to, std::uint32_t valid, const Word in[4])
    {
        if constexpr (full)
            store_consecutive(in, to);
        else
            store_rows(in, [&](int k) { return &to[row<full>(k, valid)]; });
    }

    template <bool full>
    void rotate_pack(std::uint32_t first, std::uint32_t valid, const Vec<Pack>& angle) const
    {
        Pack p[4], error[4];
        load4<full>(arrays.orientation + first, valid, p),
            load4<full>(arrays.orientation_compensation + first, valid, error);
        const EulerParameters<Pack> d = rotation_increment(angle, {p[0], {p[1], p[2], p[3]}});
        granular::add(p[0], d.e0, error[0]), granular::add(p[1], d.e.x, error[1]);
        granular::add(p[2], d.e.y, error[2]), granular::add(p[3], d.e.z, error[3]);
        store4<full>(arrays.orientation + first, valid, p),
            store4<full>(arrays.orientation_compensation + first, valid, error);
    }

    /// Advances the particles from `first` on under the loads of the rows of `load` and `torque`, which may
    /// be nullptr. Returns their |v|², 0 for fixed particles.
    template <bool full>
    Pack advance(std::uint32_t first, std::uint32_t valid, const Load* load, const Float4* torques) const
    {
        const Pack zero(0.f);
        Pack F[4] = {zero, zero, zero, zero}, M[4] = {zero, zero, zero, zero},
             T[4] = {zero, zero, zero, zero};
        if (load != nullptr) {
            load_rows<Pack, Float4>([&](int k) { return &load[row<full>(k, valid)].F; }, F);
            load_rows<Pack, Float4>([&](int k) { return &load[row<full>(k, valid)].M; }, M);
        }
        if (torques != nullptr) load4<full>(torques, valid, T);
        if (arrays.force != nullptr && arrays.step.part != Part::before_loads) {
            Pack external[4];
            load_rows<Pack, Float4>(
                [&](int k) { return &arrays.force[arrays.id[first + row<full>(k, valid)]]; }, external);
            for (int k = 0; k < 3; ++k) F[k] += external[k];
        }
        Pack v[4], w[4], a[4] = {zero, zero, zero, zero}, b[4] = {zero, zero, zero, zero};
        Ints compensation[4], at[4];
        load4<full>(arrays.velocity + first, valid, v);
        load4<full>(arrays.omega + first, valid, w);
        load4<full>(arrays.compensation + first, valid, compensation);
        if (arrays.acc != nullptr)
            load4<full>(arrays.acc + first, valid, a), load4<full>(arrays.alpha + first, valid, b);
        ParticleState<Pack> m{
            .v = {v[0], v[1], v[2]},
            .omega = {w[0], w[1], w[2]},
            .v_compensation = {low(compensation[1]), high(compensation[1]), low(compensation[2])},
            .omega_compensation = {high(compensation[2]), low(compensation[3]), high(compensation[3])},
            .remainder = unpack_remainder<Pack>(compensation[0]),
            .radius = v[3],
            .inverse_mass = w[3]};
        Vec<Pack> acc{a[0], a[1], a[2]}, alpha{b[0], b[1], b[2]};
        const Vec<Pack> torque{v[3] * M[0] + T[0], v[3] * M[1] + T[1], v[3] * M[2] + T[2]};
        if (arrays.total != nullptr && arrays.step.part != Part::before_loads) {
            const Pack of_F[4] = {F[0], F[1], F[2], zero}, of_T[4] = {torque.x, torque.y, torque.z, zero};
            store_rows(of_F, [&](int k) { return &arrays.total[first + row<full>(k, valid)].F; });
            store_rows(of_T, [&](int k) { return &arrays.total[first + row<full>(k, valid)].M; });
        }
        const Displacement<Pack> moved =
            advance_particle(arrays.step, m, {F[0], F[1], F[2]}, torque, acc, alpha);

        v[0] = m.v.x, v[1] = m.v.y, v[2] = m.v.z, w[0] = m.omega.x, w[1] = m.omega.y, w[2] = m.omega.z;
        store4<full>(arrays.velocity + first, valid, v);
        store4<full>(arrays.omega + first, valid, w);
        const std::uint32_t dither = arrays.step.velocity_dither;
        const SplitDisplacement<Pack> units =
            split_displacement(moved.translation, arrays.step.displacement_dither);
        const auto half = [&](const Pack& error) { return round_to_bfloat16(error, dither); };
        compensation[0] = units.remainder;
        compensation[1] = halves(half(m.v_compensation.x), half(m.v_compensation.y));
        compensation[2] = halves(half(m.v_compensation.z), half(m.omega_compensation.x));
        compensation[3] = halves(half(m.omega_compensation.y), half(m.omega_compensation.z));
        store4<full>(arrays.compensation + first, valid, compensation);
        if (arrays.acc != nullptr) {
            a[0] = acc.x, a[1] = acc.y, a[2] = acc.z, b[0] = alpha.x, b[1] = alpha.y, b[2] = alpha.z;
            store4<full>(arrays.acc + first, valid, a), store4<full>(arrays.alpha + first, valid, b);
        }
        if (arrays.step.part == Part::whole || arrays.step.part == Part::before_loads) {
            load4<full>(arrays.position + first, valid, at);
            at[1] = at[1] + units.x, at[2] = at[2] + units.y, at[3] = at[3] + units.z;
            store4<full>(arrays.position + first, valid, at);
            if (arrays.orientation != nullptr) rotate_pack<full>(first, valid, moved.rotation);
        }
        Pack v2 = select(w[3] > zero, m.v.dot(m.v), zero);
        // Ghosts are advanced like the others, because a branch costs more, and replaced afterwards.
        if (arrays.ghost != nullptr)
            for (int k = 0; k < lanes; ++k)
                if (arrays.ghost[first + row<full>(k, valid)] != 0) v2.v[k] = 0;
        return v2;
    }

    /// Advances `valid` ≤ lanes particles from `first` on.
    Pack advance(std::uint32_t first, std::uint32_t valid, const Load* load, const Float4* torques) const
    {
        return valid == lanes ? advance<true>(first, valid, load, torques)
                              : advance<false>(first, valid, load, torques);
    }
};

/// Elementwise maximum; NaN if one is NaN
Pack nan_larger(Pack a, Pack b) { return select((b > a) | PackMask{b.v != b.v}, b, a); }

/// Contacts of a part of a block in the order of the pairs
struct Hits {
    static constexpr std::uint32_t most = 1024;  ///< pairs of a part
    static constexpr std::uint32_t size = most + 2 * lanes;

    std::uint32_t n[size], i[size], j[size];                      ///< number of the pair, its particles
    float x[size], y[size], z[size], q[size], d2[size], D[size];  ///< see PackOverlap
    alignas(64) Load load[size];
    alignas(64) Float4 torque[size];
    std::uint32_t count = 0;

    /// A pair whose load was stored before the pass; `before` contacts of the others precede it
    struct StoredContact {
        std::uint32_t before, n;
    } stored[most];
    std::uint32_t stored_count = 0;
};

/// Processes one range of a plan per call.
struct Sweep : detail::ContactPacks {
    const AdvanceView& arrays;
    SweepPlan& plan;
    std::uint32_t particle_count;
    bool rotates = pairs.rotation_history != nullptr;
    bool prefetches = particle_count > 20000;  ///< whether the arrays are larger than the cache of a core

    float operator()(std::uint32_t range) const
    {
        for (std::uint32_t m = plan.early_start[range]; m < plan.early_start[range + 1]; ++m)
            add_to_j(plan.early[m]);
        const std::uint32_t end_of_range =
            std::min(plan.first_block[range + 1] * SweepPlan::block, particle_count);
        Pack largest_v2(0.f);
        Hits hits;
        for (std::uint32_t b = plan.first_block[range]; b < plan.first_block[range + 1]; ++b)
            largest_v2 = nan_larger(largest_v2, process_block(b, end_of_range, hits));
        return largest(largest_v2);
    }

    /// Adds the stored load of a pair to the sums of its particle j.
    void add_to_j(std::uint32_t n) const
    {
        const std::uint32_t slot = pairs.stored.slot(n);
        add(plan.sum_j.data()[pairs.j[n]], pairs.load[slot]);
        if (rotates) add(plan.torque_j.data()[pairs.j[n]], pairs.torque[slot]);
    }

    [[gnu::flatten]] Pack process_block(std::uint32_t number, std::uint32_t end_of_range, Hits& hits) const
    {
        constexpr std::uint32_t size = SweepPlan::block;
        const std::uint32_t begin = number * size, end = std::min(begin + size, particle_count);
        alignas(64) Load sum_i[size] = {};
        alignas(64) Float4 torque_i[size];
        if (rotates) std::fill_n(torque_i, size, Float4{});
        Pack overlaps(0.f);
        const std::uint32_t last = arrays.start[end];
        for (std::uint32_t first = arrays.start[begin]; first < last; first += Hits::most) {
            find_hits(first, std::min(first + Hits::most, last), hits);
            evaluate_hits(hits, overlaps);
            add_hits<Float8>(hits, begin, end_of_range, hits.load, pairs.load, sum_i, plan.sum_j.data());
            if (rotates)
                add_hits<Float4V>(hits, begin, end_of_range, hits.torque, pairs.torque, torque_i,
                                  plan.torque_j.data());
        }
        if (pairs.largest_overlap != nullptr)
            pairs.largest_overlap[number] = larger(pairs.largest_overlap[number], largest(overlaps));
        for (std::uint32_t m = plan.late_start[number]; m < plan.late_start[number + 1]; ++m)
            add_to_j(plan.late[m]);

        const AdvancePacks advance_packs{arrays};
        Pack largest_v2(0.f);
        for (std::uint32_t k = begin; k < end; k += lanes) {
            const std::uint32_t valid = std::min<std::uint32_t>(lanes, end - k);
            Load *const load = sum_i + (k - begin), *const as_j = plan.sum_j.data() + k;
            Float4 *const torque = torque_i + (k - begin), *const torque_as_j =
                                                               rotates ? plan.torque_j.data() + k : nullptr;
            for (std::uint32_t l = 0; l < valid; ++l)
                AdvancePacks::set_total(load[l], as_j[l], load[l]), as_j[l] = {};
            for (std::uint32_t l = 0; l < valid && rotates; ++l)
                AdvancePacks::set_total(torque[l], torque_as_j[l], torque[l]), torque_as_j[l] = {};
            largest_v2 =
                nan_larger(largest_v2, advance_packs.advance(k, valid, load, rotates ? torque : nullptr));
        }
        return largest_v2;
    }

    // find_hits() and evaluate_hits() are functions of their own: within process_block() they have too few
    // registers.

    /// Lists the contacts among the pairs from `begin` on; clears those that have ended.
    [[gnu::noinline, gnu::flatten]] void find_hits(std::uint32_t begin, std::uint32_t end, Hits& hits) const
    {
        if (pairs.image != nullptr) return find_hits_with_images(begin, end, hits);
        list_hits<false>(begin, end, hits);
    }
    [[gnu::noinline, gnu::flatten]] void find_hits_with_images(std::uint32_t begin, std::uint32_t end,
                                                               Hits& hits) const
    {
        list_hits<true>(begin, end, hits);
    }
    template <bool with_images>
    void list_hits(std::uint32_t begin, std::uint32_t end, Hits& hits) const
    {
        hits.count = hits.stored_count = 0;
        for (std::uint32_t first = begin; first < end; first += lanes) {
            const std::uint32_t *i = pairs.i + first, *j = pairs.j + first;
            const std::uint8_t* in_contact = pairs.in_contact + first;
            std::uint32_t copy_i[lanes], copy_j[lanes];
            std::uint8_t copy_contact[lanes] = {}, copy_image[lanes];
            const std::uint8_t* image = with_images ? pairs.image + first : nullptr;
            const std::uint32_t valid = std::min<std::uint32_t>(lanes, end - first);
            if (first + lanes > pairs.count) {  // the last pack of the list
                for (std::uint32_t k = 0; k < lanes; ++k)
                    copy_i[k] = i[std::min(k, valid - 1)], copy_j[k] = j[std::min(k, valid - 1)];
                std::copy_n(in_contact, valid, copy_contact);
                i = copy_i, j = copy_j, in_contact = copy_contact;
                if constexpr (with_images) {
                    for (std::uint32_t k = 0; k < lanes; ++k) copy_image[k] = image[std::min(k, valid - 1)];
                    image = copy_image;
                }
            }
            const unsigned of_range = (2u << (valid - 1)) - 1, before = flags(in_contact) & of_range,
                           ahead = plan.marks_from(first);
            const unsigned near = of_range & ~ahead;
            Ints i_words, j_words;
            std::memcpy(&i_words, i, sizeof i_words), std::memcpy(&j_words, j, sizeof j_words);
            j_words = select(near, j_words, i_words);
            std::uint32_t partner[lanes];
            std::memcpy(partner, &j_words, sizeof partner);
            const Integers found = integers_of<with_images>(i, partner, image);
            const unsigned touching = found.squares.positive() & near;
            if (((touching ^ before) & near) != 0) set_flags(pairs.in_contact + first, touching, near);
            for (unsigned ended = before & near & ~touching; ended != 0; ended &= ended - 1)
                clear_history(first + static_cast<std::uint32_t>(__builtin_ctz(ended)));
            for (unsigned remaining = before & ahead; remaining != 0; remaining &= remaining - 1) {
                const auto k = static_cast<unsigned>(__builtin_ctz(remaining));
                hits.stored[hits.stored_count++] = {
                    hits.count + static_cast<std::uint32_t>(__builtin_popcount(touching & ((1u << k) - 1))),
                    first + k};
            }
            if (touching == 0) continue;
            const std::uint32_t h = hits.count;
            const detail::PackOverlap overlap = found.to_floats();
            if (prefetches) prefetch(partner, first);
            hits.count = h + append(hits.n + h, first, touching);
            compress(hits.i + h, i_words, touching), compress(hits.j + h, j_words, touching);
            compress(hits.x + h, overlap.separation.x, touching);
            compress(hits.y + h, overlap.separation.y, touching);
            compress(hits.z + h, overlap.separation.z, touching);
            compress(hits.q + h, overlap.q, touching), compress(hits.d2 + h, overlap.d2, touching);
            compress(hits.D + h, overlap.D, touching);
        }
    }

    /// Requests what the contacts of a pack of pairs read and is not in the cache of one core: the histories,
    /// and rows of the particles j, which are far from i in memory. Pairs that are not in contact are
    /// included, because branches that the processor cannot predict cost more.
    void prefetch(const std::uint32_t* j, std::uint32_t first) const
    {
        for (std::uint32_t k = 0; k < lanes; k += 64 / sizeof(Float4))
            __builtin_prefetch(pairs.history + first + k, 1);
        for (std::uint32_t k = 0; k < lanes; ++k) {
            __builtin_prefetch(particles.velocity + j[k]), __builtin_prefetch(particles.omega + j[k]);
            __builtin_prefetch(plan.sum_j.data() + j[k], 1);
        }
    }

    [[gnu::noinline, gnu::flatten]] void evaluate_hits(Hits& hits, Pack& overlaps) const
    {
        if (hits.count == 0) return;
        // The last pack repeats the last contact.
        const std::uint32_t last = hits.count - 1;
        for (std::uint32_t h = hits.count; h % lanes != 0; ++h) {
            hits.n[h] = hits.n[last], hits.i[h] = hits.i[last], hits.j[h] = hits.j[last];
            hits.x[h] = hits.x[last], hits.y[h] = hits.y[last], hits.z[h] = hits.z[last];
            hits.q[h] = hits.q[last], hits.d2[h] = hits.d2[last], hits.D[h] = hits.D[last];
        }
        if (pairs.law == nullptr) {
            // The contact points of a few packs, then their laws: within a shorter loop the processor has
            // operations of more than one pack to choose from.
            constexpr std::uint32_t group = 4;
            ContactPoint<Pack> contact[group];
            for (std::uint32_t first = 0; first < hits.count; first += group * lanes) {
                const std::uint32_t end = std::min(first + group * lanes, hits.count);
                for (std::uint32_t h = first; h < end; h += lanes) {
                    const auto pack = [&](const float* from) {
                        Pack p;
                        std::memcpy(&p, from + h, sizeof p);
                        return p;
                    };
                    const detail::PackOverlap overlap{{pack(hits.x), pack(hits.y), pack(hits.z)},
                                                      pack(hits.q),
                                                      pack(hits.d2),
                                                      pack(hits.D)};
                    contact[(h - first) / lanes] =
                        contact_point(laws.law[0], overlap, hits.i + h, hits.j + h, overlaps);
                }
                for (std::uint32_t h = first; h < end; h += lanes)
                    store(evaluate_pack(laws.law[0], contact[(h - first) / lanes], hits.n + h), hits,
                          [&](int k) { return h + static_cast<std::uint32_t>(k); });
            }
            return;
        }
        std::uint32_t all[Hits::most], sorted[Hits::most];
        for (std::uint32_t h = 0; h < hits.count; ++h) all[h] = h;
        detail::by_law(
            laws, [&](std::uint32_t h) { return pairs.law[hits.n[h]]; }, all, hits.count, sorted,
            [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t count) {
                for (std::uint32_t first = 0; first < count; first += lanes) {
                    const auto hit = [&](int k) {
                        return of_law[std::min<std::uint32_t>(first + k, count - 1)];
                    };
                    std::uint32_t n[lanes], i[lanes], j[lanes];
                    for (int k = 0; k < lanes; ++k)
                        n[k] = hits.n[hit(k)], i[k] = hits.i[hit(k)], j[k] = hits.j[hit(k)];
                    const auto pack = [&](const float* from) {
                        Pack p;
                        for (int k = 0; k < lanes; ++k) p.v[k] = from[hit(k)];
                        return p;
                    };
                    const detail::PackOverlap overlap{{pack(hits.x), pack(hits.y), pack(hits.z)},
                                                      pack(hits.q),
                                                      pack(hits.d2),
                                                      pack(hits.D)};
                    store(evaluate_particles(law, overlap, i, j, n, overlaps), hits, hit);
                }
            });
    }
    template <class Hit>
    void store(const detail::PackLoad& load, Hits& hits, const Hit& hit) const
    {
        store_rows(load.F, [&](int k) { return &hits.load[hit(k)].F; });
        store_rows(load.M, [&](int k) { return &hits.load[hit(k)].M; });
        if (rotates) store_rows(load.T, [&](int k) { return &hits.torque[hit(k)]; });
    }

    /// Adds the loads of the contacts to the sums of their particles, in the order of the pairs. Contacts of
    /// a particle i are consecutive, so that its sum stays in a register. begin: first particle of the block.
    template <class V, class Sum>
    void add_hits(const Hits& hits, std::uint32_t begin, std::uint32_t end_of_range, const Sum* of_hits,
                  const Sum* stored_loads, Sum* sum_i, Sum* sum_j) const
    {
        if (hits.count + hits.stored_count == 0) return;
        std::uint32_t last =
            hits.stored_count > 0 && hits.stored[0].before == 0 ? pairs.i[hits.stored[0].n] : hits.i[0];
        V sum = as_vector<V>(sum_i[last - begin]);
        const auto add_to_i = [&](std::uint32_t i, const V& load) {
            using Bits __attribute__((vector_size(sizeof(V)))) = std::int32_t;
            const Bits same = Bits{} - (i == last ? 1 : 0);
            sum = V(Bits(sum) & same) + load;
            std::memcpy(static_cast<void*>(sum_i + (i - begin)), &sum, sizeof sum);
            last = i;
        };
        const auto add_range = [&](std::uint32_t first, std::uint32_t end) {
            for (std::uint32_t h = first; h < end; ++h) {
                const V load = as_vector<V>(of_hits[h]);
                add_to_i(hits.i[h], load);
                add_vector<V>(sum_j[hits.j[h]], of_hits[h]);
            }
        };
        std::uint32_t h = 0;
        for (std::uint32_t a = 0; a < hits.stored_count; ++a) {
            const auto [before, n] = hits.stored[a];
            add_range(h, before);
            h = before;
            const Sum& load = stored_loads[pairs.stored.slot(n)];
            add_to_i(pairs.i[n], as_vector<V>(load));
            const std::uint32_t j = pairs.j[n];
            if (j >= begin && j < end_of_range) add_vector<V>(sum_j[j], load);  // neither early nor late
        }
        add_range(h, hits.count);
    }
};

}  // namespace

float advance_before_loads(par::Cpu cpu, std::uint32_t particles, const AdvanceView& arrays)
{
    const AdvancePacks packs{arrays};
    return par::largest(
        cpu, (particles + lanes - 1) / lanes,
        [&](std::uint32_t k) {
            const std::uint32_t first = k * lanes;
            return largest(
                packs.advance(first, std::min<std::uint32_t>(lanes, particles - first), nullptr, nullptr));
        },
        128);
}

float sweep(par::Cpu cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
            const AdvanceView& arrays, SweepPlan& plan, std::uint32_t count)
{
    return par::largest(cpu, plan.ranges(), Sweep{{particles, pairs, laws}, arrays, plan, count}, 1);
}

}  // namespace hilda::granular
