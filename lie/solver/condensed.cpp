// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/condensed.hpp"

#include <amd.h>

#include <algorithm>
#include <map>
#include <new>
#include <set>

namespace hilda::lie {

namespace {

// Smallest accepted ratio of a pivot to its diagonal entry. Below it, eleven digits are lost; KLU with
// pivoting is more accurate.
constexpr double smallest_accepted_pivot = 1e-11;

// Small dense operations on blocks stored by columns. `fixed` = 3 (the rows of a ball joint) makes the size
// known to the compiler; `fixed` = 0 uses the size given.

/// S += sign A Bᵀ; S m × n, A m × inner, B n × inner
template <int fixed>
void add_product(double* S, const double* A, const double* B, int rows, int columns, int inner, double sign)
{
    const int m = fixed != 0 ? fixed : rows, n = fixed != 0 ? fixed : columns;
    for (int c = 0; c < n; ++c)
        for (int d = 0; d < inner; ++d) {
            const double factor = sign * B[d * n + c];
            for (int r = 0; r < m; ++r) S[c * m + r] += A[d * m + r] * factor;
        }
}

void add_product(double* S, const double* A, const double* B, int m, int n, int inner, double sign)
{
    if (m == 3 && n == 3 && inner == 6)
        add_product<3>(S, A, B, 3, 3, 6, sign);
    else if (m == 3 && n == 3 && inner == 3)
        add_product<3>(S, A, B, 3, 3, 3, sign);
    else
        add_product<0>(S, A, B, m, n, inner, sign);
}

/// Cholesky factor L of D, in the lower triangle of D, with the reciprocals of the diagonal of L on the
/// diagonal. Returns the smallest ratio of a pivot to its entry of `original`; negative or NaN if D has no
/// factor.
template <int fixed>
double cholesky(double* D, int rows, const double* original)
{
    const int m = fixed != 0 ? fixed : rows;
    double smallest = 1;
    for (int k = 0; k < m; ++k) {
        const double pivot = D[k * m + k], part = pivot / original[k];
        if (!(part >= smallest)) smallest = part;
        const double reciprocal = 1 / std::sqrt(pivot);
        D[k * m + k] = reciprocal;
        for (int r = k + 1; r < m; ++r) D[k * m + r] *= reciprocal;
        for (int c = k + 1; c < m; ++c)
            for (int r = c; r < m; ++r) D[c * m + r] -= D[k * m + r] * D[k * m + c];
    }
    return smallest;
}

/// B ← B L⁻ᵀ; B n × m, L with reciprocal diagonal
template <int fixed>
void divide(double* B, const double* L, int columns, int n)
{
    const int m = fixed != 0 ? fixed : columns;
    for (int k = 0; k < m; ++k) {
        for (int r = 0; r < n; ++r) B[k * n + r] *= L[k * m + k];
        for (int c = k + 1; c < m; ++c)
            for (int r = 0; r < n; ++r) B[c * n + r] -= B[k * n + r] * L[k * m + c];
    }
}

/// y += sign A x; A m × n
template <int fixed>
void add_times(double* y, const double* A, const double* x, int rows, int n, double sign)
{
    const int m = fixed != 0 ? fixed : rows;
    for (int c = 0; c < n; ++c) {
        const double factor = sign * x[c];
        for (int r = 0; r < m; ++r) y[r] += A[c * m + r] * factor;
    }
}

void add_times(double* y, const double* A, const double* x, int m, int n, double sign)
{
    if (m == 3)
        add_times<3>(y, A, x, 3, n, sign);
    else
        add_times<0>(y, A, x, m, n, sign);
}

/// y -= Aᵀ x; A m × n
template <int fixed>
void subtract_transposed_times(double* y, const double* A, const double* x, int rows, int n)
{
    const int m = fixed != 0 ? fixed : rows;
    for (int c = 0; c < n; ++c) {
        double sum = 0;
        for (int r = 0; r < m; ++r) sum += A[c * m + r] * x[r];
        y[c] -= sum;
    }
}

void subtract_transposed_times(double* y, const double* A, const double* x, int m, int n)
{
    if (m == 3)
        subtract_transposed_times<3>(y, A, x, 3, n);
    else
        subtract_transposed_times<0>(y, A, x, m, n);
}

/// Order of elimination with little fill-in, by AMD of SuiteSparse
std::vector<int> minimum_degree_order(const std::vector<std::set<int>>& neighbours)
{
    std::vector<int> start{0}, index, order(neighbours.size());
    index.reserve(1), order.reserve(1);  // AMD rejects null pointers
    for (const std::set<int>& of_group : neighbours) {
        index.insert(index.end(), of_group.begin(), of_group.end());
        start.push_back(static_cast<int>(index.size()));
    }
    if (amd_order(static_cast<int>(order.size()), start.data(), index.data(), order.data(), nullptr,
                  nullptr) < AMD_OK)
        throw std::bad_alloc();  // the only error for a pattern that is valid
    return order;
}

}  // namespace

Condensed::Condensed(const Mass& mass, const Rows& pattern) : diagonal(pattern.rows()), y(pattern.rows())
{
    for (const double m : mass.m) by_sqrt_m.push_back(1 / std::sqrt(m));
    for (const Mat3& J_bar : mass.J_bar) L_inverse.push_back(Mat3(J_bar.llt().matrixL()).inverse());
    find_groups(pattern);
    analyse(pattern);
}

void Condensed::find_groups(const Rows& pattern)
{
    const auto bodies = [&](int k) {
        std::vector<int> all;
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n) all.push_back(pattern.entry[n].body);
        return all;
    };
    int w = 0;
    for (int k = 0; k < pattern.rows(); ++k) {
        const std::vector<int> mine = bodies(k);
        if (group.empty() || bodies(group.back().first) != mine) {
            group.push_back({.first = k,
                             .rows = 0,
                             .bodies = static_cast<int>(mine.size()),
                             .body = static_cast<int>(body_of.size())});
            body_of.insert(body_of.end(), mine.begin(), mine.end());
        }
        ++group.back().rows;
    }
    for (Group& g : group) {
        g.w = w;
        w += 6 * g.rows * g.bodies;
    }
    W.resize(w);
}

