// SPDX-License-Identifier: GPL-3.0-or-later
/// Search for the compliance scales of regularised rows, such that the multipliers satisfy the Coulomb bound.

#pragma once

#include "lie/rows.hpp"
#include "lie/state.hpp"

#include <vector>

namespace hilda::lie {

class Saddle;

/// Determines the compliance scale p ≥ 1 of each pair of Rows::Regularised.
///
/// With the compliance scaled by p, the solution of the step has the multipliers λ(p) of the pair and the
/// normal force N(p). Let
///
///     f(p) = μ N(p)/|λ(p)|
///
/// A pair with f(1) ≥ 1 sticks: p = 1. Otherwise it slips, and p > 1 is the root of f(p) = 1.
///
/// The root is found by iteration. An iteration needs one solution of the step with the present p of all
/// pairs. The first iteration sets p ← p/f. This is exact for constant N if the bodies are so heavy that λ
/// does not change their velocities. Later iterations use the secant of the last two values of f, or p/f if
/// the slope of the secant is not positive.
///
/// For constant N, f is a linear function of p if the effective mass of the bodies is the same in both
/// directions, as for a sphere. The third solution is then exact. In other cases f is nearly linear. (f(p) =
/// 1 has the form of the secular equation of trust-region methods.)
///
/// At the root λ is parallel to the force of spring and dashpot for the velocity at the end of the step. This
/// holds for any inertia. Scaling back the multipliers of the sticking solution (radial return) would give
/// their direction instead.
///
/// A bound of zero is replaced by 1e-9 |λ(1)|, so that f has a root. The caller limits the number of
/// solutions.
class BoundedRows {
public:
    explicit BoundedRows(const Rows& pattern) : search(pattern.regularised.size()) {}

    /// Sets p = 1 for all pairs. To be called before K.assemble() at the beginning of a step.
    void all_stick(Saddle& K);
    /// Returns whether the multipliers in z satisfy the bounds; C holds the rows at the node t_n, x is the
    /// current iterate.
    ///
    /// If not, K is factored with new p and the step has to be solved again. Pairs with solved_first are
    /// treated first. The p of the others change only when the bounds of these are satisfied.
    bool operator()(Saddle& K, const Rows& C, Eigen::VectorXd& z, const State& x);

private:
    struct PairSearch {
        int iterations = 0;
        double p = 1, f = 1;       ///< of the iteration before
        double length_at_one = 0;  ///< |λ(1)|
    };
    /// The next p of a pair with |λ(p)| = length, and bound = μ N(p); p itself if the pair satisfies its
    /// bound
    static double next_scale(PairSearch& s, double p, double bound, double length);

    std::vector<PairSearch> search;
};

}  // namespace hilda::lie
