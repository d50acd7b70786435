// SPDX-License-Identifier: GPL-3.0-or-later
/// The loop over pairs: contact detection, force laws, contact histories. Each pair is evaluated once.

#pragma once

#include "granular/backend/par.hpp"
#include "granular/core/pair_law.hpp"
#include "granular/core/particles.hpp"
#include "granular/core/surfaces/surfaces.hpp"

#include <bit>

namespace hilda::granular {

/// Load of a contact: force F on body i and -F on body j [N]. The tangential force exerts the torque R M on
/// either body, with its own radius R and M [N] of FrictionTorque. M.w is FrictionTorque::depth.
struct alignas(32) Load {
    Float4 F, M;
};

/// The pairs whose loads are stored, in their order: slot(n) is the number of the load of pair n. On the CPU
/// most loads are added to their particles at once and not stored; see sweep.hpp.
struct StoredLoads {
    const std::uint64_t* marks = nullptr;   ///< one bit per pair; nullptr: all pairs
    const std::uint32_t* before = nullptr;  ///< number of marked pairs before each word of marks

    HILDA_HD std::uint32_t slot(std::uint32_t n) const
    {
        if (marks == nullptr) return n;
        const std::uint64_t lower = marks[n >> 6] & ((std::uint64_t{1} << (n & 63)) - 1);
#ifdef __CUDA_ARCH__
        return before[n >> 6] + static_cast<std::uint32_t>(__popcll(lower));
#else
        return before[n >> 6] + static_cast<std::uint32_t>(std::popcount(lower));
#endif
    }
};

/// The neighbour list with loads and histories. i is the index of a particle. j is the index of a particle,
/// or the number of a surface with boundary_bit set.
struct PairView {
    static constexpr std::uint32_t boundary_bit = 0x80000000u;

    const std::uint32_t *i, *j;
    const std::uint8_t* law;   ///< index into LawView::law; nullptr if there is a single law
    Float4* history;           ///< u [m]; w: age [s], negative while sliding; zero without contact
    Float4* rotation_history;  ///< psi [rad]; w: spin [rad]; nullptr without laws of rolling and spin
    Load* load;                ///< by slot; see StoredLoads
    Float4* torque;  ///< of rolling and spin on body i [N m], by slot; nullptr if rotation_history is
    std::uint8_t* in_contact;  ///< 1 if the bodies overlap
    std::uint32_t count;       ///< number of pairs
    /// Receives the largest overlap over the smaller radius, for each chunk of the loop; nullptr: not
    /// computed
    float* largest_overlap = nullptr;
    /// The internal variables of History in their order; nullptr if no law has internal variables
    Float4* internal = nullptr;
    StoredLoads stored = {};
    /// The periodic image of j; see Image. nullptr: the nearest image, which the owner cells determine. It is
    /// set in a domain with a short period, in which two particles can touch through several images.
    const std::uint8_t* image = nullptr;

    HILDA_HD Load& load_of(std::uint32_t n) const { return load[stored.slot(n)]; }
    HILDA_HD Float4& torque_of(std::uint32_t n) const { return torque[stored.slot(n)]; }
};

/// Reads the internal variables of a history from the words x, y, z and w.
template <class R, class Words>
HILDA_HD inline void set_internal(History<R>& history, const Words& words)
{
    history.largest_overlap = words.x, history.turning = words.y;
    history.amplitude = words.z, history.reference_force = words.w;
}

/// The particle arrays that the contact loop reads
struct ParticleView {
    CellGrid grid;
    const Position* position;
    const Float4* velocity;               ///< v [m/s]; w: radius [m]
    const Float4* omega;                  ///< ω [rad/s]; w: 1/m [1/kg], 0 for a fixed particle
    float radius = 0;                     ///< common radius of all particles [m]; 0 if they differ
    const std::uint8_t* ghost = nullptr;  ///< see Particles; nullptr if there are none

