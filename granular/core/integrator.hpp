// SPDX-License-Identifier: GPL-3.0-or-later
/// Time integration of particles under their loads.             Newton-Euler equations: Fang (2022), Eq. 2.17
///
/// Fang (2022) does not state the scheme of the particles. Chrono::GPU, the program of Ch. 6, offers the
/// schemes below except velocity Verlet. All are explicit with a constant step size h.

#pragma once

#include "granular/core/neighbours/neighbours.hpp"
#include "granular/core/orientation.hpp"

namespace hilda::granular {

/// Time integration schemes. The assignments are performed in the order in which they are written.
enum class Scheme : std::int32_t {
    symplectic_euler,  ///< symplectic (semi-implicit) Euler:  v += h a,  x += h v
    velocity_verlet,   ///< velocity Verlet:  v += h/2 a,  x += h v,  a = a(x),  v += h/2 a
    forward_euler,     ///< forward (explicit) Euler:  x += h v,  v += h a
    extended_taylor,   ///< second-order Taylor expansion of x:  x += h v + h²/2 a,  v += h a
    /// Explicit method of Chung and Lee (1994) with β = 28/27; b is the acceleration of the previous step:
    /// x += h v + h² (28/27 a - 29/54 b),  v += h (3/2 a - 1/2 b)
    chung
};

/// Names in the order of Scheme
inline constexpr const char* scheme_names[] = {"symplectic-euler", "velocity-verlet", "forward-euler",
                                               "extended-taylor", "chung"};

/// Time from the instant of the velocities to that of the positions when the loads are computed, over h. The
/// velocity in the store is the displacement of one step over h: of the step before for symplectic Euler and
/// velocity Verlet, of the next one for forward Euler. It is that of the middle of this step. With the other
/// schemes it is that of the instant of the positions.
HILDA_HD constexpr double velocity_lag(Scheme scheme)
{
    switch (scheme) {
        case Scheme::symplectic_euler:
        case Scheme::velocity_verlet:
            return 0.5;
        case Scheme::forward_euler:
            return -0.5;
        case Scheme::extended_taylor:
        case Scheme::chung:
            break;
    }
    return 0;
}

/// Step size, and time from the velocities to the positions [s]; see velocity_lag()
struct LoadTimes {
    float h, lag;
};

/// Parts of a step
enum class Part : std::int32_t {
    whole,         ///< the whole step
    before_loads,  ///< velocity Verlet: first half kick and drift, before the loads at t_{n+1} are computed
    after_loads,   ///< velocity Verlet: second half kick, with the loads at t_{n+1}
    only_loads     ///< accelerations from loads; velocities and positions do not change
};

/// Increments of velocity and position, or of angular velocity and rotation vector
template <class R>
struct Increment {
    Vec<R> dv, dx;
};

/// Increments of one step, or of a part of it.
///
/// v: velocity at t_n, for Part::after_loads after the first half kick. acc: acceleration at t_n, for
/// Part::after_loads at t_{n+1}. previous: acceleration of the previous step, used by `chung`.
template <class R>
HILDA_HD inline Increment<R> increment(Scheme scheme, Part part, const Vec<R>& v, const Vec<R>& acc,
                                       const Vec<R>& previous, Number<R> h)
{
    const auto times = [](Number<R> s, const Vec<R>& a) { return R(s) * a; };
    switch (scheme) {
        case Scheme::forward_euler:
            return {times(h, acc), times(h, v)};
        case Scheme::extended_taylor:
            return {times(h, acc), times(h, v) + times(h * h / 2, acc)};
        case Scheme::chung:
            return {times(Number<R>(1.5) * h, acc) - times(Number<R>(0.5) * h, previous),
                    times(h, v) + times(h * h * 28 / 27, acc) - times(h * h * 29 / 54, previous)};
        case Scheme::velocity_verlet: {
            const Vec<R> dv = times(h / 2, acc);
            return {dv, part == Part::before_loads ? times(h, v + dv) : times(0, v)};
        }
        case Scheme::symplectic_euler:
            break;
    }
    return {times(h, acc), times(h, v + times(h, acc))};
}

/// Compensated addition v += d: the rounding error is stored in `compensation` and added in the next call.
///
/// TwoSum without a branch (Knuth). The increment of a velocity by gravity in one step may be smaller than
/// the last digit of the velocity; plain addition would lose it.
template <class R>
HILDA_HD inline void add(R& v, R d, R& compensation)
{
    const R all = d + compensation, sum = v + all, part = sum - v;
    compensation = (v - (sum - part)) + (all - part);
    v = sum;
}
template <class R>
HILDA_HD inline void add(Vec<R>& v, const Vec<R>& d, Vec<R>& compensation)
{
    add(v.x, d.x, compensation.x), add(v.y, d.y, compensation.y), add(v.z, d.z, compensation.z);
}

/// State of a particle in a step
template <class R>
struct ParticleState {
    Vec<R> v, omega;                            ///< [m/s, rad/s]
    Vec<R> v_compensation, omega_compensation;  ///< rounding errors of v and omega [m/s, rad/s]
    Vec<R> remainder;                           ///< rounding remainder of the position [units]
    R radius, inverse_mass;                     ///< [m, 1/kg]; inverse_mass is 0 for a fixed particle
};

/// Displacement of a particle: translation [units] including the remainder of the previous step, and rotation
/// vector in the global frame [rad]
template <class R>
struct Displacement {
    Vec<R> translation, rotation;
};

/// Parameters of a step that are common to all particles
struct StepParameters {
    Scheme scheme;
    Part part;
    Vec<float> gravity;             ///< [m/s²]
    float h, units_per_metre;       ///< step size [s]; 1/CellGrid::unit [1/m]
    float torque_factor;            ///< 1; 0 if angular velocities are locked
    float displacement_dither;      ///< of positions; see split_displacement
    std::uint32_t velocity_dither;  ///< of v and omega; see round_to_bfloat16
};

/// Advances a particle by one step, or by a part of it, under the force F [N] and the torque T [N m].
///
///     a = F/m + g,    alpha = T/(2/5 m R²)
///
/// acc and alpha are the accelerations of the previous step on entry and those of this step on return. A
/// fixed particle keeps its position and velocities.
template <class R>
HILDA_HD inline Displacement<R> advance_particle(const StepParameters& s, ParticleState<R>& m,
                                                 const Vec<R>& F, const Vec<R>& T, Vec<R>& acc, Vec<R>& alpha)
{
    Vec<R> a = acc, b = alpha;
    const Mask<R> moves = m.inverse_mass > R(0.f);
    if (s.part != Part::before_loads) {
        const R inverse_inertia = (R(2.5f) * m.inverse_mass) / (m.radius * m.radius);
        a = m.inverse_mass * F + Vec<R>{R(s.gravity.x), R(s.gravity.y), R(s.gravity.z)};
        b = (R(s.torque_factor) * inverse_inertia) * T;
    }
    const Vec<R> zero{R(0.f), R(0.f), R(0.f)};
    a = select(moves, a, zero);
    if (s.part == Part::only_loads) {
        acc = a, alpha = b;
        return {m.remainder, zero};
    }
    const Increment<R> linear = increment(s.scheme, s.part, m.v, a, acc, s.h);
    const Increment<R> angular = increment(s.scheme, s.part, m.omega, b, alpha, s.h);
    add(m.v, linear.dv, m.v_compensation), add(m.omega, angular.dv, m.omega_compensation);
    acc = a, alpha = b;
    return {select(moves, R(s.units_per_metre) * linear.dx, zero) + m.remainder, angular.dx};
}

/// The arrays that a step reads and writes; see Particles and Pairs.
struct AdvanceView {
    Position* position;
    Float4 *velocity, *omega;
    Compensation* compensation;
    Float4 *acc, *alpha;  ///< of the previous step; nullptr if the scheme does not use them
    Float4 *orientation, *orientation_compensation;    ///< nullptr unless orientations are stored
    const std::uint32_t *start, *other_start, *other;  ///< the last two and the loads: not used on the CPU
    const Load* load;
    const std::uint8_t* in_contact;  ///< the load of a pair without contact is zero
    const Float4* torque;            ///< nullptr without laws of rolling and spin
    const Float4* force;             ///< external forces by particle id [N]; nullptr if there are none
    const std::uint32_t* id;
    StepParameters step;
    /// Receives the force and the torque of each particle about its centre [N, N m]; nullptr without clumps
    Load* total = nullptr;
    const std::uint8_t* ghost = nullptr;  ///< see Particles; only on the CPU
};

/// Advances all particles on a back end other than the CPU, which has sweep(); see loops.hpp. The loads of a
/// particle are summed in the order of its pairs, so that the result does not depend on the number of
/// threads. Returns the largest |v|² of the particles that are not fixed [m²/s²]; NaN if one is NaN.
template <class Backend>
float advance(Backend on, std::uint32_t particles, const AdvanceView& arrays);

}  // namespace hilda::granular
