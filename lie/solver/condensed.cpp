// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/condensed.hpp"

#include <amd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <new>
#include <set>

namespace hilda::lie {

namespace {

// Smallest accepted ratio of a pivot to its diagonal entry. The multipliers lose as many digits, and the
// motion half of them, which a refinement or an iteration gains back. The pivots of a chain of N hinges, a
// beam across its plane, decrease as N⁻³. Bounded rows are solved without an iteration.
constexpr double smallest_accepted_pivot = 1e-12, smallest_with_bounds = 1e-8;

// Largest number of blocks in a column for which the order is improved further
constexpr size_t most_blocks = 50;

using Column = Eigen::Array4d;

// In the functions below a block is a pointer to its columns of four numbers. The sizes are parameters of the
// templates, so that the compiler unrolls the loops.

/// The column of these numbers. It is composed in a register: a column that is stored by its numbers and read
/// at once delays the processor.
Column column_of(double a, double b, double c, double d)
{
    typedef double Four __attribute__((vector_size(4 * sizeof(double))));
    const Four numbers{a, b, c, d};
    Column column;
    std::memcpy(column.data(), &numbers, sizeof numbers);
    return column;
}

/// The column number(0), number(1), … of this many rows
template <int rows, class Number>
Column column_of(const Number& number)
{
    return column_of(number(0), rows > 1 ? number(1) : 0, rows > 2 ? number(2) : 0, rows > 3 ? number(3) : 0);
}

/// How the rows of a group depend on r of a body
enum Translation { none, one_component, all_components, translations };

/// S += A Bᵀ with the parts of W for one body: six columns each, B of n rows
template <int n, Translation translation>
void add_term(Column* S, const Column* A, const Column* B, const int* component)
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

using AddTerm = void (*)(Column*, const Column*, const Column*, const int*);
constexpr AddTerm add_term_of[] = {
    add_term<1, none>, add_term<1, one_component>, add_term<1, all_components>,
    add_term<2, none>, add_term<2, one_component>, add_term<2, all_components>,
    add_term<3, none>, add_term<3, one_component>, add_term<3, all_components>,
    add_term<4, none>, add_term<4, one_component>, add_term<4, all_components>};

/// S -= A Bᵀ; A and B of m columns, B of n rows
template <int m, int n>
void subtract_product(Column* S, const Column* A, const Column* B)
{
#pragma GCC unroll 4
    for (int c = 0; c < n; ++c) {
        Column sum = S[c];
#pragma GCC unroll 4
        for (int d = 0; d < m; ++d) sum -= A[d] * B[d][c];
        S[c] = sum;
    }
}

template <int m>
void subtract_product(Column* S, const Column* A, const Column* B, int n)
{
    switch (n) {
        case 1:
            return subtract_product<m, 1>(S, A, B);
        case 2:
            return subtract_product<m, 2>(S, A, B);
        case 3:
            return subtract_product<m, 3>(S, A, B);
        default:
            return subtract_product<m, 4>(S, A, B);
    }
}

/// The smallest ratio of a pivot to its diagonal entry
struct SmallestPivot {
    double pivot = 1, entry = 1;

    void take(double other, double its_entry)
    {
        if (other * entry < pivot * its_entry) pivot = other, entry = its_entry;
    }
};

/// Factors the m columns of the block D as L E Lᵀ, L with a unit diagonal, E diagonal. They then hold L with
/// 1/E on the diagonal and zeros above. Returns false if a pivot is not larger than `least` times its entry
/// of `original`.
template <int m>
bool factor_block(Column* D, const Column& original, double least, SmallestPivot& smallest)
{
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
        const double pivot = D[k][k];
        if (!(pivot > least * original[k])) return false;
        smallest.take(pivot, original[k]);
        const double reciprocal = 1 / pivot;
        const Column L = D[k] * reciprocal;
#pragma GCC unroll 4
        for (int c = k + 1; c < m; ++c) D[c] -= L * D[k][c];
        D[k] = L;
        D[k][k] = reciprocal;
#pragma GCC unroll 4
        for (int r = 0; r < k; ++r) D[k][r] = 0;
    }
    return true;
}

/// B ← B L⁻ᵀ and `divided` = B E⁻¹; of m columns
template <int m>
void divide(Column* B, Column* divided, const Column* L)
{
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
#pragma GCC unroll 4
        for (int c = k + 1; c < m; ++c) B[c] -= B[k] * L[k][c];
        divided[k] = B[k] * L[k][k];
    }
}

/// The sum of the four products, in the order of the rows
double dot(const Column& a, const Column& b)
{
    const Column p = a * b;
    return p[0] + p[1] + p[2] + p[3];
}

