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

/// The force laws and surfaces that the contact loop reads
struct LawView {
    const PairLaw* law;
    int laws;
    Surfaces surfaces;
    float h;  ///< step size [s]
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
template <class R>
HILDA_HD inline void set_overlap(ContactPoint<R>& contact, const R& q, const R& d2, const R& D,
                                 const Vec<R>& separation, const R& unit)
{
    const R d = sqrt(d2);
    contact.delta = q / (D + d) * unit;
    contact.n = (R(1.f) / d) * separation;
}

/// Effective radius R* and effective mass m* from the radii of the contact and the inverse masses [1/kg]
template <class R>
HILDA_HD inline void set_masses(ContactPoint<R>& contact, R inverse_i, R inverse_j)
{
    contact.R_eff = contact.R_i * contact.R_j / (contact.R_i + contact.R_j);
    contact.m_eff = R(1.f) / (inverse_i + inverse_j);
}

/// Rate of the overlap, tangential velocity and relative angular velocity; see ContactPoint. v = v_i - v_j is
/// the relative velocity of the centres [m/s].
template <class R>
HILDA_HD inline void set_rates(ContactPoint<R>& contact, const Vec<R>& v, const Vec<R>& omega_i,
                               const Vec<R>& omega_j)
{
    const R normal_velocity = v.dot(contact.n);
    contact.v_n = -normal_velocity;
    contact.v_t =
        v - normal_velocity * contact.n - (contact.R_i * omega_i + contact.R_j * omega_j).cross(contact.n);
    contact.omega = omega_i - omega_j;
}

/// Sets all of the contact of a particle with surface k but the step size. The geometry is computed in
/// double precision. Returns false if there is no overlap.
HILDA_HD inline bool find_boundary_contact(ContactPoint<float>& contact, const CellGrid& grid,
                                           const Position& p, const Float4& v, const Float4& w,
                                           const Surfaces& surfaces, std::uint32_t k,
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
    set_rates(contact, narrow(Vec3{v.x, v.y, v.z} - velocity(b, r - near.distance * near.n)),
              Vec<float>{w.x, w.y, w.z}, narrow(b.omega));
    if (lever == Lever::contact) move_to_contact_point(contact, Vec<float>{w.x, w.y, w.z}, narrow(b.omega));
    return true;
}

}  // namespace hilda::granular
