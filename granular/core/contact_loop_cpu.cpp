// SPDX-License-Identifier: GPL-3.0-or-later
// The loop over contacts on the CPU: pairs that touch are picked out first, and the laws answer a pack of them at a time.
#include "granular/backend/lanes.hpp"
#include "granular/core/contact_loop.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

constexpr std::uint32_t chunk = 2048;  // pairs, whatever the number of threads

template <class T>
struct Row4 {
    T x, y, z, w;
};

template <class Word, class T>
Row4<Word> rows(const T* from, const std::uint32_t* which)
{
    Word w[4];
    load_rows<Word, T>([&](int k) { return &from[which[k]]; }, w);
    return {w[0], w[1], w[2], w[3]};
}

struct Loop {
    const ParticleView& particles;
    const PairView& pairs;
    const LawView& laws;
    float per_metre, metre;

    /// Differences and overlap of a pack of pairs, in units
    struct Apart {
        Ints x, y, z;
        Longs q, d2;
        Ints D;
    };

    static Ints along(Ints cell_i, Ints cell_j, Ints i, Ints j, const CellGrid& g, int axis)
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

    Apart apart(const std::uint32_t* i, const std::uint32_t* j, Pack R_i, Pack R_j) const
    {
        const CellGrid& g = particles.grid;
        const auto a = rows<Ints>(particles.position, i), b = rows<Ints>(particles.position, j);
        constexpr int mask_x = (1 << CellGrid::bits_x) - 1, mask_y = (1 << CellGrid::bits_y) - 1,
                      mask_z = (1 << CellGrid::bits_z) - 1;
        const auto x_of = [](Ints c) { return Ints{c.v & mask_x}; };
        const auto y_of = [](Ints c) { return Ints{c.v >> CellGrid::bits_x & mask_y}; };
        const auto z_of = [](Ints c) { return Ints{c.v >> (CellGrid::bits_x + CellGrid::bits_y) & mask_z}; };
        Apart out;
        out.x = along(x_of(a.x), x_of(b.x), a.y, b.y, g, 0);
        out.y = along(y_of(a.x), y_of(b.x), a.z, b.z, g, 1);
        out.z = along(z_of(a.x), z_of(b.x), a.w, b.w, g, 2);
        out.D = {to_int(R_i * per_metre).v + to_int(R_j * per_metre).v};
        const Longs x = wide(out.x), y = wide(out.y), z = wide(out.z), D = wide(out.D);
        out.d2 = {x.v * x.v + y.v * y.v + z.v * z.v};
        out.q = {D.v * D.v - out.d2.v};
        return out;
    }

    /// Bit k is set where pair k overlaps.
    unsigned overlap(const std::uint32_t* i, const std::uint32_t* j) const
    {
        Pack R_i = particles.radius, R_j = R_i;
        if (!(particles.radius > 0))
            R_i = rows<Pack>(particles.velocity, i).w, R_j = rows<Pack>(particles.velocity, j).w;
        const Longs::V q = apart(i, j, R_i, R_j).q.v;
        return bits(PackMask{__builtin_convertvector(q > 0, Ints::V)});
    }

    void forget(std::uint32_t k) const
    {
        pairs.touches[k] = 0;
        pairs.history[k] = {};
        pairs.load[k] = {};
        if (pairs.turning != nullptr) pairs.turning[k] = {}, pairs.torque[k] = {};
    }

