// SPDX-License-Identifier: GPL-3.0-or-later
/// Motions without a constraint solver: planar chains of bars in minimal coordinates, and tops in closed
/// form.

#pragma once

#include "lie/trajectory.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

/// Bar of a PlanarChain
struct PlanarBar {
    double length = 1;               ///< from its hinge to the next [m]; the centre of mass is in the middle
    double m = 1, J = 1;             ///< [kg], [kg m²] about the hinge axis through the centre of mass
    double theta = 0, thetadot = 0;  ///< at t_0 [rad, rad/s]
};

/// Planar chain of bars with parallel hinges, the first hinge fixed. Two bars form the double pendulum.
///
/// Bar i has the direction u_i = cos θ_i e + sin θ_i (axis × e). The centres of mass are r_k = origin + Σ_j
/// c_kj u_j with c_kj = length_j for j < k, length_k/2 for j = k and 0 otherwise. With S_ij = Σ_k m_k c_ki
/// c_kj, Lagrange's equations are
///
///     J_i θ̈_i + Σ_j S_ij (cos(θ_i - θ_j) θ̈_j + sin(θ_i - θ_j) θ̇_j²) = Σ_k m_k c_ki g · (axis × u_i)
struct PlanarChain {
    std::vector<PlanarBar> bar;
    Vec3 origin = Vec3::Zero();        ///< position of the first hinge [m]
    Vec3 e = -Vec3::UnitZ();           ///< direction of θ = 0, a unit vector perpendicular to the axis
    Vec3 axis = Vec3::UnitX();         ///< hinge axis, a unit vector
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²]; the hinges carry the component along the axis
    double t_0 = 0;                    ///< time of the initial angles [s]

    /// States at ascending instants [s], none before t_0, integrated by rk8pd in the angles. The body frame
    /// of a bar is (u, axis × u, axis). The multipliers are empty, because they depend on the constraints of
    /// a model. Throws lie::InvalidInput if a length, mass or inertia is not positive, and the exceptions of
    /// Ode.
    lie::Trajectory at(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
};

/// Regular precession: the body rotates with the constant angular velocity b̄ about a body-fixed axis, and
/// this axis rotates with the constant angular velocity a about a fixed axis.
///
///     A(t) = exp(ã t) A(0) exp(b̄~ t),    ω̄ = Aᵀ a + b̄,    ω̄̇ = (Aᵀ a) × b̄
struct RegularPrecession {
    Vec3 a = Vec3::Zero();      ///< [rad/s], global
    Vec3 b_bar = Vec3::Zero();  ///< [rad/s], body frame

    /// A, ω̄, ω̄̇ at time t with A(0) = A_0. r and its derivatives are zero.
    Motion attitude(const Mat3& A_0, double t) const;
};

/// Free symmetric top: the centre of mass is in free fall, and the body precesses about its angular momentum
/// H = A J̄ ω̄ at the rate |H|/J_1.                                              Landau, Lifshitz I, § 33
///
/// With J̄ = diag(J_1, J_1, J_3) and k = (J_1 - J_3)/J_1 ω̄_3, Euler's equations rotate ω̄ about the symmetry
/// axis at the rate -k. The motion is a RegularPrecession with a = H/J_1 and b̄ = k ẑ. Any of the three axes
/// may be the symmetry axis.
class FreeTop {
public:
    /// J_bar: principal moments [kg m²]. `start`: state at t_0 [s]; it must contain r, A, ṙ, ω̄. gravity
    /// [m/s²]. Throws lie::InvalidInput unless two principal moments are equal.
    FreeTop(const Vec3& J_bar, const Motion& start, const Vec3& gravity, double t_0 = 0);
    Motion at(double t) const;  ///< state at time t [s], accelerations included

private:
    Motion start;
    Vec3 gravity;
    double t_0;
    RegularPrecession precession;
};

/// Heavy symmetric top with its tip fixed at the origin, in steady precession with constant nutation angle θ.
/// The symmetry axis, the z axis of the body, rotates about the vertical at the rate Ω. The spin about it is
/// ψ̇.
///
///     Ω (J_3 ω̄_3 - (J_1 + m l²) Ω cos θ) = m g l,    ω̄_3 = ψ̇ + Ω cos θ
///     A(t) = Rz(Ωt) Rx(θ) Rz(ψ̇t)
///
/// The first line follows from the angular momentum about the tip, H = (J_1 + m l²) Ω ẑ + (J_3 ω̄_3 - (J_1 +
/// m l²) Ω cos θ) k̂ with the symmetry axis k̂: Ḣ = Ω ẑ × H equals the moment of the weight, m g l ẑ × k̂.
struct HeavyTop {
    double m = 1, J_1 = 1, J_3 = 1;  ///< [kg]; principal moments about the centre of mass [kg m²]
    double l = 1, g = 9.81;          ///< [m] from the tip to the centre of mass, [m/s²] along -z
    double theta = 0.5, Omega = 1;   ///< [rad], [rad/s], not zero

    double omega_bar_3() const;  ///< spin component for which the precession is steady [rad/s]
    Motion at(double t) const;   ///< r, A and their derivatives at time t [s]
};

/// ω̄(t) [rad/s] of a torque-free body with J_1 < J_2 < J_3 and ω̄(0) = (w_1, 0, w_3), w_1 > 0, w_3 > 0.
///                                                                             Landau, Lifshitz I, § 37
///
/// In Jacobi's elliptic functions
///
///     ω̄ = (w_1 cn τ, w_2 sn τ, w_3 dn τ),    τ = t √((J_3 - J_2)(J_3 - J_1)/(J_1 J_2)) w_3
///     w_2² = w_1² J_1 (J_3 - J_1)/(J_2 (J_3 - J_2))
///     k²  = w_1² J_1 (J_2 - J_1)/(w_3² J_3 (J_3 - J_2)),    at most one
///
/// Throws lie::InvalidInput for moments in another order, for w_1 or w_3 not positive, and for k² > 1, where
/// the polhode encircles the axis of J_1. Throws lie::NumericalFailure "gsl_failed" if GSL fails.
Vec3 asymmetric_top(const Vec3& J_bar, double w_1, double w_3, double t);

}  // namespace hilda::reference
