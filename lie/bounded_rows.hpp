// SPDX-License-Identifier: GPL-3.0-or-later
/// Regularised rows with a Coulomb bound, as friction with springs and dashpots at the end of a step.

#pragma once

#include "lie/so3.hpp"

#include <vector>

namespace hilda::lie {

class Saddle;
struct State;
class System;

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
/// A bound below 1e-9 |λ(1)|, such as zero, is replaced by this value, so that f has a root. The caller
/// limits the number of solutions.
class BoundedRows {
public:
    /// The system must outlive the object.
    explicit BoundedRows(const System& system);

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
    bool within_bounds(Saddle& K, Eigen::VectorXd& z);

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

    const System& system;
    std::vector<BoundedPair> pair;
    std::vector<Search> search;
    std::vector<double> compliances;
    double h = 0;
};

}  // namespace hilda::lie
