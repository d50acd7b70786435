// SPDX-License-Identifier: GPL-3.0-or-later
/// A sparse matrix of fixed pattern and its LU factors by KLU: analysed once, pivots chosen rarely, factored
/// often.

#pragma once

#include <memory>
#include <string>
#include <vector>

namespace hilda::lie {

class Klu {
public:
    /// Whether rows are scaled inside KLU. Whoever has scaled the matrix on both sides saves the time, and is told
    /// where it is singular to working precision, not only where it is singular.
    enum class Scaling { none, rows };

    explicit Klu(Scaling scaling);
    ~Klu();

    /// Compressed columns, rows ascending or not, none twice. Throws SingularMatrix where no values could
    /// make the pattern regular.
    void analyse(std::vector<int> column_start, std::vector<int> row_index);

    /// By the order in which the pattern was given
    std::vector<double> value;

    /// Factors the values with the pivots of the last full factorisation; where there is none, or the
    /// reciprocal condition says that its pivots no longer serve, does nothing more and returns false.
    bool refactor();
    /// Factors the values with pivots chosen anew. Throws SingularMatrix, and NonFinite for values that are
    /// not finite; `what` is the matrix, for the message.
    void factor(const char* what);

    /// Solves in place; size() numbers
    void solve(double* b) const;

    int size() const { return static_cast<int>(column_start.size()) - 1; }
    const std::vector<int>& columns() const { return column_start; }
    const std::vector<int>& rows() const { return row_index; }
    double reciprocal_condition() const { return rcond; }
    long factorizations() const { return full; }     ///< with new pivots
    long refactorizations() const { return again; }  ///< with the pivots of the last full one
    double operations() const;                       ///< estimate of one factorisation, multiplications

private:
    struct Library;

    std::vector<int> column_start, row_index;
    std::unique_ptr<Library> klu;
    double rcond = 1, rcond_of_full = 1;
    long full = 0, again = 0;
    bool have_pivots = false;
};

}  // namespace hilda::lie
