// SPDX-License-Identifier: GPL-3.0-or-later
/// The compliance scales of several pairs of regularised rows that act on each other.

#pragma once

#include "lie/bounded_rows.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <vector>

namespace hilda::lie {

class Saddle;

/// Solves for the compliance scales p of all pairs together (see BoundedRows).
///
/// Changing the compliance of the pairs by Δ adds Δ λ to the right sides of their rows. With the responses
/// S = ∂λ/∂g and Q = ∂N/∂g to the right sides g of the rows, and the multipliers λ₀ and normal forces N₀ of
/// the present solution,
///
///     λ(p) = (I - S Δ(p))⁻¹ λ₀,     N(p) = N₀ + Q Δ(p) λ(p)
///
/// exactly for the linear equations of the step. S and Q take two solutions with K for each active pair. With
/// q = ln p and s = ln(μ N/|λ|) the law is min(q, s) = 0 for each pair: a pair sticks with q = 0, or slips
/// with s = 0. It is solved by a semismooth Newton method. If Newton's step does not reduce the residual, the
/// step q ← max(0, q - s) of all pairs is taken instead. For constant N this iteration decreases the convex
/// function whose minimum is the solution (iteratively reweighted least squares), so it converges for any
/// number of pairs.
///
/// p is at most largest_scale: a larger compliance makes K singular to working precision.
///
/// The search of BoundedRows changes each pair by itself. It is cheaper for a single contact and may fail for
/// bodies that touch each other.
class CoupledBounds {
public:
    static constexpr double largest_scale = 1e12;

    /// Computes p of each pair. On entry p has the present scales, with which K is factored and z solved.
    /// floor[n] is the smallest bound of |λ| of pair n. Returns false if no p is found.
    ///
    /// Allocates memory if the number of active pairs differs from that of the last call.
    bool solve(Saddle& K, Eigen::VectorXd& z, const std::vector<BoundedPair>& pair, double h,
               const std::vector<double>& floor, std::vector<double>& p);

    /// ∂N/∂|λ| of a pair whose force has the direction t of its two rows, with the present compliance of the
    /// other pairs. Coulomb's problem of a sliding contact has no unique solution if μ ∂N/∂|λ| ≥ 1.
    double normal_response(Saddle& K, const BoundedPair& pair, const Eigen::Vector2d& t);

private:
    void set_responses(Saddle& K);
    void evaluate();
    bool newton_step();
    double largest_residual() const { return residual.cwiseAbs().maxCoeff(); }

    struct Active {
        const BoundedPair* pair;
        size_t number;
        double mobility;  ///< compliance for p = 1 in the units of the matrix: mobility/h
        double p, floor;  ///< on entry
    };
    std::vector<Active> active;
    Eigen::MatrixXd S, Q;  ///< 2a × 2a and a × 2a for a active pairs
    Eigen::MatrixXd matrix, by_q, lambda_by_q, J;
    Eigen::PartialPivLU<Eigen::MatrixXd> regularised, newton;  ///< of I - S Δ and of J
    Eigen::VectorXd lambda_0, N_0, lambda, N, q, s, bound, delta, change, residual, q_before, step, b;
};

}  // namespace hilda::lie
