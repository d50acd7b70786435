// SPDX-License-Identifier: GPL-3.0-or-later
/// Search for the compliance scales of regularised rows, such that the multipliers satisfy the Coulomb bound.

#pragma once

#include "lie/rows.hpp"
#include "lie/state.hpp"

#include <vector>

namespace hilda::lie {

class Saddle;

/// Determines the compliance scale p ≥ 1 of each pair of regularised rows (Rows::Regularised).
///
/// With the compliance scaled by p, the solution of the step has the multipliers λ(p) of the pair and the
/// normal force N(p). Let
///
///     f(p) = μ N(p)/|λ(p)|
///
/// A pair with f(1) ≥ 1 sticks: p = 1. Otherwise it slips, and p > 1 is the root of f(p) = 1.
///
/// The root is found by iteration. An iteration needs one solution of the step with the present p of all
/// pairs. The first iteration sets p ← p/f. This is exact if N is constant and the bodies are so heavy that λ
/// does not change their velocities. Later iterations use the secant method, or p ← p/f if the slope of the
/// secant is not positive.
///
/// For constant N, f is a linear function of p if the effective mass of the bodies is the same in both
/// directions, as for a sphere. The third solution is then exact. In other cases f is nearly linear. The
/// equation f(p) = 1 has the form of the secular equation of trust-region methods.
///
/// At the root λ is parallel to the force of spring and dashpot for the velocity at the end of the step.
/// This holds for any inertia. The alternative is to scale λ(1) back to the bound (radial return). The
/// result would keep the direction of λ(1), which differs if the effective mass depends on the direction.
///
/// A bound below 1e-9 |λ(1)|, such as zero, is replaced by this value, so that f has a root. The caller
/// limits the number of solutions.
class BoundedRows {
public:
    explicit BoundedRows(const Rows& pattern) : search(pattern.regularised.size()) {}

    /// Sets p = 1 for all pairs. To be called before K.assemble() at the beginning of a step.
    void all_stick(Saddle& K);
    /// Returns true if the multipliers in z satisfy the bounds.
    ///
    /// Otherwise factors K with new p and returns false. The caller then solves the step again. The pairs
    /// with solved_first are treated first. The p of the other pairs change only when the former satisfy
    /// their bounds.
    ///
    /// z: solution of the step with the present K. Its multipliers may be scaled by a common positive
    /// factor. C: the rows at the node t_n, with mu and n of each pair. x: argument of
    /// Saddle::refactor_regularised().
    bool operator()(Saddle& K, const Rows& C, Eigen::VectorXd& z, const State& x);

private:
    struct PairSearch {
        int iterations = 0;
        double p = 1, f = 1;       ///< values of the previous iteration
        double length_at_one = 0;  ///< |λ(1)|
    };
    /// The next p of a pair with |λ(p)| = length and μ N(p) = bound. Returns p itself if the iteration has
    /// converged.
    static double next_scale(PairSearch& s, double p, double bound, double length);

    std::vector<PairSearch> search;
};

}  // namespace hilda::lie