void Condensed::analyse(const Rows& pattern)
{
    // groups are neighbours if they share a body
    const int n = static_cast<int>(group.size());
    std::map<int, std::vector<std::pair<int, int>>> at_body;  // (group, index of the body in the group)
    for (int g = 0; g < n; ++g)
        for (int s = 0; s < group[g].bodies; ++s)
            at_body[pattern.entry[pattern.start[group[g].first] + s].body].emplace_back(g, s);
    std::vector<std::set<int>> neighbours(n);
    long couplings = 0;
    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all)
                if (g != h) couplings += neighbours[g].insert(h).second;

    order = minimum_degree_order(neighbours);
    std::vector<int> position(n);
    for (int p = 0; p < n; ++p) position[order[p]] = p;

    // The blocks of a column: the neighbours of the group that are eliminated after it, and those of its
    // children in the elimination tree. The parent of a group is the first of them.
    std::vector<std::vector<int>> below(n);  // by group, in the order of elimination
    const auto earlier = [&](int a, int b) { return position[a] < position[b]; };
    for (const int g : order) {
        for (const int h : neighbours[g])
            if (earlier(g, h)) below[g].push_back(h);
        std::sort(below[g].begin(), below[g].end(), earlier);
        if (!below[g].empty()) neighbours[below[g].front()].insert(below[g].begin(), below[g].end());
    }

    // storage of the blocks, column by column
    int size = 0;
    std::map<std::pair<int, int>, int> place;  // (row group, column group)
    for (const int g : order) {
        group[g].diagonal = size;
        place[{g, g}] = size;
        size += group[g].rows * group[g].rows;
        column.push_back(static_cast<int>(block.size()));
        for (const int h : below[g]) {
            place[{h, g}] = size;
            block.push_back({.of = h, .at = size});
            size += group[h].rows * group[g].rows;
        }
    }
    column.push_back(static_cast<int>(block.size()));
    value.resize(size);
    for (const int k : pattern.regularised)
        for (const Group& g : group)
            if (k >= g.first && k < g.first + g.rows)
                regularised_at.push_back(g.diagonal + (k - g.first) * (g.rows + 1));
    fill = static_cast<long>(block.size()) - couplings / 2;

    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all) {
                if (position[g] < position[h]) continue;
                const Group &a = group[g], &b = group[h];
                term.push_back({.of = a.rows,
                                .by = b.rows,
                                .w_of = a.w + 6 * a.rows * s,
                                .w_by = b.w + 6 * b.rows * t,
                                .at = place[{g, h}]});
                flops += 6.0 * a.rows * b.rows;
            }
    for (const int g : order) {
        update_start.push_back(static_cast<int>(update.size()));
        const double m = group[g].rows;
        flops += m * m * m / 6;
        for (size_t i = 0; i < below[g].size(); ++i) {
            const int h = below[g][i];
            flops += 0.5 * m * m * group[h].rows;
            for (size_t j = 0; j <= i; ++j) {
                const int k = below[g][j];
                update.push_back({.of = group[h].rows,
                                  .by = group[k].rows,
                                  .at_of = place[{h, g}],
                                  .at_by = place[{k, g}],
                                  .to = place[{h, k}]});
                flops += m * group[h].rows * group[k].rows;
            }
        }
    }
    update_start.push_back(static_cast<int>(update.size()));
}

