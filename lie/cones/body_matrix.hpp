// SPDX-License-Identifier: GPL-3.0-or-later
/// The matrix of the cone problem with a quadratic term at the contact points:
///
///     | M + Σ_c C_cᵀ W_c C_c   C_bᵀ |       W_c: 3 × 3
///     | C_b                    -ε I |       ε = 10⁻¹² · (mean of 1/m)
///
/// With symmetric, positive semidefinite W_c it is quasi-definite: every order of elimination has diagonal
/// pivots that are not zero (Vanderbei 1995). The other W_c, those of Newton's method for Coulomb's law,
/// differ from such ones by terms of rank one. ε keeps the pivots of dependent joint rows away from
/// zero. solve() removes its effect by one step of iterative refinement.
///
/// The order is a minimum degree order of the bodies, by AMD. The rows of a joint follow the last of their
/// bodies: their pivots are then those of -C_b (M + …)⁻¹ C_bᵀ and not ε.

#pragma once

#include "lie/cones/cone_problem.hpp"
#include "lie/solver/multifrontal_lu.hpp"

#include <array>
#include <memory>
#include <vector>

namespace hilda::lie {

class BodyMatrix {
public:
    BodyMatrix(const Mass& mass, const Rows& pattern);

    /// Takes the contact points of the problem. The pattern is analysed if their set of pairs of bodies is
    /// not one of the last few sets. The analysis depends on the set only, so that a continued run has the
    /// same digits.
    void set_contacts(const ConeProblem& problem);
    /// Factors the matrix with the blocks W, one for each contact point of set_contacts(), and the joint rows
    /// of the problem. The problem and W must remain unchanged until the last solve().
    void factor(const ConeProblem& problem, const std::vector<Mat3>& W);
    /// The same without contact points
    void factor_joints(const ConeProblem& problem);
    /// y = solution for the right side b, with one step of iterative refinement if there are joints
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& y);

    long factorizations() const { return count; }

private:
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    using Pair = std::array<int, 2>;  ///< two bodies, ascending

    struct PairBlocks {
        Mat6 upper, lower;  ///< rows of the first body of the pair, rows of the second one
    };
    struct Analysis {
        std::vector<Pair> pairs;
        std::vector<int> diagonal, upper, lower;  ///< handles of the blocks of bodies and of pairs
        std::vector<int> row, column;             ///< of the entries of the joint rows, and their transposes
        std::vector<int> regularisation;          ///< of the diagonal entries of the joint rows
        MultifrontalLu<double> N;
    };
    void choose_analysis();
    std::unique_ptr<Analysis> analysed() const;
    void factor();
    std::vector<int> order(const Analysis& of) const;
    /// b - K y, without ε
    void set_residual(const Eigen::VectorXd& b, const Eigen::VectorXd& y);

    static constexpr size_t most_analyses = 4;

    const Mass& mass;
    const Rows& pattern;
    const int bodies;
    double epsilon = 0;
    std::vector<std::unique_ptr<Analysis>> analyses;  ///< the present one first
    std::vector<Pair> pairs;
    std::vector<int> pair_of;  ///< of each contact point; -1 for a contact with the ground
    std::vector<Mat6> of_body;
    std::vector<PairBlocks> of_pair;
    const ConeProblem* problem = nullptr;
    const std::vector<Mat3>* weights = nullptr;  ///< null without contact points
    Eigen::VectorXd residual;
    long count = 0;
};

}  // namespace hilda::lie
