// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle matrix as one sparse matrix, factored by KLU.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/solver/klu.hpp"
#include "lie/solver/saddle_factors.hpp"

#include <vector>

namespace hilda::lie {

/// KLU factors S K S. The scaling S gives diagonal blocks and rows of length one:
///
///     S = diag(M, J̄)^(-1/2) for the bodies,    1/|(Φ_r, Π̄) S| for a row
///
/// The condition number of the scaled matrix then depends on the mechanism only and not on its units, and
/// its estimate can be compared with a limit. The rows of an algebraic group, whose Φ_α is of length one,
/// share one scale, and the variables of the group have its reciprocal.
///
/// An inactive row has the diagonal entry -1: its multiplier is not changed.
class KluSaddle final : public SaddleFactors {
public:
    /// `mass` must outlive the object.
    explicit KluSaddle(const Mass& mass);

    /// Analyses the sparsity pattern. Throws SingularMatrix if K is singular for all values.
    void analyse(const Rows& pattern);
    /// Computes new scales with the next factorisation, for rows that have become active or inactive.
    void rescale() { scaled = false; }

    /// Factors K with these rows, which have the analysed pattern, and with the pivots and scales of an
    /// earlier factorisation. Returns false if there are no pivots or they have become inaccurate
    /// (Klu::refactor).
    bool refactor(const Rows& rows);
    /// Factors K with new scales and pivots. Throws SingularMatrix, and NonFinite if the rows are not finite.
    void factor(const Rows& rows);

    void solve(Eigen::VectorXd& b) override;
    void solve_constraints(Eigen::VectorXd& b) override;
    double reciprocal_condition() const override { return klu.reciprocal_condition(); }

    long factorizations() const { return klu.factorizations(); }  ///< with new pivots
    long refactorizations() const { return klu.refactorizations(); }
    /// Estimated number of multiplications of one factorisation
    double operations() const { return klu.operations(); }
    long entries_of_factors() const { return klu.entries_of_factors(); }

private:
    void set_scales(const Rows& rows);
    void set_values(const Rows& rows);

    const Mass& mass;
    const int bodies;
    Klu klu{Klu::Scaling::none};
    Eigen::VectorXd scale;
    bool scaled = false;
    /// Positions of a derivative in the matrix
    struct Slot {
        int upper, lower;  ///< in Φ_rᵀ or Π̄ᵀ, and in Φ_r or Π̄
        double factor;     ///< product of the scales of its row and its column
    };
    std::vector<Slot> slot;
    std::vector<int> mass_slot;
    std::vector<int> unilateral_slot;   ///< diagonal entries of the unilateral rows
    std::vector<int> regularised_slot;  ///< diagonal entries of the regularised rows
};

}  // namespace hilda::lie
