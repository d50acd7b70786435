// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/condensed.hpp"
#include "lie/solver/condensed_kernels.hpp"

#include <algorithm>

namespace hilda::lie {

using namespace kernels;

namespace {

// Smallest accepted ratio of a pivot to its diagonal entry. The multipliers lose as many digits, and the
// motion half of them, which a refinement or an iteration gains back. The pivots of a chain of N hinges, a
// beam across its plane, decrease as N⁻³. Bounded rows are solved without an iteration.
constexpr double smallest_accepted_pivot = 1e-12, smallest_with_bounds = 1e-8;

}  // namespace

/// W = C L⁻ᵀ
HILDA_CLONES("avx2", "default") void Condensed::set_w(const Rows& C)
{
    for (const Group& g : group)
        with_rows(g.rows, [&]<int rows>() HILDA_INLINE {
            const Rows::Entry* entry = C.entry.data() + C.start[g.first];
            Column* w = W.data() + g.w;
            for (int s = 0; s < g.bodies; ++s, ++entry, w += 6) {
                const double by_sqrt = by_sqrt_m[entry->body];
                const Mat3& L = L_inverse[entry->body];
                Column pi_x, pi_y, pi_z;
                set_column<rows>(pi_x, [&](int k) HILDA_INLINE { return entry[k * g.bodies].pi[0]; });
                set_column<rows>(pi_y, [&](int k) HILDA_INLINE { return entry[k * g.bodies].pi[1]; });
                set_column<rows>(pi_z, [&](int k) HILDA_INLINE { return entry[k * g.bodies].pi[2]; });
                for (int c = 0; c < 3; ++c) {
                    set_column<rows>(w[c], [&](int k) HILDA_INLINE { return entry[k * g.bodies].r[c]; });
                    w[c] *= by_sqrt;
                    w[3 + c] = pi_x * L(c, 0) + (pi_y * L(c, 1) + pi_z * L(c, 2));
                }
            }
        });
}

/// S = W Wᵀ
HILDA_CLONES("avx2", "default") void Condensed::set_products()
{
    std::fill(value.begin(), value.end(), Column{});
    const auto add = [&]<int kernel>() HILDA_INLINE {
        for (int n = term_start[kernel]; n < term_start[kernel + 1]; ++n) {
            const Term& t = term[n];
            add_term<kernel / translations + 1, Translation(kernel % translations)>(
                &value[t.at], &W[t.w_of], &W[t.w_by], t.component.data());
        }
    };
    [&]<int... kernel>(std::integer_sequence<int, kernel...>) HILDA_INLINE
    {
        (add.template operator()<kernel>(), ...);
    }
    (std::make_integer_sequence<int, most_rows * translations>());
}

/// S ← L and E, in the order of elimination. Returns false if a pivot is not larger than `least` times its
/// diagonal entry.
HILDA_CLONES("avx2", "default") bool Condensed::factor_columns(double least)
{
    SmallestPivot so_far;
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        const bool accepted = with_rows(g.rows, [&]<int rows>() HILDA_INLINE {
            Column *L = &value[g.diagonal], *next = divided.data();
            if (!factor_block<rows>(L, diagonal[order[p]], least, so_far)) return false;
            for (int n = column[p]; n < column[p + 1]; ++n, next += rows)
                divide<rows>(&value[block[n].at], next, L);
            for (int n = update_start[p]; n < update_start[p + 1]; ++n) {
                const Update& u = update[n];
                with_rows(u.by, [&]<int by>() HILDA_INLINE {
                    subtract_product<rows, by>(&value[u.to], &divided[u.of], &value[u.at_by]);
                });
            }
            return true;
        });
        if (!accepted) return false;
    }
    smallest = so_far.pivot / so_far.entry;
    return true;
}

bool Condensed::factor(const Rows& C, double shift)
{
    set_w(C);
    set_products();
    for (size_t g = 0; g < group.size(); ++g)
        for (int k = 0; k < group[g].rows; ++k) diagonal[g][k] = value[group[g].diagonal + k][k];
    if (shift > 0) shift_diagonal(shift);
    for (size_t n = 0; n < regularised_at.size(); ++n) {
        const auto [g, k] = regularised_at[n];
        value[group[g].diagonal + k][k] += C.compliance[n];
        diagonal[g][k] = value[group[g].diagonal + k][k];
    }
    return factor_columns(shift > 0               ? 0
                          : C.regularised.empty() ? smallest_accepted_pivot
                                                  : smallest_with_bounds);
}