/// y ← L⁻¹ y for the m columns of L, and `divided` = E⁻¹ y
template <int m>
void solve_lower(Column& y, double* divided, const Column* L)
{
    double solution[m];
#pragma GCC unroll 4
    for (int k = 0; k < m; ++k) {
        solution[k] = y[k];
        divided[k] = solution[k] * L[k][k];
        y -= L[k] * solution[k];
    }
    y = column_of<m>([&](int k) { return solution[k]; });
}

/// y ← L⁻ᵀ E⁻¹ y
template <int m>
void solve_upper(double* y, const Column* L)
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
auto with_rows(int rows, const Function& function)
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

/// Bits 0 to 2: the components of r of the body on which the row entry depends
unsigned translation_bits(const Rows::Entry& entry) { return entry.nonzero & 0b111; }

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

/// The blocks of a column are the neighbours of the group that are eliminated after it, and those of its
/// children in the elimination tree. The parent of a group is the first of them. Returns the blocks of each
/// column in the order of elimination, and adds the fill-in to the neighbours.
std::vector<std::vector<int>> eliminate(const std::vector<int>& order, std::vector<std::set<int>>& neighbours)
{
    std::vector<int> position(order.size());
    for (size_t p = 0; p < order.size(); ++p) position[order[p]] = static_cast<int>(p);
    const auto earlier = [&](int a, int b) { return position[a] < position[b]; };
    std::vector<std::vector<int>> below(order.size());
    for (const int g : order) {
        for (const int h : neighbours[g])
            if (earlier(g, h)) below[g].push_back(h);
        std::sort(below[g].begin(), below[g].end(), earlier);
        if (below[g].empty()) continue;
        const int parent = below[g].front();
        for (size_t n = 1; n < below[g].size(); ++n)
            neighbours[parent].insert(below[g][n]), neighbours[below[g][n]].insert(parent);
    }
    return below;
}

/// An order without further fill-in for a graph with its fill-in, of an elimination tree of least height
/// (Jess and Kees 1982): level by level all groups that can be eliminated independently of each other.
/// Operations that follow each other then do not depend on each other, and the processor overlaps them. A
/// chain is eliminated from both ends.
std::vector<int> least_height_order(std::vector<std::set<int>> neighbours)
{
    std::vector<int> order;
    std::set<int> candidates;
    for (int g = 0; g < static_cast<int>(neighbours.size()); ++g) candidates.insert(g);
    const auto is_simplicial = [&](int g) {  // all neighbours are neighbours of each other
        const std::set<int>& all = neighbours[g];
        return std::all_of(all.begin(), all.end(), [&](int a) {
            return std::all_of(all.upper_bound(a), all.end(),
                               [&](int b) { return neighbours[a].count(b) != 0; });
        });
    };
    while (order.size() < neighbours.size()) {
        std::set<int> level, next;
        for (const int g : candidates)
            if (std::none_of(neighbours[g].begin(), neighbours[g].end(),
                             [&](int h) { return level.count(h) != 0; }) &&
                is_simplicial(g))
                level.insert(g);
        for (const int g : level) {
            for (const int h : neighbours[g]) neighbours[h].erase(g);
            next.insert(neighbours[g].begin(), neighbours[g].end());
        }
        order.insert(order.end(), level.begin(), level.end());
        candidates = std::move(next);
    }
    return order;
}

}  // namespace

Condensed::Condensed(const Mass& mass, const Rows& pattern)
{
    for (const double m : mass.m) by_sqrt_m.push_back(1 / std::sqrt(m));
    for (const Mat3& J_bar : mass.J_bar) L_inverse.push_back(Mat3(J_bar.llt().matrixL()).inverse());
    find_groups(pattern);
    find_order(pattern);
}

void Condensed::find_groups(const Rows& pattern)
{
    const auto bodies = [&](int k) {
        std::vector<int> all;
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n) all.push_back(pattern.entry[n].body);
        return all;
    };
    const auto has_translation = [&](int k) {
        const auto entry = pattern.entry.begin();
        return std::any_of(entry + pattern.start[k], entry + pattern.start[k + 1],
                           [](const Rows::Entry& of) { return translation_bits(of) != 0; });
    };
    int w = 0;
    for (int k = 0; k < pattern.rows(); ++k) {
        const std::vector<int> mine = bodies(k);
        if (group.empty() || group.back().rows == most_rows || bodies(group.back().first) != mine ||
            group.back().has_translation != has_translation(k)) {
            group.push_back({.first = k,
                             .rows = 0,
                             .bodies = static_cast<int>(mine.size()),
                             .body = static_cast<int>(body_of.size()),
                             .has_translation = has_translation(k)});
            body_of.insert(body_of.end(), mine.begin(), mine.end());
        }
        ++group.back().rows;
    }
    for (Group& g : group) {
        g.w = w;
        w += 6 * g.bodies;
    }
    W.assign(w, Column::Zero());
    y.assign(group.size(), Column::Zero());
    diagonal.assign(group.size(), Column::Ones());
}

