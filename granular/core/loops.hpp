// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over contacts and particles one by one, for back ends whose threads are their lanes. Same bits as the packs of
// contact_loop_cpu.cpp and integrator_cpu.cpp.
#pragma once

#include "granular/core/contact_loop.hpp"
#include "granular/core/integrator.hpp"

namespace hilda::granular {

namespace detail {

struct FindLoad {
    ParticleView particles;
    PairView pairs;
    LawView laws;
    float per_metre, metre;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t i = pairs.i[k], j = pairs.j[k];
        const Position p_i = particles.position[i];
        ContactPoint<float> t{};
        t.h = laws.h;
        bool touches = false;
        if ((j & PairView::boundary) != 0) {
            touches = meet(t, particles.grid, p_i, particles.velocity[i], particles.omega[i],
                           laws.boundary[j & ~PairView::boundary]);
        } else {
            // most pairs do not touch, and of those no more is read than that takes
            const float all = particles.radius;
            const float R_i = all > 0 ? all : particles.velocity[i].w,
                        R_j = all > 0 ? all : particles.velocity[j].w;
            const Difference d = difference(particles.grid, p_i, particles.position[j]);
            const std::int64_t D = in_units(R_i, per_metre) + in_units(R_j, per_metre), x = d.x, y = d.y,
                               z = d.z, d2 = x * x + y * y + z * z, q = D * D - d2;
            touches = q > 0;
            if (touches) {
                const Four v_i = particles.velocity[i], v_j = particles.velocity[j];
                set_overlap(
                    t, static_cast<float>(q), static_cast<float>(d2), static_cast<float>(D),
                    Vec<float>{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
                    metre);
                const Four w_i = particles.omega[i], w_j = particles.omega[j];
                t.R_i = v_i.w, t.R_j = v_j.w;
                set_masses(t, w_i.w, w_j.w);
                set_rates(t, Vec<float>{v_i.x - v_j.x, v_i.y - v_j.y, v_i.z - v_j.z},
                          Vec<float>{w_i.x, w_i.y, w_i.z}, Vec<float>{w_j.x, w_j.y, w_j.z});
            }
        }
        const bool turning = pairs.turning != nullptr;
        if (!touches) {
            if (pairs.touches[k] == 0) return;
            pairs.touches[k] = 0, pairs.history[k] = {}, pairs.load[k] = {};
            if (turning) pairs.turning[k] = {}, pairs.torque[k] = {};
            return;
        }
        pairs.touches[k] = 1;
        const Four u = pairs.history[k];
        History<float> history{{u.x, u.y, u.z}, abs(u.w) + laws.h, {0, 0, 0}, 0, u.w < 0};
        if (turning) {
            const Four psi = pairs.turning[k];
            history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
        }
        const ContactForce<float> out =
            evaluate(laws.law[pairs.law == nullptr ? 0 : pairs.law[k]], t, history, turning);
        const Vec<float> M = -t.n.cross(out.F_t);
        pairs.history[k] = {history.u.x, history.u.y, history.u.z, history.slid ? -history.age : history.age};
        pairs.load[k] = {{out.F.x, out.F.y, out.F.z, 0}, {M.x, M.y, M.z, 0}};
        if (!turning) return;
        pairs.turning[k] = {history.psi.x, history.psi.y, history.psi.z, history.spin};
        pairs.torque[k] = {out.T.x, out.T.y, out.T.z, 0};
    }
};

/// Advances a particle, and returns its |v|²; 0 of one that is fixed.
struct AdvanceOne {
    Advance to;

    HILDA_HD static Vec<float> vec(const Four& f) { return {f.x, f.y, f.z}; }
    HILDA_HD static void put(Four& to, const Vec<float>& v) { to.x = v.x, to.y = v.y, to.z = v.z; }

    HILDA_HD void turn_one(std::uint32_t k, const Vec<float>& angle) const
    {
        Four p = to.orientation[k], left = to.orientation_rest[k];
        const EulerParameters<float> d = turn_by(angle, {p.x, {p.y, p.z, p.w}});
        add(p.x, d.e0, left.x), add(p.y, d.e.x, left.y), add(p.z, d.e.y, left.z), add(p.w, d.e.z, left.w);
        to.orientation[k] = p, to.orientation_rest[k] = left;
    }

    HILDA_HD float operator()(std::uint32_t k) const
    {
        Vec<float> F{0, 0, 0}, T{0, 0, 0};
        Four v = to.velocity[k], w = to.omega[k];
        if (to.step.part != Part::before_loads) {
            Vec<float> F_j{0, 0, 0}, M{0, 0, 0}, M_j{0, 0, 0};
            for (std::uint32_t n = to.start[k]; n < to.start[k + 1]; ++n)
                if (to.touches[n] != 0) F += vec(to.load[n].F), M += vec(to.load[n].M);
            for (std::uint32_t m = to.other_start[k]; m < to.other_start[k + 1]; ++m) {
                const Load& load = to.load[to.other[m]];
                F_j += vec(load.F), M_j += vec(load.M);
            }
            F -= F_j, M += M_j;
            if (to.force != nullptr) F += vec(to.force[to.id[k]]);
            if (to.torque != nullptr) {
                for (std::uint32_t n = to.start[k]; n < to.start[k + 1]; ++n) T += vec(to.torque[n]);
                for (std::uint32_t m = to.other_start[k]; m < to.other_start[k + 1]; ++m)
                    T -= vec(to.torque[to.other[m]]);
            }
            T = v.w * M + T;
        }
        Compensation rest = to.rest[k];
        Moving<float> m{.v = vec(v),
                        .omega = vec(w),
                        .v_rest = from_halves(rest.v),
                        .omega_rest = from_halves(rest.omega),
                        .rest = rest_of_way<float>(rest.way),
                        .radius = v.w,
                        .per_mass = w.w};
        Vec<float> acc{0, 0, 0}, turn{0, 0, 0};
        if (to.acc != nullptr) acc = vec(to.acc[k]), turn = vec(to.turn[k]);
        const Went<float> all = go(to.step, m, F, T, acc, turn);

        put(v, m.v), put(w, m.omega);
        to.velocity[k] = v, to.omega[k] = w;
        const std::uint32_t dither = to.step.random;
        const Carried<float> went = carried(all.way, to.step.even);
        rest.way = went.word;
        put_halves(rest.v, m.v_rest, dither), put_halves(rest.omega, m.omega_rest, dither);
        to.rest[k] = rest;
        if (to.acc != nullptr) put(to.acc[k], acc), put(to.turn[k], turn);
        if (to.step.part == Part::whole || to.step.part == Part::before_loads) {
            Position p = to.position[k];
            p.x += went.x, p.y += went.y, p.z += went.z;
            to.position[k] = p;
            if (to.orientation != nullptr) turn_one(k, all.angle);
        }
        return w.w > 0 ? m.v.dot(m.v) : 0;
    }
};

}  // namespace detail

template <class Backend>
void find_loads(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws)
{
    const auto metre = static_cast<float>(particles.grid.unit);
    par::for_each(on, pairs.count, detail::FindLoad{particles, pairs, laws, 1 / metre, metre});
}

template <class Backend>
float advance(Backend on, std::uint32_t particles, const Advance& arrays)
{
    return par::largest(on, particles, detail::AdvanceOne{arrays});
}

}  // namespace hilda::granular
