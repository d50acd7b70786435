// SPDX-License-Identifier: GPL-3.0-or-later
/// A sparse matrix of fixed pattern and its LU factors by KLU. The pattern is analysed once. A factorisation
/// reuses the pivots of an earlier one as long as they are accurate.

#pragma once

#include <memory>
#include <string>
#include <vector>

namespace hilda::lie {

class Klu {
public:
    /// Whether KLU scales the rows. `none` is for a matrix that has been scaled on both sides. Its reciprocal
    /// condition is meaningful: factor() also rejects matrices that are singular to working precision.
    enum class Scaling { none, rows };

    explicit Klu(Scaling scaling);
    ~Klu();

    /// Sets the pattern in compressed columns. The rows of a column are distinct, in any order. Throws
    /// SingularMatrix if the matrix is singular for all values.
    void analyse(std::vector<int> column_start, std::vector<int> row_index);

    /// The values, in the order of row_index
    std::vector<double> value;

    /// Factors the values with the pivots of the last full factorisation. Returns false if there is none, or
    /// if the reciprocal condition is below 1e-3 of that of the full factorisation. Call factor() then.
    bool refactor();
    /// Factors the values with new pivots. Throws SingularMatrix, and NonFinite for values that are not
    /// finite. `what` is the name of the matrix for the message.
    void factor(const char* what);

    /// Solves in place; b has size() components.
    void solve(double* b) const;

    int size() const { return static_cast<int>(column_start.size()) - 1; }
    const std::vector<int>& columns() const { return column_start; }
    const std::vector<int>& rows() const { return row_index; }
    double reciprocal_condition() const { return rcond; }
    /// Number of factorisations with new pivots
    long factorizations() const { return full_count; }
    /// Number of factorisations with the pivots of an earlier one
    long refactorizations() const { return refactor_count; }
    /// Estimated number of multiplications of one factorisation
    double operations() const;
    /// Number of entries of the present factors; 0 without factors
    long entries_of_factors() const;

private:
    struct Library;

    std::vector<int> column_start, row_index;
    std::unique_ptr<Library> klu;
    double rcond = 1, rcond_of_pivots = 1;  ///< of the last factorisation, of the last full one
    long full_count = 0, refactor_count = 0;
    bool have_pivots = false;
};

}  // namespace hilda::lie
