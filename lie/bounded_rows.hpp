// SPDX-License-Identifier: GPL-3.0-or-later
/// Regularised rows with a Coulomb bound, as friction with springs and dashpots at the end of a step.

#pragma once

#include "lie/bounded_pair.hpp"

#include <memory>
#include <vector>

namespace hilda::lie {

class CoupledBounds;
class Saddle;
struct State;
class System;

/// The pairs of a step from t_n, and the search for the compliance scale p ≥ 1 of each pair. A step owns one
/// such object.
///
/// In the variables of a step the law of a pair is
///
///     C (h v) - compliance (h² λ) = -h K mobility S,     compliance = p mobility/h
///
/// The compliance is on the diagonal of the saddle matrix, with a negative sign (Rows::regularised).
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
/// A bound below 1e-9 |λ(1)|, such as zero, is replaced by this value, so that f has a root.
///
/// This search changes the p of each pair by itself. If it has not ended after `patience` solutions, as for
/// several bodies in contact with each other, the p of all pairs are computed together (CoupledBounds). The
/// caller limits the number of solutions.
class BoundedRows {
public:
    /// The system must outlive the object.
    explicit BoundedRows(const System& system);
    ~BoundedRows();

    /// Evaluates the pairs in the state x, for a step h from it. All pairs stick: p = 1.
    void start(const State& x, double h);
    /// Of each regularised row, for Saddle::assemble() [1/kg]
    const std::vector<double>& compliance() const { return compliances; }
    /// Writes the right sides -h K mobility S of the pairs into the constraint part of a right side.
    void set_right_side(Eigen::Ref<Eigen::VectorXd> constraint_part) const;

    /// Returns true if the multipliers in z satisfy the bounds.
    ///
    /// Otherwise factors K with new p and returns false. The caller then solves the step again. The pairs
    /// with solved_first are treated first. The p of the other pairs change only when the former satisfy
    /// their bounds.
    ///
    /// z: solution of the step with the present K. Its multipliers may be scaled by a common positive factor.
    ///
    /// Throws NumericalFailure if the forces and the normal forces that bound them cannot be made consistent:
    /// "friction_has_no_solution" if a pair has μ ∂N/∂|λ| ≥ 1, so that Coulomb's law may have no solution,
    /// and "friction_not_converged" otherwise.
    ///
    /// resolution: error of the multipliers in z to which the caller solves. A smaller error of a bound is
    /// ignored after `patience` solutions.
    bool within_bounds(Saddle& K, Eigen::VectorXd& z, double resolution = 0);
    /// At a start: releases the pairs for which Coulomb's law has no solution, and returns whether there are
    /// any. The caller then solves again.
    ///
    /// `slip` holds C v of the regularised rows. The start opposes it by γ = -C v/τ, so that a pair sticks
    /// within `decay_time` τ [s] if its bound permits. If the normal force grows faster than the friction
    /// force that it bounds, μ ∂N/∂|λ| ≥ 1, a sliding pair sticks with an acceleration C v/τ, which is no
    /// force of Coulomb's law but an impulse (Painlevé). Such a pair starts without friction; the first step
    /// brings it to rest. K is factored with the present compliances, and z is the solution.
    bool release_impossible(Saddle& K, Eigen::VectorXd& z, const Eigen::VectorXd& slip, double decay_time);
    /// At a start: lets all pairs slip without friction whose slip exceeds `most` [m/s], and begins the
    /// search again. Returns false if there are none.
    bool release_slipping(Saddle& K, const Eigen::VectorXd& slip, double most);
    /// Number of solutions after which within_bounds() computes the p of all pairs together
    static constexpr int patience = 30;
    /// Throws the failure of within_bounds() for the largest excess of |λ| over its bound in z.
    [[noreturn]] void fail(Saddle& K, Eigen::VectorXd& z);

private:
    struct Search {
        int iterations = 0;
        double p = 1;  ///< present value
        double previous_p = 1, previous_f = 1;
        double length_at_one = 0;  ///< |λ(1)|
    };
    /// The next p of a pair with |λ(p)| = length and μ N(p) = bound. Returns p itself if the iteration has
    /// converged.
    static double next_scale(Search& s, double bound, double length);
    void set_compliance(size_t n);
    void release(size_t n);
    bool change_each(Saddle& K, Eigen::VectorXd& z);
    bool change_all(Saddle& K, Eigen::VectorXd& z, double resolution);

    const System& system;
    std::vector<BoundedPair> pair;
    std::vector<Search> search;
    std::vector<double> compliances, scales, floors;
    std::unique_ptr<CoupledBounds> coupled;
    int solved = 0;  ///< solutions of this step
    double h = 0;
};

}  // namespace hilda::lie
