// SPDX-License-Identifier: GPL-3.0-or-later
/// Primal-dual interior point method for the convex cone problem with given slip terms: Nesterov-Todd
/// scaling and Mehrotra's predictor-corrector (Nesterov, Todd 1998; Andersen, Roos, Terlaky 2003).
///
/// With S = diag(1, μ, μ) both variables of a contact point are in the second-order cone {|a_t| ≤ a_n}:
///
///     s = S (u + offset n),     p = S z,     s ∘ z = 0      a ∘ b = (a · b, a_n b_t + b_n a_t)
///
/// The symmetric W with W z = W⁻¹ s =: l scales them. A Newton step for s ∘ z = σ m e satisfies
///
///     (M + Σ C_cᵀ S W⁻² S C_c) dv + C_bᵀ dλ = …,    dz = W⁻¹ (l \ r - W⁻¹ ds)
///
/// 8 to 34 factorisations solve stacks, walls and chains with mass ratios of 10⁴ to 10⁻⁶ m/s.

#pragma once

#include "lie/cones/body_matrix.hpp"
#include "lie/cones/cone_problem.hpp"

#include <vector>

namespace hilda::lie {

class ConeInteriorPoint {
public:
    using Iterate = ConeProblem::Iterate;

    /// Solves the convex problem with the offsets of x from a start of its own, until the residual is below
    /// the tolerance [m/s], or no step is possible, or after `most` iterations. Sets the velocities,
    /// multipliers and impulses of x to the last iterate, and x.residual to the residual of the convex
    /// problem. Returns the number of factorisations.
    int solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, double tolerance, int most = 60);

private:
    struct Point {
        Vec3 s, z, ds, dz, l, r;  ///< r: right side of the complementarity, s ∘ z
        Mat3 W, W_inverse;
        double mu = 0;
        Vec3 scaled(const Vec3& a) const { return {a[0], mu * a[1], mu * a[2]}; }
    };
    void start(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x);
    void set_residual(const ConeProblem& problem, Iterate& x);
    void scale();
    /// Step for the fraction `share` of the linear residuals
    void set_step(const ConeProblem& problem, BodyMatrix& matrix, const Iterate& x, double share);
    double longest_step(double most) const;

    std::vector<Point> point;
    std::vector<Mat3> weights;
    Eigen::VectorXd e, b, step;
};

}  // namespace hilda::lie