    void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * chunk, end = std::min(begin + chunk, pairs.count);
        std::uint32_t hit[chunk + lanes], on_boundary[chunk];
        std::uint32_t hits = 0, walls = 0;
        for (std::uint32_t first = begin; first < end; first += lanes) {
            const std::uint32_t *i = pairs.i + first, *j = pairs.j + first;
            std::uint8_t* touches = pairs.touches + first;
            unsigned here = (1u << lanes) - 1;
            std::uint32_t copy_i[lanes], copy_j[lanes];
            std::uint8_t copy_touches[lanes] = {};
            const bool part = end - first < lanes;
            const unsigned boundary = part ? 1 : highest_bits(j);
            if (boundary != 0) {  // the last pairs, or some that are not of two particles
                const std::uint32_t valid = std::min<std::uint32_t>(lanes, end - first);
                here = (1u << valid) - 1;
                for (std::uint32_t k = 0; k < lanes; ++k) {
                    const std::uint32_t at = std::min(k, valid - 1);
                    copy_i[k] = copy_j[k] = i[at];
                    if ((j[at] & PairView::boundary) == 0)
                        copy_j[k] = j[at];
                    else if (k < valid)
                        on_boundary[walls++] = first + k, here &= ~(1u << k);
                }
                std::copy_n(touches, valid, copy_touches);
                i = copy_i, j = copy_j;
            }
            const unsigned before = boundary != 0 ? flags(copy_touches) : flags(touches);
            const unsigned now = overlap(i, j) & here, gone = before & here & ~now;
            hits += append(hit + hits, first, now);
            if (boundary == 0) {
                set_flags(touches, now);
            } else {
                for (unsigned left = now; left != 0; left &= left - 1) touches[__builtin_ctz(left)] = 1;
            }
            for (unsigned left = gone; left != 0; left &= left - 1)
                forget(first + static_cast<std::uint32_t>(__builtin_ctz(left)));
        }
        by_law(hit, hits, [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t count) {
            for (std::uint32_t first = 0; first < count; first += lanes) {
                std::uint32_t which[lanes];
                for (std::uint32_t k = 0; k < lanes; ++k) which[k] = of_law[std::min(first + k, count - 1)];
                answer_particles(law, which);
            }
        });
        by_law(on_boundary, walls, [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t count) {
            answer_boundaries(law, of_law, count);
        });
    }

    /// Calls f with the pairs of each law, in their order.
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

    /// Few: their geometry goes one by one, in double precision, and then a pack of them to the laws
    void answer_boundaries(const PairLaw& law, const std::uint32_t* which, std::uint32_t count) const
    {
        // as many as there are lanes, as a Touch of packs is in memory
        constexpr int values = sizeof(ContactPoint<float>) / sizeof(float);
        static_assert(sizeof(ContactPoint<Pack>) >= (values - 1) * sizeof(Pack));
        struct alignas(64) Lanes {
            float of[values - 1][lanes];  // all but the step
        } in = {};
        std::uint32_t hit[lanes];
        std::uint32_t hits = 0;
        const auto flush = [&] {
            if (hits == 0) return;
            for (std::uint32_t k = hits; k < lanes; ++k) {
                hit[k] = hit[0];
                for (auto& row : in.of) row[k] = row[0];
            }
            ContactPoint<Pack> t;
            std::memcpy(static_cast<void*>(&t), &in, sizeof in);
            t.h = laws.h;
            respond(law, t, hit);
            hits = 0;
        };
        for (std::uint32_t m = 0; m < count; ++m) {
            const std::uint32_t at = which[m], i = pairs.i[at];
            ContactPoint<float> one{};
            if (!meet(one, particles.grid, particles.position[i], particles.velocity[i], particles.omega[i],
                      laws.boundary[pairs.j[at] & ~PairView::boundary])) {
                if (pairs.touches[at] != 0) forget(at);
                continue;
            }
            float value[values];
            std::memcpy(value, &one, sizeof value);
            for (int k = 0; k < values - 1; ++k) in.of[k][hits] = value[k];
            pairs.touches[at] = 1;
            hit[hits++] = at;
            if (hits == lanes) flush();
        }
        flush();
    }

    void answer_particles(const PairLaw& law, const std::uint32_t* which) const
    {
        std::uint32_t i[lanes], j[lanes];
        for (int k = 0; k < lanes; ++k) i[k] = pairs.i[which[k]], j[k] = pairs.j[which[k]];
        const auto v_i = rows<Pack>(particles.velocity, i), v_j = rows<Pack>(particles.velocity, j);
        const auto w_i = rows<Pack>(particles.omega, i), w_j = rows<Pack>(particles.omega, j);
        const Apart a = apart(i, j, v_i.w, v_j.w);
        ContactPoint<Pack> t;
        t.h = laws.h;
        t.R_i = v_i.w, t.R_j = v_j.w;
        set_overlap(t, to_float(a.q), to_float(a.d2), to_float(a.D),
                    Vec<Pack>{to_float(a.x), to_float(a.y), to_float(a.z)}, Pack(metre));
        set_masses(t, w_i.w, w_j.w);
        set_rates(t, Vec<Pack>{v_i.x - v_j.x, v_i.y - v_j.y, v_i.z - v_j.z}, Vec<Pack>{w_i.x, w_i.y, w_i.z},
                  Vec<Pack>{w_j.x, w_j.y, w_j.z});
        respond(law, t, which);
    }

    /// Lanes may repeat a pair: they write the same.
    void respond(const PairLaw& law, const ContactPoint<Pack>& t, const std::uint32_t* which) const
    {
        const auto u = rows<Pack>(pairs.history, which);
        History<Pack> history;
        history.u = {u.x, u.y, u.z};
        history.slid = u.w < Pack(0.f);  // the sign of the age
        history.age = abs(u.w) + laws.h;
        const bool turning = pairs.turning != nullptr;
        if (turning) {
            const auto psi = rows<Pack>(pairs.turning, which);
            history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
        }
        const ContactForce<Pack> out = evaluate(law, t, history, turning);
        if (turning) {
            const Pack to_turning[4] = {history.psi.x, history.psi.y, history.psi.z, history.spin};
            const Pack to_torque[4] = {out.T.x, out.T.y, out.T.z, Pack(0.f)};
            store_rows(to_turning, [&](int k) { return &pairs.turning[which[k]]; });
            store_rows(to_torque, [&](int k) { return &pairs.torque[which[k]]; });
        }
        const Vec<Pack> M = -t.n.cross(out.F_t);
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
    const auto metre = static_cast<float>(particles.grid.unit);
    par::for_each(cpu, (pairs.count + chunk - 1) / chunk, Loop{particles, pairs, laws, 1 / metre, metre}, 1);
}

}  // namespace hilda::granular
