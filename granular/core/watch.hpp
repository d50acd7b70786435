// SPDX-License-Identifier: GPL-3.0-or-later
/// Sums over particles and contacts for the watch over a run: energies, momentum, loads of boundaries and
/// fixed particles. Each call sums one block. The sums are those of FixedSum: they depend neither on the
/// order of the particles nor on the number of threads or processes.

#pragma once

#include "granular/backend/fixed_sum.hpp"
#include "granular/core/clump.hpp"
#include "granular/core/neighbours/neighbours.hpp"

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
};
/// Part of ParticleSums
struct ParticlePart {
    FixedSum mass, momentum_size, force_power;
    FixedVec momentum, moment, force;
    double rate = 0;

    HILDA_HD ParticlePart& operator+=(const ParticlePart& o)
    {
        mass += o.mass, momentum += o.momentum, moment += o.moment, momentum_size += o.momentum_size;
        rate = larger(rate, o.rate), force_power += o.force_power, force += o.force;
        return *this;
    }
    ParticleSums value() const
    {
        return {.mass = mass.value(),
                .momentum = momentum.value(),
                .moment = moment.value(),
                .momentum_size = momentum_size.value(),
                .rate = rate,
                .force_power = force_power.value(),
                .force = force.value()};
    }
};

/// Kinetic energy of the particles that are not fixed: translation and rotation [J]
struct KineticSums {
    double translation = 0, rotation = 0;
};
/// Part of KineticSums
struct KineticPart {
    FixedSum translation, rotation;

    HILDA_HD KineticPart& operator+=(const KineticPart& o)
    {
        translation += o.translation, rotation += o.rotation;
        return *this;
    }
    KineticSums value() const { return {translation.value(), rotation.value()}; }
};

/// Sums over the contacts
struct ContactSums {
    double normal = 0;      ///< energy of the normal springs, with cohesion [J]
    double tangential = 0;  ///< energy of the springs of friction, rolling and spin [J]
    double contacts = 0,
           deep = 0;  ///< number of all contacts, and of those with an overlap above deep_overlap
};
/// Part of ContactSums
struct ContactPart {
    FixedSum normal, tangential;
    double contacts = 0, deep = 0;

    HILDA_HD ContactPart& operator+=(const ContactPart& o)
    {
        normal += o.normal, tangential += o.tangential, contacts += o.contacts, deep += o.deep;
        return *this;
    }
    ContactSums value() const { return {normal.value(), tangential.value(), contacts, deep}; }
};
constexpr float deep_overlap = 0.05f;  ///< over the smaller radius

/// Loads that boundaries and fixed particles exert on the others
struct ExternalSums {
    Vec3 F = {0, 0, 0};            ///< [N]
    double before = 0, after = 0;  ///< power with the velocities of the previous and of the next move [W]
};
/// Part of ExternalSums
struct ExternalPart {
    FixedVec F;
    FixedSum before, after;

    HILDA_HD ExternalPart& operator+=(const ExternalPart& o)
    {
        F += o.F, before += o.before, after += o.after;
        return *this;
    }
    ExternalSums value() const { return {F.value(), before.value(), after.value()}; }
};

/// Velocities of a boundary
struct BoundaryVelocity {
    Vec3 v, omega;  ///< [m/s], [rad/s]
};

/// Velocities of a particle in single precision
struct Velocities {
    Vec<float> v, omega;  ///< [m/s], [rad/s]
};