/// The contribution of a body, number s of group g and number t of group h, without its place in `value`
Condensed::Term Condensed::term_of(const Rows& pattern, int g, int s, int h, int t) const
{
    Translation translation = group[g].has_translation && group[h].has_translation ? one_component : none;
    Term of{.kernel = 0, .w_of = group[g].w + 6 * s, .w_by = group[h].w + 6 * t, .at = 0, .component = {}};
    for (int k = 0; k < group[h].rows; ++k) {
        const unsigned bits = translation_bits(pattern.entry[pattern.start[group[h].first + k] + t]);
        if (std::popcount(bits) > 1 && translation != none) translation = all_components;
        of.component[k] = bits != 0 ? std::countr_zero(bits) : 0;
    }
    of.kernel = (group[h].rows - 1) * translations + translation;
    return of;
}

void Condensed::find_order(const Rows& pattern)
{
    // groups are neighbours if they share a body
    const int n = static_cast<int>(group.size());
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
    below = eliminate(order, neighbours);
    const auto most = [&] {
        size_t blocks = 0;
        for (const std::vector<int>& of_column : below) blocks = std::max(blocks, of_column.size());
        return blocks;
    };
    if (most() <= most_blocks) {  // the order of a dense matrix makes no difference
        order = least_height_order(neighbours);
        below = eliminate(order, neighbours);
    }
    position.resize(n);
    for (int p = 0; p < n; ++p) position[order[p]] = p;
    divided.assign(most_rows * most(), Column::Zero());

    fill = -couplings / 2;
    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all)
                if (position[g] >= position[h])
                    products +=
                        group[h].rows * (group[g].has_translation && group[h].has_translation ? 4 : 3);
    for (int g = 0; g < n; ++g) {
        const double m = group[g].rows, blocks = static_cast<double>(below[g].size());
        products += 0.5 * m * (m + 1) * (1 + blocks);
        fill += static_cast<long>(blocks);
        for (size_t k = 0; k < below[g].size(); ++k)  // the blocks from k on, times block k
            products += m * group[below[g][k]].rows * (blocks - static_cast<double>(k));
    }
}

/// The first column of the block of the rows of group h in the columns of group g
int Condensed::place(int h, int g) const
{
    if (h == g) return group[g].diagonal;
    const auto found = std::lower_bound(below[g].begin(), below[g].end(), h,
                                        [&](int a, int b) { return position[a] < position[b]; });
    return group[g].diagonal + group[g].rows * (1 + static_cast<int>(found - below[g].begin()));
}

void Condensed::prepare(const Rows& pattern)
{
    // storage of the blocks, column by column
    int size = 0;
    for (const int g : order) {
        group[g].diagonal = size;
        size += group[g].rows;
        column.push_back(static_cast<int>(block.size()));
        for (const int h : below[g]) {
            block.push_back({.of = h, .at = size});
            size += group[g].rows;
        }
    }
    column.push_back(static_cast<int>(block.size()));
    value.assign(size, Column::Zero());
    for (const int k : pattern.regularised) {
        const auto after = std::upper_bound(group.begin(), group.end(), k,
                                            [](int row, const Group& g) { return row < g.first; });
        const int g = static_cast<int>(after - group.begin()) - 1;
        regularised_at.emplace_back(g, k - group[g].first);
    }

    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all) {
                if (position[g] < position[h]) continue;
                term.push_back(term_of(pattern, g, s, h, t));
                term.back().at = place(g, h);
            }
    // Equal kernels follow each other: their calls are then predicted.
    std::stable_sort(term.begin(), term.end(),
                     [](const Term& a, const Term& b) { return a.kernel < b.kernel; });
    for (const int g : order) {
        update_start.push_back(static_cast<int>(update.size()));
        for (size_t i = 0; i < below[g].size(); ++i)
            for (size_t j = 0; j <= i; ++j) {
                const int h = below[g][i], k = below[g][j];
                update.push_back({.by = group[k].rows,
                                  .of = static_cast<int>(i) * group[g].rows,
                                  .at_by = place(k, g),
                                  .to = place(h, k)});
            }
    }
    update_start.push_back(static_cast<int>(update.size()));
}

