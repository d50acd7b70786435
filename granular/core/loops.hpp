// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over pairs and particles with one scalar call per pair or particle, for the GPU. The results are
// bitwise equal to those of the packs in contact_loop_cpu.cpp and sweep_cpu.cpp.
#pragma once

#include "granular/core/add_contacts.hpp"
#include "granular/core/contact_loop.hpp"
#include "granular/core/integrator.hpp"

namespace hilda::granular {

namespace detail {

/// Sets *to to x if x is larger. x ≥ 0; bit patterns of such floats have the same order.
HILDA_HD inline void raise(float* to, float x)
{
#ifdef __CUDA_ARCH__
    if (x > *static_cast<volatile float*>(to)) atomicMax(reinterpret_cast<int*>(to), __float_as_int(x));
#else
    auto* const bits = reinterpret_cast<std::int32_t*>(to);
    std::int32_t now = __atomic_load_n(bits, __ATOMIC_RELAXED);
    while (as_float(now) < x &&
           !__atomic_compare_exchange_n(bits, &now, as_int(x), true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
#endif
}

/// Load and history of one pair
struct FindLoad {
    ParticleView particles;
    PairView pairs;
    LawView laws;
    float units_per_metre, unit;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t i = pairs.i[k], j = pairs.j[k];
        const Position p_i = particles.position[i];
        const auto law = [&]() -> const PairLaw& {
            return laws.law[pairs.law == nullptr ? 0 : pairs.law[k]];
        };
        ContactPoint<float> contact{};
        contact.h = laws.h;
        bool overlaps = false;
        if ((j & PairView::boundary_bit) != 0) {
            overlaps =
                find_boundary_contact(contact, particles.grid, p_i, particles.velocity[i], particles.omega[i],
                                      laws.surfaces, j & ~PairView::boundary_bit, laws.lag, law().lever);
        } else {
            // Most listed pairs are not in contact: for these only positions and radii are read.
            const float common = particles.radius;
            const float R_i = common > 0 ? common : particles.velocity[i].w,
                        R_j = common > 0 ? common : particles.velocity[j].w;
            const Difference d = pair_difference(particles, pairs, k);
            const std::int64_t D = radius_in_units(R_i, units_per_metre) +
                                   radius_in_units(R_j, units_per_metre),
                               x = d.x, y = d.y, z = d.z, d2 = x * x + y * y + z * z, q = D * D - d2;
            overlaps = q > 0;
            if (overlaps) {
                const Float4 v_i = particles.velocity[i], v_j = particles.velocity[j];
                const float inverse = set_overlap(
                    contact, static_cast<float>(q), static_cast<float>(d2), static_cast<float>(D),
                    Vec<float>{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
                    unit);
                const Float4 w_i = particles.omega[i], w_j = particles.omega[j];
                contact.R_i = v_i.w, contact.R_j = v_j.w;
                set_masses(contact, w_i.w, w_j.w);
                set_rates(contact,
                          ContactVelocities<float>{{v_i.x - v_j.x, v_i.y - v_j.y, v_i.z - v_j.z},
                                                   {w_i.x, w_i.y, w_i.z},
                                                   {w_j.x, w_j.y, w_j.z}},
                          law().lever, laws.lag * units_per_metre * inverse,
                          pairs.rotation_history != nullptr);
            }
        }
        const bool rotation_laws = pairs.rotation_history != nullptr;
        if (!overlaps) {
            if (pairs.in_contact[k] == 0) return;
            pairs.in_contact[k] = 0, pairs.history[k] = {}, pairs.load[k] = {};
            if (rotation_laws) pairs.rotation_history[k] = {}, pairs.torque[k] = {};
            if (pairs.internal != nullptr) pairs.internal[k] = {};
            return;
        }
        pairs.in_contact[k] = 1;
        if (pairs.largest_overlap != nullptr)
            raise(pairs.largest_overlap,
                  contact.delta / (contact.R_j > 0 ? smaller(contact.R_i, contact.R_j) : contact.R_i));
        const Float4 u = pairs.history[k];
        History<float> history{{u.x, u.y, u.z}, abs(u.w) + laws.h, {0, 0, 0}, 0, u.w < 0};
        if (rotation_laws) {
            const Float4 psi = pairs.rotation_history[k];
            history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
        }
        if (pairs.internal != nullptr) set_internal(history, pairs.internal[k]);
        const ContactForce<float> out = evaluate(law(), contact, history, rotation_laws);
        const FrictionTorque<float> torque = friction_torque(law(), contact, out.F_t);
        if (pairs.internal != nullptr)
            pairs.internal[k] = {history.largest_overlap, history.turning, history.amplitude,
                                 history.reference_force};
        pairs.history[k] = {history.u.x, history.u.y, history.u.z, history.slid ? -history.age : history.age};
        pairs.load[k] = {{out.F.x, out.F.y, out.F.z, 0}, {torque.M.x, torque.M.y, torque.M.z, torque.depth}};
        if (!rotation_laws) return;
        pairs.rotation_history[k] = {history.psi.x, history.psi.y, history.psi.z, history.spin};
        pairs.torque[k] = {out.T.x, out.T.y, out.T.z, 0};
    }
};

/// Advances a particle; returns its |v|², or 0 if it is fixed.
struct AdvanceOne {
    AdvanceView arrays;

    HILDA_HD static Vec<float> vec(const Float4& f) { return {f.x, f.y, f.z}; }
    HILDA_HD static void put(Float4& to, const Vec<float>& v) { to.x = v.x, to.y = v.y, to.z = v.z; }

    HILDA_HD void rotate_one(std::uint32_t k, const Vec<float>& angle) const
    {
        Float4 p = arrays.orientation[k], error = arrays.orientation_compensation[k];
        const EulerParameters<float> d = rotation_increment(angle, {p.x, {p.y, p.z, p.w}});
        add(p.x, d.e0, error.x), add(p.y, d.e.x, error.y), add(p.z, d.e.y, error.z), add(p.w, d.e.z, error.w);
        arrays.orientation[k] = p, arrays.orientation_compensation[k] = error;
    }

    HILDA_HD float operator()(std::uint32_t k) const
    {
        Vec<float> F{0, 0, 0}, T{0, 0, 0};
        Float4 v = arrays.velocity[k], w = arrays.omega[k];
        if (arrays.step.part != Part::before_loads) {
            Vec<float> F_j{0, 0, 0}, M{0, 0, 0}, M_j{0, 0, 0};
            for (std::uint32_t n = arrays.start[k]; n < arrays.start[k + 1]; ++n)
                if (arrays.in_contact[n] != 0) F += vec(arrays.load[n].F), M += vec(arrays.load[n].M);
            for (std::uint32_t m = arrays.other_start[k]; m < arrays.other_start[k + 1]; ++m) {
                const Load& load = arrays.load[arrays.other[m]];
                F_j += vec(load.F), M_j += vec(load.M);
            }
            F -= F_j, M += M_j;
            if (arrays.force != nullptr) F += vec(arrays.force[arrays.id[k]]);
            if (arrays.torque != nullptr) {
                for (std::uint32_t n = arrays.start[k]; n < arrays.start[k + 1]; ++n)
                    T += vec(arrays.torque[n]);
                Vec<float> T_j{0, 0, 0};
                for (std::uint32_t m = arrays.other_start[k]; m < arrays.other_start[k + 1]; ++m)
                    T_j += vec(arrays.torque[arrays.other[m]]);
                T -= T_j;
            }
            T = v.w * M + T;
            if (arrays.total != nullptr) arrays.total[k] = {{F.x, F.y, F.z, 0}, {T.x, T.y, T.z, 0}};
        }
        Compensation compensation = arrays.compensation[k];
        ParticleState<float> m{.v = vec(v),
                               .omega = vec(w),
                               .v_compensation = load_bfloat16(compensation.v),
                               .omega_compensation = load_bfloat16(compensation.omega),
                               .remainder = unpack_remainder<float>(compensation.displacement),
                               .radius = v.w,
                               .inverse_mass = w.w};
        Vec<float> acc{0, 0, 0}, alpha{0, 0, 0};
        if (arrays.acc != nullptr) acc = vec(arrays.acc[k]), alpha = vec(arrays.alpha[k]);
        const Displacement<float> moved = advance_particle(arrays.step, m, F, T, acc, alpha);

        put(v, m.v), put(w, m.omega);
        arrays.velocity[k] = v, arrays.omega[k] = w;
        const std::uint32_t dither = arrays.step.velocity_dither;
        const SplitDisplacement<float> units =
            split_displacement(moved.translation, arrays.step.displacement_dither);
        compensation.displacement = units.remainder;
        store_bfloat16(compensation.v, m.v_compensation, dither),
            store_bfloat16(compensation.omega, m.omega_compensation, dither);
        arrays.compensation[k] = compensation;
        if (arrays.acc != nullptr) put(arrays.acc[k], acc), put(arrays.alpha[k], alpha);
        if (arrays.step.part == Part::whole || arrays.step.part == Part::before_loads) {
            Position p = arrays.position[k];
            p.x = wrapped_sum(p.x, units.x), p.y = wrapped_sum(p.y, units.y), p.z = wrapped_sum(p.z, units.z);
            arrays.position[k] = p;
            if (arrays.orientation != nullptr) rotate_one(k, moved.rotation);
        }
        return w.w > 0 ? m.v.dot(m.v) : 0;
    }
};

}  // namespace detail

template <class Backend>
void find_loads(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws)
{
    const auto unit = static_cast<float>(particles.grid.unit);
    par::for_each(on, pairs.count, detail::FindLoad{particles, pairs, laws, 1 / unit, unit});
}

template <class Backend>
void add_contacts(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactPart* out)
{
    const auto unit = static_cast<float>(particles.grid.unit);
    par::for_each(on, watch_blocks(pairs.count),
                  detail::AddContacts{particles, pairs, laws, 1 / unit, unit, out});
}

template <class Backend>
float advance(Backend on, std::uint32_t particles, const AdvanceView& arrays)
{
    return par::largest(on, particles, detail::AdvanceOne{arrays});
}

}  // namespace hilda::granular