/// Particle sums of a block; copies the velocities for AddKinetic.
struct AddParticles {
    ParticleView particles;
    Velocities* copy;     ///< nullptr: only the applied forces are summed
    const Float4* force;  ///< by particle id [N]; nullptr if there are none
    const std::uint32_t* id;
    std::uint32_t count;
    ParticlePart* out;
    ClumpView clumps = {};

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ParticlePart sum;
        DoublePart mass, momentum_size;
        DoublePartVec momentum, moment;
        const std::uint32_t end = end_of_block(block, count);
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const Float4 v = particles.velocity[k], w = particles.omega[k];
            if (copy != nullptr) copy[k] = {{v.x, v.y, v.z}, {w.x, w.y, w.z}};
            if (!(w.w > 0) || particles.is_ghost(k)) continue;
            const Vec3 v_k = to_double(v);
            if (force != nullptr) {
                const Vec3 F = to_double(force[id[k]]);
                sum.force += F, sum.force_power += F.dot(v_k);
            }
            if (copy == nullptr) continue;
            const double m = 1 / static_cast<double>(w.w), speed = v_k.norm();
            sum.rate = larger(sum.rate, speed / v.w);
            if (const std::uint32_t c = clumps(k); c != no_clump) {
                if (clumps.represents(k, c)) add_clump(sum, clumps.body[c], copy[k]);
                continue;
            }
            mass.add(m, sum.mass), momentum.add(m * v_k, sum.momentum);
            momentum_size.add(m * speed, sum.momentum_size);
            moment.add(m * global_position(particles.grid, particles.position[k]), sum.moment);
        }
        mass.finish(sum.mass), momentum.finish(sum.momentum), momentum_size.finish(sum.momentum_size);
        moment.finish(sum.moment);
        out[block] = sum;
    }
    HILDA_HD void add_clump(ParticlePart& sum, const ClumpBody& b, Velocities& own) const
    {
        const Vec3 v = to_double(b.velocity);
        const double m = 1 / static_cast<double>(b.momentum.w);
        sum.mass += m, sum.momentum += m * v, sum.momentum_size += m * v.norm();
        sum.moment += m * global_position(particles.grid, b.position);
        own = {{b.velocity.x, b.velocity.y, b.velocity.z}, {b.momentum.x, b.momentum.y, b.momentum.z}};
    }
};

/// Kinetic energy of a block at t_n from the velocities v before and v' after an update,
///
///     T = Σ m/2 v·(v + s (v' - v)) + 1/5 m R² ω·(ω + s (ω' - ω))
///
/// With the velocities v_{n-1/2} before and v_{n+1/2} = v + s (v' - v) after t_n, T + U(x_n) is constant for
/// linear springs and for gravity, whatever the step. For a clump the rotation is
/// 1/5 m R² ω·(w + s (w' - w)), see clump.hpp.
struct AddKinetic {
    const Float4 *velocity, *omega;
    const Velocities* before;
    double s;
    std::uint32_t count;
    KineticPart* out;
    ClumpView clumps = {};
    const std::uint8_t* ghost = nullptr;  ///< see Particles

    HILDA_HD void operator()(std::uint32_t block) const
    {
        KineticPart sum;
        DoublePart translation, rotation;
        const std::uint32_t end = end_of_block(block, count);
        const auto product = [&](const Vec<float>& first, const Float4& after) {
            const Vec3 a{first.x, first.y, first.z}, b{after.x, after.y, after.z};
            return a.dot(a + s * (b - a));
        };
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const Float4 v = velocity[k], w = omega[k];
            if (!(w.w > 0) || (ghost != nullptr && ghost[k] != 0)) continue;
            const std::uint32_t c = clumps(k);
            if (c != no_clump && !clumps.represents(k, c)) continue;
            const double m = 1 / static_cast<double>(w.w),
                         R = c == no_clump ? v.w : clumps.body[c].velocity.w;
            if (c != no_clump) {
                const ClumpBody& b = clumps.body[c];
                const Vec<float>& w_b = before[k].omega;
                const Vec3 w_before{w_b.x, w_b.y, w_b.z}, w_after = to_double(b.momentum);
                sum.translation += 0.5 * m * product(before[k].v, b.velocity);
                sum.rotation +=
                    0.2 * m * R * R * to_double(b.omega_before).dot(w_before + s * (w_after - w_before));
                continue;
            }
            translation.add(0.5 * m * product(before[k].v, v), sum.translation);
            rotation.add(0.2 * m * R * R * product(before[k].omega, w), sum.rotation);
        }
        translation.finish(sum.translation), rotation.finish(sum.rotation);
        out[block] = sum;
    }
};

