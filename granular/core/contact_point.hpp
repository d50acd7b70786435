// SPDX-License-Identifier: GPL-3.0-or-later
/// A contact as the laws of force see it.                                              Fang (2022), Sec. 2.2.1

#pragma once

#include "granular/backend/real.hpp"

namespace hilda::granular {

/// Two bodies that overlap. Vectors are global. Against a wall, R_j is zero and the wall has no mass to share.
template <class R>
struct ContactPoint {
    R delta;         ///< overlap [m], positive
    R R_i, R_j;      ///< [m]; the levers of the tangential force
    R R_eff, m_eff;  ///< R_i R_j/(R_i + R_j) [m], m_i m_j/(m_i + m_j) [kg]; R_i and m_i against a wall
    Vec<R> n;        ///< out of j, into i
    R v_n;           ///< rate of the overlap [m/s], positive in approach
    Vec<R> v_t;      ///< velocity of the surface of i over that of j, across n [m/s]
    Vec<R> omega;    ///< ω_i - ω_j [rad/s]
    Number<R> h;     ///< step [s]
};

/// What a contact keeps from step to step; zero where bodies meet
template <class R>
struct History {
    Vec<R> u;      ///< tangential displacement [m]
    R age;         ///< [s]
    Vec<R> psi;    ///< rolling displacement [rad]
    R spin;        ///< twist about n [rad]
    Mask<R> slid;  ///< whether the surfaces slid in the step before
};

/// The answer of a normal law
template <class R>
struct NormalForce {
    R F;      ///< along n on body i [N]; damping may make it tensile at the end of a contact
    R scale;  ///< what the tangential stiffness of this law goes by: √(R_eff δ), √(δ/R) or 1
    Number<R> power = 0;  ///< scale goes with this power of δ
};

}  // namespace hilda::granular