void Condensed::shift_diagonal(double shift)
{
    for (size_t g = 0; g < group.size(); ++g)
        for (int k = 0; k < group[g].rows; ++k) {
            Column& D = value[group[g].diagonal + k];
            D[k] = D[k] > 0 ? (1 + shift) * D[k] : 1;
            diagonal[g][k] = D[k];
        }
}

void Condensed::solve(Eigen::VectorXd& b)
{
    take_right_side(b);
    add_loads(b);
    solve_multipliers();
    finish(b);
}

/// f ← L⁻¹ f,   y ← y + W f
HILDA_CLONES("avx2", "default") void Condensed::add_loads(Eigen::VectorXd& b)
{
    for (size_t i = 0; i < by_sqrt_m.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        b.segment<3>(at) *= by_sqrt_m[i];
        b.segment<3>(at + 3) = (L_inverse[i] * b.segment<3>(at + 3)).eval();
    }
    for (size_t k = 0; k < group.size(); ++k) {
        const Group& g = group[k];
        Column sum = y[k];
        for (int s = 0; s < g.bodies; ++s) {
            const Column* w = &W[g.w + 6 * s];
            const double* f = &b[6 * body_of[g.body + s]];
            if (g.has_translation)
                for (int c = 0; c < 3; ++c) sum += w[c] * f[c];
            for (int c = 3; c < 6; ++c) sum += w[c] * f[c];
        }
        y[k] = sum;
    }
}

void Condensed::solve_constraints(Eigen::VectorXd& b)
{
    take_right_side(b);
    solve_multipliers();
    b.setZero();
    finish(b);
}

/// y = -g
HILDA_CLONES("avx2", "default") void Condensed::take_right_side(const Eigen::VectorXd& b)
{
    const double* g = b.data() + 6 * by_sqrt_m.size();
    for (size_t k = 0; k < group.size(); ++k)
        with_rows(group[k].rows, [&]<int rows>() HILDA_INLINE {
            set_column<rows>(y[k], [g](int row) HILDA_INLINE { return -g[row]; });
            g += rows;
        });
}

HILDA_CLONES("avx2", "default") void Condensed::solve_multipliers()
{
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        with_rows(g.rows, [&]<int rows>() HILDA_INLINE {
            double by_pivot[rows];
            solve_lower<rows>(y[order[p]], by_pivot, &value[g.diagonal]);
            for (int n = column[p]; n < column[p + 1]; ++n) {
                const Column* B = &value[block[n].at];
                Column of = y[block[n].of];
                for (int c = 0; c < rows; ++c) of -= B[c] * by_pivot[c];
                y[block[n].of] = of;
            }
        });
    }
    for (size_t p = order.size(); p-- > 0;) {
        const Group& g = group[order[p]];
        with_rows(g.rows, [&]<int rows>() HILDA_INLINE {
            double own[rows];
            for (int c = 0; c < rows; ++c) own[c] = y[order[p]][c];
            for (int n = column[p]; n < column[p + 1]; ++n) {
                const Column* B = &value[block[n].at];
                const Column of = y[block[n].of];
                for (int c = 0; c < rows; ++c) own[c] -= dot(B[c], of);
            }
            solve_upper<rows>(own, &value[g.diagonal]);
            set_column<rows>(y[order[p]], [&](int c) HILDA_INLINE { return own[c]; });
        });
    }
}

HILDA_CLONES("avx2", "default") void Condensed::finish(Eigen::VectorXd& b) const
{
    for (size_t k = 0; k < group.size(); ++k) {
        const Group& g = group[k];
        const Column own = y[k];
        for (int s = 0; s < g.bodies; ++s) {
            const Column* w = &W[g.w + 6 * s];
            double* x = &b[6 * body_of[g.body + s]];
            if (g.has_translation)
                for (int c = 0; c < 3; ++c) x[c] -= dot(w[c], own);
            for (int c = 3; c < 6; ++c) x[c] -= dot(w[c], own);
        }
    }
    for (size_t i = 0; i < by_sqrt_m.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        b.segment<3>(at) *= by_sqrt_m[i];
        b.segment<3>(at + 3) = (L_inverse[i].transpose() * b.segment<3>(at + 3)).eval();
    }
    double* lambda = b.data() + 6 * by_sqrt_m.size();
    for (size_t k = 0; k < group.size(); ++k)
        for (int row = 0; row < group[k].rows; ++row) *lambda++ = y[k][row];
}

}  // namespace hilda::lie