/// Whether a pair has a boundary
struct HasBoundary {
    const std::uint32_t* j;
    HILDA_HD bool operator()(std::uint32_t n) const { return (j[n] & PairView::boundary_bit) != 0; }
};

/// Whether a pair of particles has a fixed one. Pairs of a ghost i belong to another process.
struct HasFixedParticle {
    const std::uint32_t *i, *j;
    const Float4* omega;
    const std::uint8_t* ghost = nullptr;  ///< see Particles
    HILDA_HD bool operator()(std::uint32_t n) const
    {
        return (j[n] & PairView::boundary_bit) == 0 && !(ghost != nullptr && ghost[i[n]] != 0) &&
               !(omega[i[n]].w > 0 && omega[j[n]].w > 0);
    }
};

/// Loads of a block of the pairs with boundaries
struct AddBoundaryLoads {
    ParticleView particles;
    PairView pairs;
    Surfaces surfaces;
    const BoundaryVelocity *before, *after;  ///< by boundary number; nullptr if none moves
    const std::uint32_t* which;              ///< numbers of these pairs
    std::uint32_t count;
    ExternalPart* out;

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ExternalPart sum;
        FloatPartVec F;
        const std::uint32_t end = end_of_block(block, count);
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            if (pairs.in_contact[which[k]] == 0) continue;
            const Float4 F_k = pairs.load_of(which[k]).F;
            F.add({F_k.x, F_k.y, F_k.z}, sum.F);
            if (before != nullptr) add_power(sum, which[k]);
        }
        F.finish(sum.F);
        out[block] = sum;
    }
    HILDA_HD void add_power(ExternalPart& sum, std::uint32_t n) const
    {
        const std::uint32_t k = pairs.j[n] & ~PairView::boundary_bit, b = surfaces.boundary_of(k),
                            i = pairs.i[n];
        const BoundaryVelocity u = before[b], next = after[b];
        const Load& load = pairs.load_of(n);
        const Vec3 F = to_double(load.F);
        Vec3 T{0, 0, 0};
        if (pairs.torque != nullptr) T = to_double(pairs.torque_of(n));
        if (u.omega.dot(u.omega) + next.omega.dot(next.omega) > 0)
            T += surfaces
                     .contact_lever(k, global_position(particles.grid, particles.position[i]),
                                    particles.velocity[i].w, load.M.w)
                     .cross(F);
        sum.before += F.dot(u.v) + T.dot(u.omega), sum.after += F.dot(next.v) + T.dot(next.omega);
    }
};

/// Loads of a block of the pairs with fixed particles, whose velocities are given
struct AddFixedLoads {
    ParticleView particles;
    PairView pairs;
    const std::uint32_t* which;  ///< numbers of these pairs
    std::uint32_t count;
    ExternalPart* out;

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ExternalPart sum;
        const std::uint32_t end = end_of_block(block, count);
        for (std::uint32_t k = block * watch_block; k < end; ++k) {
            const std::uint32_t n = which[k];
            if (pairs.in_contact[n] == 0) continue;
            const Load& load = pairs.load_of(n);
            const Vec3 F = to_double(load.F), M = to_double(load.M);
            Vec3 T{0, 0, 0};
            if (pairs.torque != nullptr) T = to_double(pairs.torque_of(n));
            const bool i_fixed = !(particles.omega[pairs.i[n]].w > 0);
            const std::uint32_t fixed = i_fixed ? pairs.i[n] : pairs.j[n];
            const double R = particles.velocity[fixed].w;
            const Vec3 on_fixed = i_fixed ? R * M + T : R * M - T;
            const Vec3 on_other = i_fixed ? -F : F;
            sum.F += on_other;
            const double power = on_other.dot(to_double(particles.velocity[fixed])) -
                                 on_fixed.dot(to_double(particles.omega[fixed]));
            sum.before += power, sum.after += power;
        }
        out[block] = sum;
    }
};

/// Contact sums of all pairs at the positions for which the histories hold, one block per element of `out`
void add_contacts(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactPart* out);
/// The same for the other back ends; see loops.hpp.
template <class Backend>
void add_contacts(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactPart* out);

}  // namespace hilda::granular
