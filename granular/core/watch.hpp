// SPDX-License-Identifier: GPL-3.0-or-later
/// Sums over particles and contacts for the watch over a run: energies, momentum, loads of boundaries and
/// fixed particles. Each call sums one block of fixed size in double precision; the caller adds the blocks in
/// their order, so that a sum does not depend on the number of threads.

#pragma once

#include "granular/core/neighbours.hpp"

namespace hilda::granular {

constexpr std::uint32_t watch_block = 64;  ///< particles or pairs of a block
constexpr std::uint32_t watch_blocks(std::uint32_t n) { return (n + watch_block - 1) / watch_block; }
/// Number of the element after the last one of a block, of n elements
HILDA_HD inline std::uint32_t end_of_block(std::uint32_t block, std::uint32_t n)
{
    return block < n / watch_block ? (block + 1) * watch_block : n;
}

/// Sums over the particles that are not fixed, before their velocities are updated
struct ParticleSums {
    double mass = 0;            ///< [kg]
    Vec3 momentum = {0, 0, 0};  ///< [kg m/s]
    Vec3 moment = {0, 0, 0};    ///< Σ m r [kg m]
    double momentum_size = 0;   ///< Σ m |v| [kg m/s]
    double rate = 0;            ///< largest |v|/R [1/s]
    double force_power = 0;     ///< Σ F·v of the applied forces [W]
    Vec3 force = {0, 0, 0};     ///< Σ F of the applied forces [N]

    HILDA_HD ParticleSums& operator+=(const ParticleSums& o)
    {
        mass += o.mass, momentum += o.momentum, moment += o.moment, momentum_size += o.momentum_size;
        rate = larger(rate, o.rate), force_power += o.force_power, force += o.force;
        return *this;
    }
};

/// Kinetic energy of the particles that are not fixed: translation and rotation [J]
struct KineticSums {
    double translation = 0, rotation = 0;

    HILDA_HD KineticSums& operator+=(const KineticSums& o)
    {
        translation += o.translation, rotation += o.rotation;
        return *this;
    }
};

/// Sums over the contacts
struct ContactSums {
    double normal = 0;      ///< energy of the normal springs, with cohesion [J]
    double tangential = 0;  ///< energy of the springs of friction, rolling and spin [J]
    double contacts = 0,
           deep = 0;  ///< number of all contacts, and of those with an overlap above deep_overlap

    HILDA_HD ContactSums& operator+=(const ContactSums& o)
    {
        normal += o.normal, tangential += o.tangential, contacts += o.contacts, deep += o.deep;
        return *this;
    }
};
constexpr float deep_overlap = 0.05f;  ///< over the smaller radius

/// Loads that boundaries and fixed particles exert on the others
struct ExternalSums {
    Vec3 F = {0, 0, 0};            ///< [N]
    double before = 0, after = 0;  ///< power with the velocities of the previous and of the next move [W]

    HILDA_HD ExternalSums& operator+=(const ExternalSums& o)
    {
        F += o.F, before += o.before, after += o.after;
        return *this;
    }
};

/// Velocities of a boundary
struct BoundaryVelocity {
    Vec3 v, omega;  ///< [m/s], [rad/s]
};

/// Particle sums of a block; copies the velocities for AddKinetic.
struct AddParticles {
    CellGrid grid;
    const Position* position;
    const Float4 *velocity, *omega;
    Float4 *velocity_copy, *omega_copy;  ///< nullptr: only the applied forces are summed
    const Float4* force;                 ///< by particle id [N]; nullptr if there are none
    const std::uint32_t* id;
    std::uint32_t count;
    ParticleSums* out;

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ParticleSums sum;
        const std::uint32_t end = end_of_block(block, count);
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const Float4 v = velocity[k], w = omega[k];
            if (velocity_copy != nullptr) velocity_copy[k] = v, omega_copy[k] = w;
            if (!(w.w > 0)) continue;
            const Vec3 v_k{v.x, v.y, v.z};
            if (force != nullptr) {
                const Float4 F = force[id[k]];
                const Vec3 F_k{F.x, F.y, F.z};
                sum.force += F_k, sum.force_power += F_k.dot(v_k);
            }
            if (velocity_copy == nullptr) continue;
            const double m = 1 / static_cast<double>(w.w), speed = v_k.norm();
            sum.mass += m, sum.momentum += m * v_k, sum.momentum_size += m * speed;
            sum.moment += m * global_position(grid, position[k]);
            sum.rate = larger(sum.rate, speed / v.w);
        }
        out[block] = sum;
    }
};