bool Condensed::factor(const Rows& C, double shift)
{
    for (const Group& g : group)
        for (int row = 0; row < g.rows; ++row) {
            const Rows::Entry* entry = &C.entry[C.start[g.first + row]];
            double* w = &W[g.w + row];
            for (int s = 0; s < g.bodies; ++s, ++entry, w += 6 * g.rows) {
                const Vec3 r = by_sqrt_m[entry->body] * entry->r, pi = L_inverse[entry->body] * entry->pi;
                for (int c = 0; c < 3; ++c) w[c * g.rows] = r[c], w[(c + 3) * g.rows] = pi[c];
            }
        }
    std::fill(value.begin(), value.end(), 0.0);
    for (const Term& t : term) add_product(&value[t.at], &W[t.w_of], &W[t.w_by], t.of, t.by, 6, 1);
    for (const Group& g : group)
        for (int k = 0; k < g.rows; ++k) diagonal[g.first + k] = value[g.diagonal + k * g.rows + k];
    if (shift > 0) shift_diagonal(shift);
    for (size_t n = 0; n < regularised_at.size(); ++n)
        diagonal[C.regularised[n]] = value[regularised_at[n]] += C.compliance[n];

    smallest = 1;
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        double* L = &value[g.diagonal];
        const double part =
            g.rows == 3 ? cholesky<3>(L, 3, &diagonal[g.first]) : cholesky<0>(L, g.rows, &diagonal[g.first]);
        if (!(part > (shift > 0 ? 0 : smallest_accepted_pivot))) return false;
        smallest = std::min(smallest, part);
        for (int n = column[p]; n < column[p + 1]; ++n)
            if (g.rows == 3)
                divide<3>(&value[block[n].at], L, 3, group[block[n].of].rows);
            else
                divide<0>(&value[block[n].at], L, g.rows, group[block[n].of].rows);
        for (int n = update_start[p]; n < update_start[p + 1]; ++n) {
            const Update& u = update[n];
            add_product(&value[u.to], &value[u.at_of], &value[u.at_by], u.of, u.by, g.rows, -1);
        }
    }
    return true;
}

void Condensed::shift_diagonal(double shift)
{
    for (const Group& g : group)
        for (int k = 0; k < g.rows; ++k) {
            double& entry = value[g.diagonal + k * g.rows + k];
            entry = entry > 0 ? (1 + shift) * entry : 1;
            diagonal[g.first + k] = entry;
        }
}

void Condensed::solve(Eigen::VectorXd& b)
{
    // f ← L⁻¹ f,   y = W f - g
    for (size_t i = 0; i < by_sqrt_m.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        b.segment<3>(at) *= by_sqrt_m[i];
        b.segment<3>(at + 3) = (L_inverse[i] * b.segment<3>(at + 3)).eval();
    }
    y = -b.tail(y.size());
    for (const Group& g : group)
        for (int s = 0; s < g.bodies; ++s)
            add_times(&y[g.first], &W[g.w + 6 * g.rows * s], &b[6 * body_of[g.body + s]], g.rows, 6, 1);
    solve_multipliers();
    finish(b);
}

void Condensed::solve_constraints(Eigen::VectorXd& b)
{
    y = -b.tail(y.size());
    solve_multipliers();
    b.setZero();
    finish(b);
}

void Condensed::solve_multipliers()
{
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        double *own = &y[g.first], *L = &value[g.diagonal];
        for (int k = 0; k < g.rows; ++k) {
            own[k] *= L[k * g.rows + k];
            for (int r = k + 1; r < g.rows; ++r) own[r] -= L[k * g.rows + r] * own[k];
        }
        for (int n = column[p]; n < column[p + 1]; ++n) {
            const Group& h = group[block[n].of];
            add_times(&y[h.first], &value[block[n].at], own, h.rows, g.rows, -1);
        }
    }
    for (size_t p = order.size(); p-- > 0;) {
        const Group& g = group[order[p]];
        double *own = &y[g.first], *L = &value[g.diagonal];
        for (int n = column[p]; n < column[p + 1]; ++n) {
            const Group& h = group[block[n].of];
            subtract_transposed_times(own, &value[block[n].at], &y[h.first], h.rows, g.rows);
        }
        for (int k = g.rows - 1; k >= 0; --k) {
            for (int r = k + 1; r < g.rows; ++r) own[k] -= L[k * g.rows + r] * own[r];
            own[k] *= L[k * g.rows + k];
        }
    }
}

void Condensed::finish(Eigen::VectorXd& b) const
{
    for (const Group& g : group)
        for (int s = 0; s < g.bodies; ++s)
            subtract_transposed_times(&b[6 * body_of[g.body + s]], &W[g.w + 6 * g.rows * s], &y[g.first],
                                      g.rows, 6);
    for (size_t i = 0; i < by_sqrt_m.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        b.segment<3>(at) *= by_sqrt_m[i];
        b.segment<3>(at + 3) = (L_inverse[i].transpose() * b.segment<3>(at + 3)).eval();
    }
    b.tail(y.size()) = y;
}

}  // namespace hilda::lie
