// SPDX-License-Identifier: GPL-3.0-or-later
/// Equations of motion of rigid body boundaries (tools), by a leapfrog of the angular momentum.
///
///     m v' = F,    r' = v
///     L' = T,      L = J(p) ω,    J(p) = A(p) J̄ A(p)ᵀ
///
/// The step from t_n to t_{n+1} rotates the body by the rotation vector θ̄ = h ω̄ in its own frame:
///
///     L_n = A_n J_r(θ̄)⁻¹ J̄ ω̄,    A_{n+1} = A_n exp(θ̄),    L_{n+1} = L_n
///
/// J_r: right Jacobian of the rotation group. This is the step of the scheme rA-half-1-momentum for a free
/// body, the discrete Euler-Lagrange equation of the Lagrangian θ̄ᵀ J̄ θ̄/(2 h). It is symmetric and of order
/// 2, and keeps L to rounding. The gyroscopic torque is part of it.               Hante and Arnold (2021)
///
/// Rotations about an axis of the global frame that is not free have a prescribed angular velocity. The
/// constraint torques are along these axes, so that the equations of L hold along the others.

#pragma once

#include "granular/core/boundary.hpp"

namespace hilda::granular {

/// L = J(p) ω of a boundary, in the global frame [kg m²/s]
Vec3 angular_momentum(const Boundary& b);
/// 1/2 m v·v + 1/2 ω·L [J]
double kinetic_energy(const Boundary& b);

/// Whether a body may have this inertia: the principal moments are positive and none is larger than the sum
/// of the other two.
bool is_inertia(const Inertia& J);

/// Adds the impulses h (F + m g) and h T to the momenta of the free directions and updates v and ω.
/// v += h (F/m + g) has no part along the axes that are not free.
void accelerate(Boundary& b, const Vec3& F, const Vec3& T, const Vec3& g, double h);

/// Sets the angular velocity about the axes that are not free. The angular momenta about the other axes stay
/// the same.
void prescribe_omega(Boundary& b, const Vec3& omega);

/// Mean angular velocity A_n ω̄ of the step of size h, in the global frame [rad/s]. Without free rotation it
/// is ω. Throws io::NumericalFailure if the body would turn so far in one step that the iteration does not
/// converge, which is above 1 rad.
Vec3 mean_omega(const Boundary& b, double h);

/// Moves a body with p and ω of t_n by a step of size h with the mean angular velocity: p and ω become those
/// of t_{n+1}. For a body without free rotation, ω does not change.
void rotate(Boundary& b, const Vec3& mean_omega, double h);

}  // namespace hilda::granular
