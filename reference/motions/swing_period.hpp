// SPDX-License-Identifier: GPL-3.0-or-later
/// Period of an oscillation with one degree of freedom, by quadrature of the energy integral.

#pragma once

#include <functional>

namespace hilda::reference {

/// Period [s] of the oscillation M(q) q̇²/2 + U(q) = U(q_0) between -q_0 and q_0, with smooth M and U, even
/// in q.
///
///     T = 4 ∫₀^q₀ √(M/(2 (U(q_0) - U(q)))) dq,    q = q_0 sin χ
///
/// As a function of χ the integrand is smooth, periodic and even about both ends. The midpoint rule with N
/// intervals therefore converges faster than any power of 1/N. N is doubled until the relative change is
/// below 1e-14.
///
/// @param q_0   amplitude
/// @param M     generalised mass
/// @param drop  drop(q, q_0 - q) = U(q_0) - U(q). The second argument avoids cancellation near q_0: the
///              difference of two potentials, or of q_0 and a rounded q, has no correct digits there.
///
/// Throws lie::InvalidInput if q_0 or a drop is not positive, and lie::NumericalFailure "quadrature_failed"
/// if the rule does not converge, as for a q_0 that is an equilibrium.
double swing_period(double q_0, const std::function<double(double q)>& M,
                    const std::function<double(double q, double remaining)>& drop);

}  // namespace hilda::reference