/// Kinetic energy of a block at t_n from the velocities v before and v' after an update,
///
///     T = Σ m/2 v·(v + s (v' - v)) + 1/5 m R² ω·(ω + s (ω' - ω))
///
/// With the velocities v_{n-1/2} before and v_{n+1/2} = v + s (v' - v) after t_n, T + U(x_n) is constant for
/// linear springs and for gravity, whatever the step.
struct AddKinetic {
    const Float4 *velocity, *omega, *velocity_before, *omega_before;
    double s;
    std::uint32_t count;
    KineticSums* out;

    HILDA_HD void operator()(std::uint32_t block) const
    {
        KineticSums sum;
        const std::uint32_t end = end_of_block(block, count);
        const auto product = [&](const Float4& before, const Float4& after) {
            const Vec3 a{before.x, before.y, before.z}, b{after.x, after.y, after.z};
            return a.dot(a + s * (b - a));
        };
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const Float4 w = omega_before[k], v = velocity_before[k];
            if (!(w.w > 0)) continue;
            const double m = 1 / static_cast<double>(w.w), R = v.w;
            sum.translation += 0.5 * m * product(v, velocity[k]);
            sum.rotation += 0.2 * m * R * R * product(w, omega[k]);
        }
        out[block] = sum;
    }
};

/// flag[n] = 1 for a pair with a boundary or a fixed particle
struct FlagExternalPair {
    const std::uint32_t *i, *j;
    const Float4* omega;
    std::uint32_t* flag;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        const bool boundary = (j[n] & PairView::boundary_bit) != 0;
        flag[n] = boundary || !(omega[i[n]].w > 0) || !(omega[j[n]].w > 0) ? 1 : 0;
    }
};

/// Loads of a block of the flagged pairs
struct AddExternal {
    CellGrid grid;
    const Position* position;
    const Float4 *velocity, *omega;
    const std::uint32_t *i, *j;
    const Load* load;
    const Float4* torque;  ///< nullptr without laws of rolling and spin
    const std::uint8_t* in_contact;
    const Boundary* boundary;
    const BoundaryVelocity *before, *after;  ///< by boundary number; nullptr if none moves
    const std::uint32_t* which;              ///< the flagged pairs
    std::uint32_t count;
    ExternalSums* out;

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ExternalSums sum;
        const std::uint32_t end = end_of_block(block, count);
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const std::uint32_t n = which[k];
            if (in_contact[n] == 0) continue;
            const Float4 f = load[n].F, m = load[n].M;
            const Vec3 F{f.x, f.y, f.z}, M{m.x, m.y, m.z};
            Vec3 T{0, 0, 0};
            if (torque != nullptr) T = {torque[n].x, torque[n].y, torque[n].z};
            if ((j[n] & PairView::boundary_bit) != 0) {
                sum.F += F;
                if (before != nullptr) add_work(sum, n, F, T);
                continue;
            }
            // The centre of a fixed particle is at rest; its surface moves with its angular velocity.
            const bool i_fixed = !(omega[i[n]].w > 0);
            const std::uint32_t fixed = i_fixed ? i[n] : j[n];
            const Float4 w = omega[fixed];
            const double R = velocity[fixed].w;
            const Vec3 on_fixed = i_fixed ? R * M + T : R * M - T;
            sum.F += i_fixed ? -F : F;
            const double power = -on_fixed.dot({w.x, w.y, w.z});
            sum.before += power, sum.after += power;
        }
        out[block] = sum;
    }
    HILDA_HD void add_work(ExternalSums& sum, std::uint32_t n, const Vec3& F, const Vec3& T) const
    {
        const std::uint32_t b = j[n] & ~PairView::boundary_bit;
        const BoundaryVelocity u = before[b], next = after[b];
        sum.before += F.dot(u.v) + T.dot(u.omega), sum.after += F.dot(next.v) + T.dot(next.omega);
        if (!(u.omega.dot(u.omega) + next.omega.dot(next.omega) > 0)) return;
        const Vec3 r = global_position(grid, position[i[n]]);
        const Nearest near = nearest(boundary[b], r);
        const Vec3 lever = (r - near.distance * near.n - boundary[b].r).cross(F);
        sum.before += lever.dot(u.omega), sum.after += lever.dot(next.omega);
    }
};

/// Contact sums of all pairs at the positions for which the histories hold, one block per element of `out`
void add_contacts(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactSums* out);
/// The same for the other back ends; see loops.hpp.
template <class Backend>
void add_contacts(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactSums* out);

}  // namespace hilda::granular