    HILDA_HD bool is_ghost(std::uint32_t k) const { return ghost != nullptr && ghost[k] != 0; }
};

/// Difference of the positions of a pair of particles, i minus the image of j [units]
HILDA_HD inline Difference pair_difference(const ParticleView& particles, const PairView& pairs,
                                           std::uint32_t n)
{
    const Position &i = particles.position[pairs.i[n]], &j = particles.position[pairs.j[n]];
    return pairs.image == nullptr ? difference(particles.grid, i, j)
                                  : difference(particles.grid, i, j, pairs.image[n]);
}

/// The force laws and surfaces that the contact loop reads
struct LawView {
    const PairLaw* law;
    int laws;
    Surfaces surfaces;
    float h;    ///< step size [s]
    float lag;  ///< time from the velocities to the positions [s]; see velocity_lag()
};

/// Computes the loads of all pairs at t_n and advances their histories from t_{n-1} to t_n. A pair that is no
/// longer in contact gets a zero load and a zero history.
void find_loads(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws);

/// The same for the other back ends; see loops.hpp.
template <class Backend>
void find_loads(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws);

/// Overlap and normal of two particles.
///
///     delta = q/(D + d) unit,    q = D² - d²,    D = R_i + R_j,    d = |r_i - r_j|
///
/// q, d2 = d², D and the separation r_i - r_j are in CellGrid::unit, `unit` in m. The caller computes q in
/// 64-bit integers without rounding error. The difference D - d in single precision would lose most digits of
/// a small overlap.
///
/// Returns 1/d [1/unit].
template <class R>
HILDA_HD inline R set_overlap(ContactPoint<R>& contact, const R& q, const R& d2, const R& D,
                              const Vec<R>& separation, const R& unit)
{
    const R d = sqrt(d2);
    contact.delta = q / (D + d) * unit;
    const R inverse = R(1.f) / d;
    contact.n = inverse * separation;
    return inverse;
}

/// Effective radius R* and effective mass m* from the radii of the contact and the inverse masses [1/kg]
template <class R>
HILDA_HD inline void set_masses(ContactPoint<R>& contact, R inverse_i, R inverse_j)
{
    contact.R_eff = contact.R_i * contact.R_j / (contact.R_i + contact.R_j);
    contact.m_eff = R(1.f) / (inverse_i + inverse_j);
}

/// Velocities of a contact: v of i relative to j [m/s], and the angular velocities [rad/s]
template <class R>
struct ContactVelocities {
    Vec<R> v, omega_i, omega_j;

