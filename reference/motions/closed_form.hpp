// SPDX-License-Identifier: GPL-3.0-or-later
/// Motions that are known without a constraint solver: planar chains of bars in their angles, and tops.

#pragma once

#include "lie/trajectory.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

struct PlanarBar {
    double length = 1;    ///< [m] from its joint to the next; the centre of mass is half-way
    double m = 1, J = 1;  ///< [kg], [kg m²] about the axis of the plane through the centre of mass
    double theta = 0, thetadot = 0;  ///< at the start [rad, rad/s]
};

/// Bars hinged to each other, the first to a fixed point, turning about one axis; the two-angle equations of
/// the double pendulum for two of them.
///
/// Bar i points along u_i = cos θ_i e + sin θ_i (axis × e). With r_k = origin + Σ_j c_kj u_j, where c_kj is
/// the length of a bar before k and half of that of k itself, and S_ij = Σ_k m_k c_ki c_kj, Lagrange's
/// equations are
///
///     J_i θ̈_i + Σ_j S_ij (cos(θ_i - θ_j) θ̈_j + sin(θ_i - θ_j) θ̇_j²) = Σ_k m_k c_ki g · (axis × u_i)
struct PlanarChain {
    std::vector<PlanarBar> bar;
    Vec3 origin = Vec3::Zero();        ///< of the first hinge
    Vec3 e = -Vec3::UnitZ();           ///< θ = 0, a unit vector perpendicular to the axis
    Vec3 axis = Vec3::UnitX();         ///< a unit vector
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< what of it is along the axis, the hinges take
    double t_0 = 0;                    ///< [s], of the start

    /// States at these instants [s], ascending, none before t_0, by rk8pd on the angles. The body frame of a
    /// bar is (u, axis × u, axis). Multipliers are left empty: they belong to a model.
    lie::Trajectory at(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
};

/// Regular precession: a body turns about an axis fixed in it at the constant rate b̄, and that axis about one
/// fixed in space at the constant rate a.
///
///     A(t) = exp(ã t) A(0) exp(b̄~ t),    ω̄ = Aᵀ a + b̄,    ω̄̇ = (Aᵀ a) × b̄
struct RegularPrecession {
    Vec3 a = Vec3::Zero();      ///< [rad/s], global
    Vec3 b_bar = Vec3::Zero();  ///< [rad/s], body frame

    /// A, ω̄, ω̄̇ after the time t, from A = A_0; r and its derivatives are left at zero
    Motion attitude(const Mat3& A_0, double t) const;
};

/// Free flight of a body with two equal principal moments: its centre falls, and it precesses about its
/// angular momentum H = A J̄ ω̄ at |H|/J_1.                                      Landau, Lifshitz I, § 33
///
/// With J̄ = diag(J_1, J_1, J_3) and k = (J_1 - J_3)/J_1 ω̄_3, Euler's equations turn ω̄ about the body's axis
/// at -k, so that a = H/J_1 and b̄ = k ẑ. Any of the three axes may be the one of symmetry; InvalidInput when
/// none is.
class FreeTop {
public:
    /// J̄ diagonal; the start at t_0
    FreeTop(const Vec3& J_bar, const Motion& start, const Vec3& gravity, double t_0 = 0);
    Motion at(double t) const;

private:
    Motion start;
    Vec3 gravity;
    double t_0;
    RegularPrecession precession;
};

/// A symmetric top whose tip is held at the origin, in steady precession: the nutation θ is constant. Its
/// axis of symmetry, the body's z axis, goes round the vertical at Ω, and it spins about it at ψ̇ besides.
///
///     Ω (J_3 ω̄_3 - (J_1 + m l²) Ω cos θ) = m g l,    ω̄_3 = ψ̇ + Ω cos θ
///     A(t) = Rz(Ωt) Rx(θ) Rz(ψ̇t)
///
/// The angular momentum about the tip is H = (J_1 + m l²) Ω ẑ + (J_3 ω̄_3 - (J_1 + m l²) Ω cos θ) k̂, k̂ the
/// axis; Ḣ = Ω ẑ × H is the moment of the weight, m g l ẑ × k̂, and that is the first line.
struct HeavyTop {
    double m = 1, J_1 = 1, J_3 = 1;  ///< [kg], [kg m²] about the centre of mass
    double l = 1, g = 9.81;          ///< [m] from the tip to the centre of mass, [m/s²] along -z
    double theta = 0.5, Omega = 1;   ///< [rad], [rad/s], not zero

    double omega_bar_3() const;  ///< [rad/s], that which makes the precession steady
    Motion at(double t) const;   ///< all of it; Rz(Ωt) at t = 0 is the identity
};

/// ω̄(t) of a torque-free body with J_1 < J_2 < J_3 that starts with ω̄ = (w_1, 0, w_3), w_1 and w_3 positive,
/// by Jacobi's elliptic functions.                                             Landau, Lifshitz I, § 37
///
///     ω̄ = (w_1 cn τ, w_2 sn τ, w_3 dn τ),    τ = t √((J_3 - J_2)(J_3 - J_1)/(J_1 J_2)) w_3
///     w_2² = w_1² J_1 (J_3 - J_1)/(J_2 (J_3 - J_2))
///     k²  = w_1² J_1 (J_2 - J_1)/(w_3² J_3 (J_3 - J_2)),    at most one
///
/// InvalidInput outside of that: for other orders of the moments, and k² > 1, where it circles the other
/// axis.
Vec3 asymmetric_top(const Vec3& J_bar, double w_1, double w_3, double t);

}  // namespace hilda::reference
