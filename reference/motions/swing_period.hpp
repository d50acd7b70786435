// SPDX-License-Identifier: GPL-3.0-or-later
/// The period of a swing with one coordinate, by quadrature.

#pragma once

#include <functional>

namespace hilda::reference {

/// Period [s] of M(q) q̇²/2 + U(q) = U(q_0), both even in q, that swings between -q_0 and q_0.
///
///     T = 4 ∫₀^q₀ √(M/(2 (U(q_0) - U(q)))) dq,    q = q_0 sin χ
///
/// In χ the integrand is smooth, even about both ends and periodic, so that the sum over the middles of N equal
/// parts converges faster than any power of 1/N. N is doubled until nothing changes. fall(q, q_0 - q) is
/// U(q_0) - U(q); the difference comes with it because a fall that is taken from two heights, or from a rounded q,
/// has no digits near q_0. M and U are smooth. lie::NumericalFailure when it does not converge, from a q_0 at rest;
/// InvalidInput unless q_0 and the fall are positive.
double swing_period(double q_0, const std::function<double(double q)>& M,
                    const std::function<double(double q, double to_go)>& fall);

}  // namespace hilda::reference
