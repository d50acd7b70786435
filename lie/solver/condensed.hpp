// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle system condensed to its multipliers (Schur complement).
///
///     | M  Cᵀ | | x |   | f |      S λ = C M⁻¹ f - g,   x = M⁻¹ (f - Cᵀ λ),   S = C M⁻¹ Cᵀ,  C = (Φ_r, Π̄)
///     | C  0  | | λ | = | g |
///
/// M stands for diag(M, J̄). It is block diagonal and constant, and is factored once: M = L Lᵀ. Then S = W Wᵀ
/// with W = C L⁻ᵀ. The compliance of regularised rows is added to the diagonal of S.
///
/// If rows may be dependent, S + ε D with D = diag(S) is factored. It is positive definite for all rows.
///
/// Consecutive rows between the same bodies form a group. S has a block for each pair of groups that share a
/// body. Its Cholesky factor is computed by blocks, in an order that AMD (SuiteSparse) determines once from
/// the pattern. A chain or a tree of joints has no fill-in.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"

namespace hilda::lie {

class Condensed {
public:
    /// Analyses the pattern. For the metric `unit` of Saddle, `mass` is the identity.
    Condensed(const Mass& mass, const Rows& pattern);

    /// Factors S of these rows. Returns false if the smallest pivot is below 1e-11 of its diagonal entry, or
    /// not finite: the rows are nearly dependent or not finite. If `shift` = ε is positive, factors S + ε D,
    /// with D = 1 for rows that are zero. Returns false then only if a number is not finite or too large.
    bool factor(const Rows& C, double shift = 0);

    /// Solves in place: (f, g) on entry, (x, λ) on return.
    void solve(Eigen::VectorXd& b);
    /// The same for f = 0; the f in b is not read.
    void solve_constraints(Eigen::VectorXd& b);

    /// The smallest ratio of a pivot to its diagonal entry of S
    double smallest_pivot() const { return smallest; }
    /// Number of multiplications of one factorisation, including the assembly of S
    double operations() const { return flops; }
    /// Number of off-diagonal blocks of the factor that are not blocks of S
    long fill_in() const { return fill; }

private:
    /// Rows first … first + rows - 1, all with entries for the same bodies in the same order
    struct Group {
        int first = 0, rows = 0, bodies = 0;
        int body = 0;      ///< index of its first body in `body_of`
        int w = 0;         ///< index of its part of W: for each body 6 columns of `rows` numbers
        int diagonal = 0;  ///< index of its diagonal block in `value`
    };
    /// An off-diagonal block of S and its factor: the rows of group `of`, at index `at` of `value`
    struct Block {
        int of = 0, at = 0;
    };
    /// Contribution of one body to a block of S: the product of the parts of W of two groups
    struct Term {
        int of, by, w_of, w_by, at;
    };
    /// Elimination of a column: the product of two of its blocks is subtracted from block `to`
    struct Update {
        int of, by, at_of, at_by, to;
    };

    void shift_diagonal(double shift);  ///< S ← S + shift D
    void solve_multipliers();           ///< y ← S⁻¹ y
    void finish(Eigen::VectorXd& b) const;  ///< x = L⁻ᵀ (L⁻¹ f - Wᵀ y), λ = y; b holds L⁻¹ f on entry

    void find_groups(const Rows& pattern);
    void analyse(const Rows& pattern);

    std::vector<double> by_sqrt_m;  ///< 1/√m of each body
    std::vector<Mat3> L_inverse;    ///< L⁻¹ of J̄ = L Lᵀ
    std::vector<Group> group;
    std::vector<int> body_of;
    std::vector<int> order;                 ///< of elimination, of the groups
    std::vector<Term> term;                 ///< of S
    std::vector<int> column, update_start;  ///< first index into `block` and `update`, by position in `order`
    std::vector<Block> block;
    std::vector<Update> update;
    std::vector<int> regularised_at;  ///< index of the diagonal entry of each regularised row in `value`
    std::vector<double> W, value, diagonal;  ///< diagonal: of S, the reference of the pivots
    Eigen::VectorXd y;
    double smallest = 1, flops = 0;
    long fill = 0;
};

}  // namespace hilda::lie