/// W = C L⁻ᵀ
void Condensed::set_w(const Rows& C)
{
    for (const Group& g : group)
        with_rows(g.rows, [&]<int rows>() {
            const Rows::Entry* entry = C.entry.data() + C.start[g.first];
            Column* w = W.data() + g.w;
            for (int s = 0; s < g.bodies; ++s, ++entry, w += 6) {
                const double by_sqrt = by_sqrt_m[entry->body];
                const Mat3& L = L_inverse[entry->body];
                const auto r = [&](int c) {
                    return column_of<rows>([&](int k) { return entry[k * g.bodies].r[c]; });
                };
                const auto pi = [&](int c) {
                    return column_of<rows>([&](int k) { return entry[k * g.bodies].pi[c]; });
                };
                const Column pi_x = pi(0), pi_y = pi(1), pi_z = pi(2);
                for (int c = 0; c < 3; ++c) {
                    w[c] = r(c) * by_sqrt;
                    w[3 + c] = pi_x * L(c, 0) + (pi_y * L(c, 1) + pi_z * L(c, 2));
                }
            }
        });
}

bool Condensed::factor(const Rows& C, double shift)
{
    set_w(C);
    std::fill(value.begin(), value.end(), Column::Zero());
    for (const Term& t : term)
        add_term_of[t.kernel](&value[t.at], &W[t.w_of], &W[t.w_by], t.component.data());
    for (size_t g = 0; g < group.size(); ++g)
        for (int k = 0; k < group[g].rows; ++k) diagonal[g][k] = value[group[g].diagonal + k][k];
    if (shift > 0) shift_diagonal(shift);
    for (size_t n = 0; n < regularised_at.size(); ++n) {
        const auto [g, k] = regularised_at[n];
        diagonal[g][k] = value[group[g].diagonal + k][k] += C.compliance[n];
    }

    SmallestPivot so_far;
    const double least = shift > 0               ? 0
                         : C.regularised.empty() ? smallest_accepted_pivot
                                                 : smallest_with_bounds;
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        const bool accepted = with_rows(g.rows, [&]<int rows>() {
            Column *L = &value[g.diagonal], *next = divided.data();
            if (!factor_block<rows>(L, diagonal[order[p]], least, so_far)) return false;
            for (int n = column[p]; n < column[p + 1]; ++n, next += rows)
                divide<rows>(&value[block[n].at], next, L);
            for (int n = update_start[p]; n < update_start[p + 1]; ++n) {
                const Update& u = update[n];
                subtract_product<rows>(&value[u.to], &divided[u.of], &value[u.at_by], u.by);
            }
            return true;
        });
        if (!accepted) return false;
    }
    smallest = so_far.pivot / so_far.entry;
    return true;
}

void Condensed::shift_diagonal(double shift)
{
    for (size_t g = 0; g < group.size(); ++g)
        for (int k = 0; k < group[g].rows; ++k) {
            double& entry = value[group[g].diagonal + k][k];
            entry = entry > 0 ? (1 + shift) * entry : 1;
            diagonal[g][k] = entry;
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
    take_right_side(b);
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
    solve_multipliers();
    finish(b);
}

void Condensed::solve_constraints(Eigen::VectorXd& b)
{
    take_right_side(b);
    solve_multipliers();
    b.setZero();
    finish(b);
}

/// y = -g
void Condensed::take_right_side(const Eigen::VectorXd& b)
{
    const double* g = b.data() + 6 * by_sqrt_m.size();
    for (size_t k = 0; k < group.size(); ++k)
        with_rows(group[k].rows, [&]<int rows>() {
            y[k] = column_of<rows>([g](int row) { return -g[row]; });
            g += rows;
        });
}

void Condensed::solve_multipliers()
{
    for (size_t p = 0; p < order.size(); ++p) {
        const Group& g = group[order[p]];
        with_rows(g.rows, [&]<int rows>() {
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
        with_rows(g.rows, [&]<int rows>() {
            double own[rows];
            for (int c = 0; c < rows; ++c) own[c] = y[order[p]][c];
            for (int n = column[p]; n < column[p + 1]; ++n) {
                const Column* B = &value[block[n].at];
                const Column of = y[block[n].of];
                for (int c = 0; c < rows; ++c) own[c] -= dot(B[c], of);
            }
            solve_upper<rows>(own, &value[g.diagonal]);
            y[order[p]] = column_of<rows>([&](int c) { return own[c]; });
        });
    }
}

void Condensed::finish(Eigen::VectorXd& b) const
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
