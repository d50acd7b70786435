// SPDX-License-Identifier: GPL-3.0-or-later
// The loop over pairs on the CPU. The pairs in contact are selected first; the force laws are then evaluated
// for packs of them.
#include "granular/backend/lanes.hpp"
#include "granular/core/contact_loop.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

constexpr std::uint32_t chunk = loop_chunk;  // pairs per task, independent of the number of threads

/// Four words of a row as packs
template <class T>
struct Words4 {
    T x, y, z, w;
};

template <class Word, class T>
Words4<Word> gather_rows(const T* from, const std::uint32_t* which)
{
    Word w[4];
    load_rows<Word, T>([&](int k) { return &from[which[k]]; }, w);
    return {w[0], w[1], w[2], w[3]};
}

/// Processes one chunk of pairs per call.
struct ContactLoop {
    const ParticleView& particles;
    const PairView& pairs;
    const LawView& laws;
    float units_per_metre, unit;

    /// Separation r_i - r_j and d², q = D² - d², D of a pack of pairs [units, units²]; see set_overlap
    struct Separation {
        Ints x, y, z;
        Longs q, d2;
        Ints D;
    };

    /// The function difference() for packs
    static Ints axis_difference(Ints cell_i, Ints cell_j, Ints i, Ints j, const CellGrid& g, int axis)
    {
        Ints::V d = cell_i.v - cell_j.v;
        if (g.periodic[axis] != 0) {
            const Ints::V n = Ints::V{} + g.cells[axis];
            d += (2 * d > n ? -n : 2 * d < -n ? n : Ints::V{});
        }
        using Unsigned __attribute__((vector_size(4 * lanes))) = std::uint32_t;
        const Unsigned out =
            Unsigned(d) * static_cast<std::uint32_t>(g.width[axis]) + (Unsigned(i.v) - Unsigned(j.v));
        return {Ints::V(out)};
    }

    Separation separation(const std::uint32_t* i, const std::uint32_t* j, Pack R_i, Pack R_j) const
    {
        const CellGrid& g = particles.grid;
        const auto a = gather_rows<Ints>(particles.position, i), b = gather_rows<Ints>(particles.position, j);
        constexpr int mask_x = (1 << CellGrid::bits_x) - 1, mask_y = (1 << CellGrid::bits_y) - 1,
                      mask_z = (1 << CellGrid::bits_z) - 1;
        const auto x_of = [](Ints c) { return Ints{c.v & mask_x}; };
        const auto y_of = [](Ints c) { return Ints{c.v >> CellGrid::bits_x & mask_y}; };
        const auto z_of = [](Ints c) { return Ints{c.v >> (CellGrid::bits_x + CellGrid::bits_y) & mask_z}; };
        Separation out;
        out.x = axis_difference(x_of(a.x), x_of(b.x), a.y, b.y, g, 0);
        out.y = axis_difference(y_of(a.x), y_of(b.x), a.z, b.z, g, 1);
        out.z = axis_difference(z_of(a.x), z_of(b.x), a.w, b.w, g, 2);
        out.D = {to_int(R_i * units_per_metre).v + to_int(R_j * units_per_metre).v};
        const Longs x = wide(out.x), y = wide(out.y), z = wide(out.z), D = wide(out.D);
        out.d2 = {x.v * x.v + y.v * y.v + z.v * z.v};
        out.q = {D.v * D.v - out.d2.v};
        return out;
    }

    /// Bit k of the result: pair k overlaps
    unsigned overlap(const std::uint32_t* i, const std::uint32_t* j) const
    {
        Pack R_i = particles.radius, R_j = R_i;
        if (!(particles.radius > 0))
            R_i = gather_rows<Pack>(particles.velocity, i).w,
            R_j = gather_rows<Pack>(particles.velocity, j).w;
        const Longs::V q = separation(i, j, R_i, R_j).q.v;
        return bits(PackMask{__builtin_convertvector(q > 0, Ints::V)});
    }

    void clear_contact(std::uint32_t k) const
    {
        pairs.in_contact[k] = 0;
        pairs.history[k] = {};
        pairs.load[k] = {};
        if (pairs.rotation_history != nullptr) pairs.rotation_history[k] = {}, pairs.torque[k] = {};
    }

