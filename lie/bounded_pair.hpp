// SPDX-License-Identifier: GPL-3.0-or-later
/// A pair of regularised rows with a Coulomb bound, as friction with springs and dashpots at the end of a
/// step.

#pragma once

#include "lie/so3.hpp"

namespace hilda::lie {

/// A pair of regularised friction rows: the nonholonomic rows first and first + 1.
///
/// The two multipliers λ [N] model a spring and a dashpot at the end of the step h:
///
///     p λ = K (S + h C v) + D C v,     v = (ṙ, ω̄) at the end of the step,  C the two rows of (Φ_r, Π̄)
///     |λ| ≤ μ N,                       N = max(0, n · (λ_normal_row, λ_normal_row+1, λ_normal_row+2))
///
/// p = 1 if the spring and dashpot do not exceed the bound. Otherwise p > 1 scales the compliance such that
/// |λ| = μ N. λ is then parallel to the force of spring and dashpot for the velocity at the end of the step.
struct BoundedPair {
    // constant
    int first = 0, normal_row = 0;
    bool solved_first = false;  ///< p is determined before that of the pairs without this flag

    // of a state, see System::update_pairs()
    double K = 0, D = 0, mu = 0;                  ///< [N/m] (0: the pair is inactive), [N s/m], [1]
    Eigen::Vector2d S = Eigen::Vector2d::Zero();  ///< elastic displacement at t_n [m]
    Vec3 n = Vec3::Zero();                        ///< contact normal, global frame

    /// 1/(D + h K), the ratio of C v to λ for S = 0 and p = 1 [m/(N s)]; 0 for an inactive pair
    double mobility(double h) const { return K > 0 ? 1 / (D + h * K) : 0; }
};

}  // namespace hilda::lie