    /// Turns them by a small angle [rad].
    HILDA_HD void turn(const Vec<R>& angle)
    {
        v += angle.cross(v), omega_i += angle.cross(omega_i), omega_j += angle.cross(omega_j);
    }
};

/// Rate of the overlap, tangential velocity and relative angular velocity; see ContactPoint. v = v_i - v_j is
/// the relative velocity of the centres [m/s].
template <class R>
HILDA_HD inline void set_rates(ContactPoint<R>& contact, const ContactVelocities<R>& of, Lever lever)
{
    const R normal_velocity = of.v.dot(contact.n);
    contact.v_n = -normal_velocity;
    contact.v_t = of.v - normal_velocity * contact.n -
                  arm_rates(contact, of.omega_i, of.omega_j, lever).cross(contact.n);
    contact.omega = of.omega_i - of.omega_j;
}

/// The same for two particles whose velocities precede the positions; lag: this time over the distance d of
/// the centres [s/m], see velocity_lag(). The normal has turned by φ since then. The velocities turn with it:
///
///     φ = (lag/d) n × v,    v ← v + φ × v,    ω ← ω + φ × ω
///
/// Velocities of the middle of a step are relative to the normal of the middle. With the normal of t_n
/// instead, a particle that spins about n and moves across it has a tangential velocity of h/2 times both,
/// also when it rolls. The tangential spring adds it up in every step: a small particle between two large
/// ones is pulled into the groove or pushed out of it. Velocities that are extrapolated to t_n avoid this
/// too (Vyas, Ottino, Lueptow and Umbanhowar, Comput. Phys. Commun. 310 (2025) 109524). They need the
/// accelerations of the step before, and they lower the largest stable step of a damped contact.
template <class R>
HILDA_HD inline void set_rates(ContactPoint<R>& contact, const ContactVelocities<R>& of, Lever lever,
                               const R& lag, bool rotation_laws)
{
    const R normal_velocity = of.v.dot(contact.n);
    const Vec<R> across = of.v - normal_velocity * contact.n;
    const Vec<R> phi = lag * contact.n.cross(across),
                 rates = arm_rates(contact, of.omega_i, of.omega_j, lever);
    // φ is normal to n and v: (φ × v) · n = -lag |across|²,  (φ × rates) × n = -(rates · n) φ
    contact.v_n = lag * across.dot(across) - normal_velocity;
    contact.v_t =
        across + (lag * normal_velocity) * across - rates.cross(contact.n) + rates.dot(contact.n) * phi;
    contact.omega = of.omega_i - of.omega_j;
    if (rotation_laws) contact.omega += phi.cross(contact.omega);
}

/// Velocities of the contact of a particle at r with surface k, relative to the normal near.n of the closest
/// point. v, omega: of the particle, which precede its position by `lag` [s], as those of the boundary do
///
/// The particle was at r - lag (v - v_b) in the present frame of the boundary, v_b = v_B + ω_B × (r - r_B).
HILDA_HD inline ContactVelocities<double> boundary_velocities(const Surfaces& surfaces, std::uint32_t k,
                                                              const Vec3& r, const Nearest& near,
                                                              const Vec3& v, const Vec3& omega, double radius,
                                                              double lag)
{
    const Boundary& b = surfaces.boundary[surfaces.boundary_of(k)];
    ContactVelocities<double> out{v - velocity(b, r - near.distance * near.n), omega, b.omega};
    if (lag == 0 || surfaces.keeps_normal(k, near.n)) return out;
    const Vec3 before = r - lag * (v - velocity(b, r));
    const Nearest then = surfaces.nearest(k, before, 2 * radius);
    if (!(then.distance < no_contact_distance)) return out;  // beyond the triangle
    const Vec3 lever = before - then.distance * then.n - b.r, n = then.n - lag * b.omega.cross(then.n);
    out.v = v - (b.v + b.omega.cross(lever - lag * b.omega.cross(lever)));
    out.turn(n.cross(near.n));
    return out;
}

/// Sets all of the contact of a particle with surface k but the step size. The geometry is computed in
/// double precision. Returns false if there is no overlap.
HILDA_HD inline bool find_boundary_contact(ContactPoint<float>& contact, const CellGrid& grid,
                                           const Position& p, const Float4& v, const Float4& w,
                                           const Surfaces& surfaces, std::uint32_t k, double lag = 0,
                                           Lever lever = Lever::radius)
{
    const Boundary& b = surfaces.boundary[surfaces.boundary_of(k)];
    const Vec3 r = global_position(grid, p);
    const Nearest near = surfaces.nearest(k, r, v.w);
    const double delta = v.w - near.distance;
    if (!(delta > 0)) return false;
    const auto narrow = [](const Vec3& a) {
        return Vec<float>{static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
    };
    contact.n = narrow(near.n);
    contact.delta = static_cast<float>(delta);
    contact.R_i = v.w, contact.R_j = 0;
    contact.R_eff = static_cast<float>(effective_radius(b, v.w, near));
    contact.m_eff = 1 / (w.w + b.inverse_mass());
    const ContactVelocities<double> of =
        boundary_velocities(surfaces, k, r, near, {v.x, v.y, v.z}, {w.x, w.y, w.z}, v.w, lag);
    set_rates(contact, ContactVelocities<float>{narrow(of.v), narrow(of.omega_i), narrow(of.omega_j)}, lever);
    return true;
}

}  // namespace hilda::granular
