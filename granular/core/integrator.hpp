// SPDX-License-Identifier: GPL-3.0-or-later
/// How particles move by what acts on them.                                          Fang (2022), Sec. 6.1

#pragma once

#include "granular/core/neighbours.hpp"
#include "granular/core/orientation.hpp"

namespace hilda::granular {

enum class Scheme : std::int32_t {
    symplectic_euler,  ///< v += h a,  x += h v
    velocity_verlet,   ///< v += h/2 a,  x += h v,  a at the new x,  v += h/2 a
    forward_euler,     ///< x += h v,  v += h a
    extended_taylor,   ///< x += h v + h²/2 a,  v += h a
    chung  ///< x += h v + h² (28/27 a - 29/54 a_before),  v += h (3/2 a - 1/2 a_before)      Chung and Lee (1994)
};

/// What of a step is done: all of it; the part before and the part after the loads at t_{n+1}; or that loads become
/// accelerations and nothing moves
enum class Part : std::int32_t { whole, before_loads, after_loads, only_loads };

/// What a step adds to a velocity and to a place, or to a turning and an angle
template <class R>
struct Change {
    Vec<R> v, way;
};

/// acc is that of t_n; of velocity_verlet, that of the node of the part
template <class R>
HILDA_HD inline Change<R> change(Scheme scheme, Part part, const Vec<R>& v, const Vec<R>& acc,
                                 const Vec<R>& before, Number<R> h)
{
    const auto times = [](Number<R> s, const Vec<R>& a) { return R(s) * a; };
    switch (scheme) {
        case Scheme::forward_euler:
            return {times(h, acc), times(h, v)};
        case Scheme::extended_taylor:
            return {times(h, acc), times(h, v) + times(h * h / 2, acc)};
        case Scheme::chung:
            return {times(Number<R>(1.5) * h, acc) - times(Number<R>(0.5) * h, before),
                    times(h, v) + times(h * h * 28 / 27, acc) - times(h * h * 29 / 54, before)};
        case Scheme::velocity_verlet: {
            const Vec<R> dv = times(h / 2, acc);
            return {dv, part == Part::before_loads ? times(h, v + dv) : times(0, v)};
        }
        case Scheme::symplectic_euler:
            break;
    }
    return {times(h, acc), times(h, v + times(h, acc))};
}

/// v + d, and in `rest` what rounding took from it: the gain by gravity of one step is below the last digits of a velocity
template <class R>
HILDA_HD inline void add(R& v, R d, R& rest)
{
    const R all = d + rest, sum = v + all, part = sum - v;
    rest = (v - (sum - part)) + (all - part);
    v = sum;
}
template <class R>
HILDA_HD inline void add(Vec<R>& v, const Vec<R>& d, Vec<R>& rest)
{
    add(v.x, d.x, rest.x), add(v.y, d.y, rest.y), add(v.z, d.z, rest.z);
}

/// A particle as a step sees it
template <class R>
struct Moving {
    Vec<R> v, omega;                  ///< [m/s, rad/s]
    Vec<R> v_rest, omega_rest, rest;  ///< left by rounding, of velocities and of ways [units]
    R radius, per_mass;               ///< [m, 1/kg]
};

/// What is to go [units], with what was left of the step before, and to turn, as a rotation vector [rad]
template <class R>
struct Went {
    Vec<R> way, angle;
};

struct StepOf {
    Scheme scheme;
    Part part;
    Vec<float> gravity;
    float h, per_metre;
    float turns;           ///< 0: torques do not turn particles
    float even;            ///< dither of ways; see carried
    std::uint32_t random;  ///< that of velocities and turnings; see upper_half
};

/// One step, or part of one, under F and T. acc and turn are those of the step before and become those of this one.
template <class R>
HILDA_HD inline Went<R> go(const StepOf& s, Moving<R>& m, const Vec<R>& F, const Vec<R>& T, Vec<R>& acc,
                           Vec<R>& turn)
{
    Vec<R> a = acc, b = turn;
    const Mask<R> moves = m.per_mass > R(0.f);
    if (s.part != Part::before_loads) {
        const R per_inertia = (R(2.5f) * m.per_mass) / (m.radius * m.radius);
        a = m.per_mass * F + Vec<R>{R(s.gravity.x), R(s.gravity.y), R(s.gravity.z)};
        b = (R(s.turns) * per_inertia) * T;
    }
    const Vec<R> zero{R(0.f), R(0.f), R(0.f)};
    a = select(moves, a, zero);
    if (s.part == Part::only_loads) {
        acc = a, turn = b;
        return {m.rest, zero};
    }
    const Change<R> of_v = change(s.scheme, s.part, m.v, a, acc, s.h);
    const Change<R> of_omega = change(s.scheme, s.part, m.omega, b, turn, s.h);
    add(m.v, of_v.v, m.v_rest), add(m.omega, of_omega.v, m.omega_rest);
    acc = a, turn = b;
    return {select(moves, R(s.per_metre) * of_v.way, zero) + m.rest, of_omega.way};
}

/// The arrays that a step reads and writes
struct Advance {
    Position* position;
    Four *velocity, *omega;
    Compensation* rest;
    Four *acc, *turn;                      ///< of the step before; nullptr where the scheme needs none
    Four *orientation, *orientation_rest;  ///< nullptr where it is not kept
    const std::uint32_t *start, *other_start, *other;
    const Load* load;
    const std::uint8_t* touches;  ///< where not, loads are zero
    const Four* torque;           ///< nullptr where no law resists turning
    const Four* force;            ///< from outside, by id [N]; nullptr where there is none
    const std::uint32_t* id;
    StepOf step;
};

/// Advances all particles, each by the sum of its loads in the order of its pairs; returns the largest |v|² of them.
float advance(par::Cpu, std::uint32_t particles, const Advance& arrays);
/// The same on another back end; see loops.hpp.
template <class Backend>
float advance(Backend on, std::uint32_t particles, const Advance& arrays);

}  // namespace hilda::granular
