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
/// Up to four consecutive rows between the same bodies form a group. S has a block for each pair of groups
/// that share a body. S = L E Lᵀ (Cholesky without square roots) is computed by blocks. The order of
/// elimination has the fill-in of AMD (SuiteSparse), and of all such orders an elimination tree of least
/// height (Jess and Kees 1982). A chain or a tree of joints has no fill-in.
///
/// A block with the rows of a group is stored by columns of four numbers, of which the last are zero if the
/// group has fewer rows. All operations are multiplications of such columns by a number.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/solver/columns.hpp"
#include "lie/solver/saddle_factors.hpp"

#include <array>
#include <map>
#include <utility>

namespace hilda::lie {

class Condensed final : public SaddleFactors {
public:
    /// Finds the order of elimination and the number of operations. For the metric `unit` of Saddle, `mass`
    /// is the identity.
    Condensed(const Mass& mass, const Rows& pattern);
    /// Makes the lists of operations, before the first factorisation. `pattern` is that of the constructor.
    void prepare(const Rows& pattern);

    /// Factors S of these rows. Returns false if the smallest pivot is below 1e-12 of its diagonal entry
    /// (1e-8 with regularised rows), or not finite: the rows are nearly dependent or not finite. If `shift` =
    /// ε is positive, factors S + ε D, with D = 1 for rows that are zero. Returns false then only if a number
    /// is not finite or too large.
    bool factor(const Rows& C, double shift = 0);

    /// Solves in place: (f, g) on entry, (x, λ) on return.
    void solve(Eigen::VectorXd& b) override;
    /// The same for f = 0; the f in b is not read.
    void solve_constraints(Eigen::VectorXd& b) override;

    /// The smallest ratio of a pivot to its diagonal entry of S
    double reciprocal_condition() const override { return smallest; }
    /// Number of multiplications of a column of four numbers in one factorisation, including the assembly
    /// of S
    double operations() const { return products; }
    /// Number of off-diagonal blocks of the factor that are not blocks of S
    long fill_in() const { return fill; }

private:
    static constexpr int most_rows = 4;  ///< of a group

    /// Rows first … first + rows - 1, all with entries for the same bodies in the same order
    struct Group {
        int first = 0, rows = 0, bodies = 0;
        int body = 0;                 ///< index of its first body in `body_of`
        int w = 0;                    ///< its first column in W: six for each body
        int diagonal = 0;             ///< first column of its diagonal block in `value`
        bool has_translation = true;  ///< whether rows depend on r of a body
    };
    /// An off-diagonal block of S and its factor: the rows of group `of`, from column `at` of `value` on
    struct Block {
        int of = 0, at = 0;
    };
    /// Contribution of one body to a block of S: the product of the parts of W of two groups. `component`
    /// is that of r on which a row of the second group depends, if there is only one for each row.
    struct Term {
        int kernel, w_of, w_by, at;
        std::array<int, most_rows> component;
    };
    /// Elimination of a column: the product of two of its blocks is subtracted from block `to`
    struct Update {
        int by, of, at_by, to;  ///< of: first column of the first block, divided by the pivots, in `divided`
    };

    void shift_diagonal(double shift);  ///< S ← S + shift D
    void set_products();
    bool factor_columns(double least);
    void add_loads(Eigen::VectorXd& b);
    void take_right_side(const Eigen::VectorXd& b);
    void solve_multipliers();               ///< y ← S⁻¹ y
    void finish(Eigen::VectorXd& b) const;  ///< x = L⁻ᵀ (L⁻¹ f - Wᵀ y), λ = y; b holds L⁻¹ f on entry

    void find_groups(const Rows& pattern);
    void find_order(const Rows& pattern);
    int place(int h, int g) const;
    Term term_of(const Rows& pattern, int g, int s, int h, int t) const;
    void set_w(const Rows& C);

    std::vector<double> by_sqrt_m;  ///< 1/√m of each body
    std::vector<Mat3> L_inverse;    ///< L⁻¹ of J̄ = L Lᵀ
    std::vector<Group> group;
    std::vector<int> body_of;
    std::map<int, std::vector<std::pair<int, int>>> at_body;  ///< groups at a body, and its index in them
    std::vector<int> order, position;       ///< of elimination: the groups, and the place of each group in it
    std::vector<std::vector<int>> below;    ///< off-diagonal blocks in the columns of each group
    std::vector<Term> term;                 ///< of S, by kernel
    std::vector<int> term_start;            ///< first index into `term` of each kernel
    std::vector<int> column, update_start;  ///< first index into `block` and `update`, by position in `order`
    std::vector<Block> block;
    std::vector<Update> update;
    /// The column of `value` and the number in it of the diagonal entry of each regularised row
    std::vector<std::pair<int, int>> regularised_at;
    Columns W, value;
    Columns divided;   ///< the blocks of the present column, divided by the pivots
    Columns diagonal;  ///< of S, by group: the reference of the pivots
    Columns y;         ///< right side and multipliers by group
    double smallest = 1, products = 0;
    long fill = 0;
};

}  // namespace hilda::lie