    void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * chunk, end = std::min(begin + chunk, pairs.count);
        std::uint32_t touching[chunk + lanes], boundary_pairs[chunk];
        std::uint32_t touching_count = 0, boundary_count = 0;
        for (std::uint32_t first = begin; first < end; first += lanes) {
            const std::uint32_t *i = pairs.i + first, *j = pairs.j + first;
            std::uint8_t* contact_flags = pairs.in_contact + first;
            unsigned valid_lanes = (1u << lanes) - 1;
            std::uint32_t copy_i[lanes], copy_j[lanes];
            std::uint8_t copied_flags[lanes] = {};
            const bool partial = end - first < lanes;
            const unsigned boundary = partial ? 1 : highest_bits(j);
            if (boundary != 0) {  // a partial pack, or one with boundaries as partners
                const std::uint32_t valid = std::min<std::uint32_t>(lanes, end - first);
                valid_lanes = (1u << valid) - 1;
                for (std::uint32_t k = 0; k < lanes; ++k) {
                    const std::uint32_t at = std::min(k, valid - 1);
                    copy_i[k] = copy_j[k] = i[at];
                    if ((j[at] & PairView::boundary_bit) == 0)
                        copy_j[k] = j[at];
                    else if (k < valid)
                        boundary_pairs[boundary_count++] = first + k, valid_lanes &= ~(1u << k);
                }
                std::copy_n(contact_flags, valid, copied_flags);
                i = copy_i, j = copy_j;
            }
            const unsigned before = boundary != 0 ? flags(copied_flags) : flags(contact_flags);
            const unsigned overlapping = overlap(i, j) & valid_lanes,
                           ended = before & valid_lanes & ~overlapping;
            touching_count += append(touching + touching_count, first, overlapping);
            if (boundary == 0) {
                set_flags(contact_flags, overlapping);
            } else {
                for (unsigned remaining = overlapping; remaining != 0; remaining &= remaining - 1)
                    contact_flags[__builtin_ctz(remaining)] = 1;
            }
            for (unsigned remaining = ended; remaining != 0; remaining &= remaining - 1)
                clear_contact(first + static_cast<std::uint32_t>(__builtin_ctz(remaining)));
        }
        Pack overlaps(0.f);  // over the smaller radius; the largest ones
        by_law(touching, touching_count,
               [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t count) {
                   for (std::uint32_t first = 0; first < count; first += lanes) {
                       std::uint32_t which[lanes];
                       for (std::uint32_t k = 0; k < lanes; ++k)
                           which[k] = of_law[std::min(first + k, count - 1)];
                       evaluate_particles(law, which, overlaps);
                   }
               });
        by_law(boundary_pairs, boundary_count,
               [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t count) {
                   evaluate_boundaries(law, of_law, count, overlaps);
               });
        if (pairs.largest_overlap != nullptr)
            pairs.largest_overlap[number] = larger(pairs.largest_overlap[number], largest(overlaps));
    }

    /// Calls f(law, pairs, number of pairs) once per law. The pairs of a law keep their order.
    template <class F>
    void by_law(const std::uint32_t* which, std::uint32_t count, const F& f) const
    {
        if (count == 0) return;
        if (pairs.law == nullptr) return f(laws.law[0], which, count);
        std::uint32_t start[257] = {}, sorted[chunk];
        for (std::uint32_t k = 0; k < count; ++k) ++start[pairs.law[which[k]] + 1];
        for (int l = 0; l < 256; ++l) start[l + 1] += start[l];
        std::uint32_t next[256];
        std::copy_n(start, 256, next);
        for (std::uint32_t k = 0; k < count; ++k) sorted[next[pairs.law[which[k]]]++] = which[k];
        for (int l = 0; l < laws.laws; ++l)
            if (start[l + 1] > start[l]) f(laws.law[l], sorted + start[l], start[l + 1] - start[l]);
    }

    /// Contacts with boundaries: the geometry is computed per pair in double precision, the force law per
    /// pack. These contacts are few.
    void evaluate_boundaries(const PairLaw& law, const std::uint32_t* which, std::uint32_t count,
                             Pack& overlaps) const
    {
        // a pack of contacts in the memory layout of ContactPoint<Pack>
        constexpr int values = sizeof(ContactPoint<float>) / sizeof(float);
        static_assert(sizeof(ContactPoint<Pack>) >= (values - 1) * sizeof(Pack));
        struct alignas(64) Lanes {
            float value[values - 1][lanes];  // all members but the step size
        } in = {};
        std::uint32_t touching[lanes];
        std::uint32_t touching_count = 0;
        const auto flush = [&] {
            if (touching_count == 0) return;
            for (std::uint32_t k = touching_count; k < lanes; ++k) {
                touching[k] = touching[0];
                for (auto& row : in.value) row[k] = row[0];
            }
            ContactPoint<Pack> contact;
            std::memcpy(static_cast<void*>(&contact), &in, sizeof in);
            contact.h = laws.h;
            overlaps = larger(overlaps, contact.delta / contact.R_i);
            evaluate_pack(law, contact, touching);
            touching_count = 0;
        };
        for (std::uint32_t m = 0; m < count; ++m) {
            const std::uint32_t at = which[m], i = pairs.i[at];
            ContactPoint<float> one{};
            if (!find_boundary_contact(one, particles.grid, particles.position[i], particles.velocity[i],
                                       particles.omega[i],
                                       laws.boundary[pairs.j[at] & ~PairView::boundary_bit])) {
                if (pairs.in_contact[at] != 0) clear_contact(at);
                continue;
            }
            float value[values];
            std::memcpy(value, &one, sizeof value);
            for (int k = 0; k < values - 1; ++k) in.value[k][touching_count] = value[k];
            pairs.in_contact[at] = 1;
            touching[touching_count++] = at;
            if (touching_count == lanes) flush();
        }
        flush();
    }

    /// Contacts of particles: one pack of pairs with the same law
    void evaluate_particles(const PairLaw& law, const std::uint32_t* which, Pack& overlaps) const
    {
        std::uint32_t i[lanes], j[lanes];
        for (int k = 0; k < lanes; ++k) i[k] = pairs.i[which[k]], j[k] = pairs.j[which[k]];
        const auto v_i = gather_rows<Pack>(particles.velocity, i),
                   v_j = gather_rows<Pack>(particles.velocity, j);
        const auto w_i = gather_rows<Pack>(particles.omega, i), w_j = gather_rows<Pack>(particles.omega, j);
        const Separation a = separation(i, j, v_i.w, v_j.w);
        ContactPoint<Pack> contact;
        contact.h = laws.h;
        contact.R_i = v_i.w, contact.R_j = v_j.w;
        set_overlap(contact, to_float(a.q), to_float(a.d2), to_float(a.D),
                    Vec<Pack>{to_float(a.x), to_float(a.y), to_float(a.z)}, Pack(unit));
        set_masses(contact, w_i.w, w_j.w);
        set_rates(contact, Vec<Pack>{v_i.x - v_j.x, v_i.y - v_j.y, v_i.z - v_j.z},
                  Vec<Pack>{w_i.x, w_i.y, w_i.z}, Vec<Pack>{w_j.x, w_j.y, w_j.z});
        overlaps = larger(overlaps, contact.delta / smaller(contact.R_i, contact.R_j));
        evaluate_pack(law, contact, which);
    }

    /// Evaluates the force law; stores loads and histories. Several lanes may hold the same pair; they then
    /// store the same values.
    void evaluate_pack(const PairLaw& law, const ContactPoint<Pack>& contact,
                       const std::uint32_t* which) const
    {
        const auto u = gather_rows<Pack>(pairs.history, which);
        History<Pack> history;
        history.u = {u.x, u.y, u.z};
        history.slid = u.w < Pack(0.f);  // the sign of the age marks sliding
        history.age = abs(u.w) + laws.h;
        const bool rotation_laws = pairs.rotation_history != nullptr;
        if (rotation_laws) {
            const auto psi = gather_rows<Pack>(pairs.rotation_history, which);
            history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
        }
        const ContactForce<Pack> out = evaluate(law, contact, history, rotation_laws);
        if (rotation_laws) {
            const Pack to_rotation[4] = {history.psi.x, history.psi.y, history.psi.z, history.spin};
            const Pack to_torque[4] = {out.T.x, out.T.y, out.T.z, Pack(0.f)};
            store_rows(to_rotation, [&](int k) { return &pairs.rotation_history[which[k]]; });
            store_rows(to_torque, [&](int k) { return &pairs.torque[which[k]]; });
        }
        const Vec<Pack> M = -contact.n.cross(out.F_t);
        const Pack to_history[4] = {history.u.x, history.u.y, history.u.z,
                                    select(history.slid, -history.age, history.age)};
        const Pack to_F[4] = {out.F.x, out.F.y, out.F.z, Pack(0.f)}, to_M[4] = {M.x, M.y, M.z, Pack(0.f)};
        store_rows(to_history, [&](int k) { return &pairs.history[which[k]]; });
        store_rows(to_F, [&](int k) { return &pairs.load[which[k]].F; });
        store_rows(to_M, [&](int k) { return &pairs.load[which[k]].M; });
    }
};

}  // namespace

void find_loads(par::Cpu cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws)
{
    const auto unit = static_cast<float>(particles.grid.unit);
    par::for_each(cpu, (pairs.count + chunk - 1) / chunk, ContactLoop{particles, pairs, laws, 1 / unit, unit},
                  1);
}

}  // namespace hilda::granular
