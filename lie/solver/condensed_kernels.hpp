// SPDX-License-Identifier: GPL-3.0-or-later
/// The operations of the condensed solver on columns of four numbers.
///
/// A block is a pointer to its columns. The sizes are parameters of the templates, so that the compiler
/// unrolls the loops. All functions are inlined into those that HILDA_CLONES marks, and are then compiled for
/// each instruction set.

#pragma once

#include "io/arithmetic/clones.hpp"
#include "lie/solver/columns.hpp"

#define HILDA_INLINE __attribute__((always_inline))

namespace hilda::lie::kernels {

/// column = (number(0), number(1), …) of this many rows, then zeros. It is composed in a register: a column
/// that is stored by its numbers and read at once delays the processor.
template <int rows, class Number>
HILDA_INLINE inline void set_column(Column& column, const Number& number)
{
    column = Column{number(0), rows > 1 ? number(1) : 0, rows > 2 ? number(2) : 0, rows > 3 ? number(3) : 0};
}

/// How the rows of a group depend on r of a body
enum Translation { none, one_component, all_components, translations };

/// S += A Bᵀ with the parts of W for one body: six columns each, B of n rows
template <int n, Translation translation>
HILDA_INLINE inline void add_term(Column* S, const Column* A, const Column* B, const int* component)
{
#pragma GCC unroll 4
    for (int c = 0; c < n; ++c) {
        Column sum = S[c];
        if constexpr (translation == one_component) sum += A[component[c]] * B[component[c]][c];
        if constexpr (translation == all_components)
            sum += A[0] * B[0][c], sum += A[1] * B[1][c], sum += A[2] * B[2][c];
        sum += A[3] * B[3][c];
        sum += A[4] * B[4][c];
        sum += A[5] * B[5][c];
        S[c] = sum;
    }
}

/// S -= A Bᵀ; A and B of m columns, B of n rows
template <int m, int n>
HILDA_INLINE inline void subtract_product(Column* S, const Column* A, const Column* B)
{
#pragma GCC unroll 4
    for (int c = 0; c < n; ++c) {
        Column sum = S[c];
#pragma GCC unroll 4
        for (int d = 0; d < m; ++d) sum -= A[d] * B[d][c];
        S[c] = sum;
    }
}

/// The smallest ratio of a pivot to its diagonal entry
struct SmallestPivot {
    double pivot = 1, entry = 1;

    HILDA_INLINE void take(double other, double its_entry)
    {
        if (other * entry < pivot * its_entry) pivot = other, entry = its_entry;
    }
};

/// Factors the m columns of the block D as L E Lᵀ, L with a unit diagonal, E diagonal. They then hold L with
/// 1/E on the diagonal and zeros above. Returns false if a pivot is not larger than `least` times its entry
/// of `original`.
template <int m>
HILDA_INLINE inline bool factor_block(Column* D, const Column& original, double least,
                                      SmallestPivot& smallest)
{
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
        const double pivot = D[k][k];
        if (!(pivot > least * original[k])) return false;
        smallest.take(pivot, original[k]);
        const double reciprocal = 1 / pivot;
        Column L = D[k] * reciprocal;
#pragma GCC unroll 4
        for (int c = k + 1; c < m; ++c) D[c] -= L * D[k][c];
        L[k] = reciprocal;
#pragma GCC unroll 4
        for (int r = 0; r < k; ++r) L[r] = 0;
        D[k] = L;
    }
    return true;
}

/// B ← B L⁻ᵀ and `divided` = B E⁻¹; of m columns
template <int m>
HILDA_INLINE inline void divide(Column* B, Column* divided, const Column* L)
{
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
        const Column column = B[k];
#pragma GCC unroll 4
        for (int c = k + 1; c < m; ++c) B[c] -= column * L[k][c];
        divided[k] = column * L[k][k];
    }
}

/// The sum of the four products, in the order of the rows
HILDA_INLINE inline double dot(const Column& a, const Column& b)
{
    const Column p = a * b;
    return p[0] + p[1] + p[2] + p[3];
}

/// y ← L⁻¹ y for the m columns of L, and `divided` = E⁻¹ y
template <int m>
HILDA_INLINE inline void solve_lower(Column& y, double* divided, const Column* L)
{
    Column rest = y;
    double solution[m];
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
        solution[k] = rest[k];
        divided[k] = solution[k] * L[k][k];
        rest -= L[k] * solution[k];
    }
    set_column<m>(y, [&](int k) HILDA_INLINE { return solution[k]; });
}

/// y ← L⁻ᵀ E⁻¹ y
template <int m>
HILDA_INLINE inline void solve_upper(double* y, const Column* L)
{
#pragma GCC unroll 4
    for (int k = m - 1; k >= 0; --k) {
        y[k] *= L[k][k];
#pragma GCC unroll 4
        for (int r = k + 1; r < m; ++r) y[k] -= L[k][r] * y[r];
    }
}

/// Calls function.operator()<rows>() for 1 to 4 rows.
template <class Function>
HILDA_INLINE inline auto with_rows(int rows, const Function& function)
{
    switch (rows) {
        case 1:
            return function.template operator()<1>();
        case 2:
            return function.template operator()<2>();
        case 3:
            return function.template operator()<3>();
        default:
            return function.template operator()<4>();
    }
}

}  // namespace hilda::lie::kernels
