// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle system condensed to its multipliers.
///
///     | M  Cᵀ | | x |   | f |        S λ = C M⁻¹ f - g,   x = M⁻¹ (f - Cᵀ λ),        S = C M⁻¹ Cᵀ,  C = (Φ_r, Π̄)
///     | C  0  | | λ | = | g |
///
/// M is block diagonal and never changes, so it is factored once and for all, M = L Lᵀ, and S = W Wᵀ with W = C
/// L⁻ᵀ. Rows between the same bodies form a group; S is a matrix of blocks, one for each pair of groups that
/// share a body, and its Cholesky factors are found by blocks in an order of minimum degree that is fixed with
/// the pattern. For a chain or a tree of joints nothing fills in: a chain is block tridiagonal. The softness of rows that give way stands on
/// the diagonal of S besides.

#pragma once

#include "lie/system.hpp"

namespace hilda::lie {

class Condensed {
public:
    /// Analyses the pattern. `mass` with unit metric gives the least-squares problem in the rows alone.
    Condensed(const Mass& mass, const Rows& pattern);

    /// Factors S of these rows. False when a pivot has lost so many digits that the factors would not be worth
    /// having: rows that are nearly dependent, or not finite.
    bool factor(const Rows& C);

    /// In place: b holds f and g, then x and λ
    void solve(Eigen::VectorXd& b);
    /// The same for f = 0, whatever b holds there
    void solve_constraints(Eigen::VectorXd& b);

    /// Smallest part of a diagonal entry of S that elimination left
    double smallest_pivot() const { return smallest; }
    /// Multiplications of one factorisation, with the assembly of S
    double operations() const { return flops; }
    /// Entries of the factor outside its diagonal blocks, beyond those of S
    long fill_in() const { return fill; }

private:
    /// Rows first … first + rows - 1, all with entries for the same bodies in the same order
    struct Group {
        int first = 0, rows = 0, bodies = 0;
        int body = 0;      ///< where its bodies begin in `body_of`
        int w = 0;         ///< where its part of W begins: for each body 6 columns of `rows` numbers
        int diagonal = 0;  ///< where its diagonal block stands in `value`
    };
    /// A block of S or of its factor, below the diagonal: rows of group `of`
    struct Block {
        int of = 0, at = 0;
    };
    /// A product of the parts of W that two groups have for one body, added to a block of S
    struct Term {
        int of, by, w_of, w_by, at;
    };
    /// Block `to` loses the product of two blocks of the same column
    struct Update {
        int of, by, at_of, at_by, to;
    };

    void solve_multipliers();               ///< S y = y
    void finish(Eigen::VectorXd& b) const;  ///< x = L⁻ᵀ (f - Wᵀ y), λ = y, with f where x will be

    void find_groups(const Rows& pattern);
    void analyse(const Rows& pattern);

    std::vector<double> by_sqrt_m;  ///< 1/√m of each body
    std::vector<Mat3> L_inverse;    ///< L⁻¹ of J̄ = L Lᵀ
    std::vector<Group> group;
    std::vector<int> body_of;
    std::vector<int> order;                 ///< groups as they are eliminated
    std::vector<Term> term;                 ///< of S
    std::vector<int> column, update_start;  ///< by position in `order`, into `block` and `update`
    std::vector<Block> block;
    std::vector<Update> update;
    struct Soft {
        int row, at;  ///< a row that gives way, its diagonal entry in `value`
    };
    std::vector<Soft> regularised;
    std::vector<double> W, value, diagonal;  ///< diagonal: of S, to judge pivots
    Eigen::VectorXd y;
    double smallest = 1, flops = 0;
    long fill = 0;
};

}  // namespace hilda::lie
