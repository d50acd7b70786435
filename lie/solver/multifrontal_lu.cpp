// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/multifrontal_lu.hpp"

#include "lie/check.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <set>
#include <type_traits>

namespace hilda::lie {

namespace {

// A pivot joins the front before it if that adds at most so many rows of zeros to the front.
constexpr int most_zero_rows = 4;
// Fronts with so many columns of four numbers in a column are eliminated by four pivots together.
constexpr int least_of_four = 8;

/// The product without the rules of C for numbers that are not finite
double product(double a, double b) { return a * b; }
std::complex<double> product(const std::complex<double>& a, const std::complex<double>& b)
{
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

using FourNumbers = Eigen::Array<double, 4, 1>;

/// to -= Σ u_m l_m for the columns of numbers from `begin` to `end`, in the order of m
void subtract_from_one(int begin, int end, const FourNumbers* const* l, const FourNumbers& u,
                       FourNumbers* __restrict to)
{
    const FourNumbers *const l_0 = l[0], *const l_1 = l[1], *const l_2 = l[2], *const l_3 = l[3];
    const double u_0 = u[0], u_1 = u[1], u_2 = u[2], u_3 = u[3];
    for (int c = begin; c < end; ++c) {
        FourNumbers sum = to[c];
        sum -= u_0 * l_0[c];
        sum -= u_1 * l_1[c];
        sum -= u_2 * l_2[c];
        sum -= u_3 * l_3[c];
        to[c] = sum;
    }
}

/// The same for two columns, which share the loads of l
void subtract_from_two(int begin, int end, const FourNumbers* const* l, const FourNumbers& u,
                       const FourNumbers& v, FourNumbers* __restrict to, FourNumbers* __restrict next)
{
    const FourNumbers *const l_0 = l[0], *const l_1 = l[1], *const l_2 = l[2], *const l_3 = l[3];
    const double u_0 = u[0], u_1 = u[1], u_2 = u[2], u_3 = u[3];
    const double v_0 = v[0], v_1 = v[1], v_2 = v[2], v_3 = v[3];
    for (int c = begin; c < end; ++c) {
        const FourNumbers a = l_0[c], b = l_1[c], d = l_2[c], e = l_3[c];
        FourNumbers sum = to[c], other = next[c];
        sum -= u_0 * a, other -= v_0 * a;
        sum -= u_1 * b, other -= v_1 * b;
        sum -= u_2 * d, other -= v_2 * d;
        sum -= u_3 * e, other -= v_3 * e;
        to[c] = sum, next[c] = other;
    }
}

}  // namespace

template <class Scalar>
void MultifrontalLu<Scalar>::analyse(int n, const std::vector<int>& order)
{
    std::vector<int> column_start;
    entries.analyse(n, column_start, row_of);
    value.assign(row_of.size(), 0);
    place.assign(static_cast<size_t>(n), 0);
    for (int k = 0; k < n; ++k) place[static_cast<size_t>(order[static_cast<size_t>(k)])] = k;

    // The unknowns below each pivot: those of its own entries and of the pivots whose first one it is
    std::vector<std::set<int>> later(static_cast<size_t>(n));
    for (int c = 0; c < n; ++c)
        for (int k = column_start[c]; k < column_start[c + 1]; ++k) {
            const int one = place[c], two = place[row_of[k]];
            if (one != two) later[std::min(one, two)].insert(std::max(one, two));
        }
    std::vector<std::vector<int>> below(static_cast<size_t>(n));
    for (size_t k = 0; k < later.size(); ++k) {
        below[k].assign(later[k].begin(), later[k].end());
        if (below[k].empty()) continue;
        std::set<int>& parent = later[static_cast<size_t>(below[k].front())];
        parent.insert(below[k].begin() + 1, below[k].end());
        later[k].clear();
    }
    const std::vector<int> front_of = find_fronts(below);

    scalar_at.clear();
    for (int c = 0; c < n; ++c)
        for (int k = column_start[c]; k < column_start[c + 1]; ++k) {
            const int i = place[row_of[k]], j = place[c];
            const Front& f = front[front_of[std::min(i, j)]];
            const auto begin = unknown_of.begin() + f.unknown, end = begin + f.size;
            const auto index = [&](int unknown) { return std::lower_bound(begin, end, unknown) - begin; };
            scalar_at.push_back((f.at + static_cast<size_t>(index(j)) * f.columns) * scalars + index(i));
        }
}

template <class Scalar>
std::vector<int> MultifrontalLu<Scalar>::find_fronts(const std::vector<std::vector<int>>& below)
{
    const int n = static_cast<int>(below.size());
    front.clear();
    unknown_of.clear();
    size_t end = 0;
    int largest = 0, most_columns = 0;
    for (int first = 0; first < n;) {
        // The border of pivots up to `last` is that of `last`, since each joins its first unknown below.
        int last = first;
        for (; last + 1 < n && !below[last].empty() && below[last].front() == last + 1; ++last) {
            const size_t rows_of_first = below[first].size() - static_cast<size_t>(last + 1 - first) + 1;
            if (below[last + 1].size() + 1 > rows_of_first + most_zero_rows) break;
        }
        Front f{.first = first, .pivots = last - first + 1};
        f.size = f.pivots + static_cast<int>(below[last].size());
        f.columns = (f.size + scalars - 1) / scalars;
        f.at = end;
        end += static_cast<size_t>(f.columns) * f.size;
        f.unknown = static_cast<int>(unknown_of.size());
        for (int k = first; k <= last; ++k) unknown_of.push_back(k);
        unknown_of.insert(unknown_of.end(), below[last].begin(), below[last].end());
        largest = std::max(largest, f.size);
        most_columns = std::max(most_columns, f.columns);
        front.push_back(f);
        first = last + 1;
    }
    std::vector<int> front_of;
    for (size_t f = 0; f < front.size(); ++f)
        front_of.resize(front_of.size() + front[f].pivots, static_cast<int>(f));
    index_in_parent.assign(unknown_of.size(), -1);
    for (Front& child : front) {
        if (child.size == child.pivots) continue;
        const int* border = unknown_of.data() + child.unknown;
        child.parent = front_of[border[child.pivots]];
        const Front& parent = front[child.parent];
        const auto begin = unknown_of.begin() + parent.unknown;
        for (int k = child.pivots; k < child.size; ++k)
            index_in_parent[child.unknown + k] =
                static_cast<int>(std::lower_bound(begin, begin + parent.size, border[k]) - begin);
    }
    number.assign(end, Column::Zero());
    l.assign(4 * static_cast<size_t>(most_columns), Column::Zero());
    i_l.assign(static_cast<size_t>(most_columns), Column::Zero());
    pivot.assign(static_cast<size_t>(n), 0);
    inverse = pivot;
    b_ordered.setZero(n);
    part.setZero(largest);
    return front_of;
}

template <class Scalar>
void MultifrontalLu<Scalar>::factor()
{
    ++count;
    std::fill(number.begin(), number.end(), Column::Zero());
    Scalar* all = reinterpret_cast<Scalar*>(number.data());
    for (size_t k = 0; k < value.size(); ++k) all[scalar_at[k]] = value[k];
    for (const Front& f : front) {
        eliminate(f);
        if (f.parent >= 0) add_to_parent(f);
    }
    bool finite = true, singular = false;
    for (const Scalar& p : pivot) {
        finite = finite && std::isfinite(std::real(p)) && std::isfinite(std::imag(p));
        singular = singular || p == Scalar(0);
    }
    if (singular)
        throw SingularMatrix("the Newton matrix is singular: redundant or singular constraints?", 0);
    if (!finite) throw NonFinite("an entry of the Newton matrix or of its factors is not finite");
}

template <class Scalar>
void MultifrontalLu<Scalar>::eliminate(const Front& f)
{
    int k = 0;
    if constexpr (std::is_same_v<Scalar, double>)
        if (f.columns >= least_of_four)
            for (; k + 4 <= f.pivots; k += 4) eliminate_four(f, k);
    for (; k < f.pivots; ++k) eliminate_one(f, k);
}

template <class Scalar>
void MultifrontalLu<Scalar>::eliminate_one(const Front& f, int k)
{
    Scalar* const F = numbers(f);
    Column* const columns = number.data() + f.at;
    const int stride = f.columns * scalars;
    Scalar* const L = reinterpret_cast<Scalar*>(l.data());
    Scalar* const column = F + static_cast<size_t>(k) * stride;
    const Scalar p = column[k], by_p = 1. / p;
    pivot[f.first + k] = p;
    inverse[f.first + k] = by_p;
    const int begin = (k + 1) / scalars;
    for (int i = begin * scalars; i <= k; ++i) L[i] = 0;
    for (int i = k + 1; i < f.size; ++i) L[i] = column[i] = product(column[i], by_p);
    for (int i = f.size; i < stride; ++i) L[i] = 0;
    if constexpr (!std::is_same_v<Scalar, double>) {
        Scalar* const i_L = reinterpret_cast<Scalar*>(i_l.data());
        for (int i = begin * scalars; i < stride; ++i) i_L[i] = {-L[i].imag(), L[i].real()};
    }
    for (int j = k + 1; j < f.size; ++j) {
        const Scalar u = F[static_cast<size_t>(j) * stride + k];
        if (u == Scalar(0)) continue;
        Column* const to = columns + static_cast<size_t>(j) * f.columns;
        if constexpr (std::is_same_v<Scalar, double>)
            for (int c = begin; c < f.columns; ++c) to[c] -= u * l[c];
        else
            for (int c = begin; c < f.columns; ++c) to[c] -= u.real() * l[c] + u.imag() * i_l[c];
    }
}

/// Pivots k to k + 3 with one pass over the columns behind them, which are then read from memory once: large
/// fronts do not fit into the caches. The result is that of eliminate_one() to rounding.
template <class Scalar>
void MultifrontalLu<Scalar>::eliminate_four(const Front& f, int k)
{
    if constexpr (std::is_same_v<Scalar, double>) {
        double* const F = numbers(f);
        Column* const columns = number.data() + f.at;
        const int stride = f.columns * scalars, begin = (k + 1) / scalars;
        const Column* l_of[4];
        const double* L_of[4];
        for (int m = 0; m < 4; ++m) {
            const int of = k + m;
            double* const column = F + static_cast<size_t>(of) * stride;
            Column* const to = columns + static_cast<size_t>(of) * f.columns;
            for (int before = 0; before < m; ++before) {
                const double u = column[k + before];
                for (int c = begin; c < f.columns; ++c) to[c] -= u * l_of[before][c];
            }
            const double p = column[of], by_p = 1. / p;
            pivot[f.first + of] = p;
            inverse[f.first + of] = by_p;
            l_of[m] = l.data() + static_cast<size_t>(m) * f.columns;
            double* const L = reinterpret_cast<double*>(l.data()) + static_cast<size_t>(m) * stride;
            L_of[m] = L;
            for (int i = begin * scalars; i <= of; ++i) L[i] = 0;
            for (int i = of + 1; i < f.size; ++i) L[i] = column[i] = column[i] * by_p;
            for (int i = f.size; i < stride; ++i) L[i] = 0;
        }
        // the entries of U in a column, each with the subtractions of the pivots before it
        const auto u_of = [&](const double* column) {
            Column u;
            u[0] = column[k];
            u[1] = column[k + 1] - u[0] * L_of[0][k + 1];
            u[2] = column[k + 2] - u[0] * L_of[0][k + 2] - u[1] * L_of[1][k + 2];
            u[3] = column[k + 3] - u[0] * L_of[0][k + 3] - u[1] * L_of[1][k + 3] - u[2] * L_of[2][k + 3];
            return u;
        };
        for (int j = k + 4; j < f.size; j += 2) {
            const bool two = j + 1 < f.size;
            const Column u = u_of(F + static_cast<size_t>(j) * stride);
            const Column v = two ? u_of(F + static_cast<size_t>(j + 1) * stride) : Column::Zero();
            if ((u == 0).all() && (v == 0).all()) continue;
            Column* const to = columns + static_cast<size_t>(j) * f.columns;
            if (two)
                subtract_from_two(begin, f.columns, l_of, u, v, to, to + f.columns);
            else
                subtract_from_one(begin, f.columns, l_of, u, to);
        }
    }
}

template <class Scalar>
void MultifrontalLu<Scalar>::add_to_parent(const Front& f)
{
    const Front& parent = front[static_cast<size_t>(f.parent)];
    const int* const index = index_in_parent.data() + f.unknown;
    for (int j = f.pivots; j < f.size; ++j) {
        const Scalar* from = numbers(f) + static_cast<size_t>(j) * f.columns * scalars;
        Scalar* to = numbers(parent) + static_cast<size_t>(index[j]) * parent.columns * scalars;
        for (int i = f.pivots; i < f.size; ++i) to[index[i]] += from[i];
    }
}

template <class Scalar>
void MultifrontalLu<Scalar>::solve(Vector& b)
{
    for (size_t k = 0; k < place.size(); ++k) b_ordered[place[k]] = b[static_cast<Eigen::Index>(k)];
    for (const Front& f : front) {
        const int* const unknown = unknown_of.data() + f.unknown;
        const Scalar* column = numbers(f);
        for (int i = 0; i < f.size; ++i) part[i] = b_ordered[unknown[i]];
        for (int k = 0; k < f.pivots; ++k, column += f.columns * scalars) {
            const Scalar y = part[k];
            for (int i = k + 1; i < f.size; ++i) part[i] -= product(column[i], y);
        }
        for (int i = 0; i < f.size; ++i) b_ordered[unknown[i]] = part[i];
    }
    for (size_t n = front.size(); n-- > 0;) {
        const Front& f = front[n];
        const int* const unknown = unknown_of.data() + f.unknown;
        const Scalar* column = numbers(f) + static_cast<size_t>(f.size) * f.columns * scalars;
        for (int i = 0; i < f.size; ++i) part[i] = b_ordered[unknown[i]];
        for (int j = f.size - 1; j >= 0; --j) {
            column -= f.columns * scalars;
            if (j < f.pivots) part[j] = product(part[j], inverse[f.first + j]);
            const Scalar x = part[j];
            for (int i = 0; i < std::min(j, f.pivots); ++i) part[i] -= product(column[i], x);
        }
        for (int k = 0; k < f.pivots; ++k) b_ordered[unknown[k]] = part[k];
    }
    for (size_t k = 0; k < place.size(); ++k) b[static_cast<Eigen::Index>(k)] = b_ordered[place[k]];
    if (!std::isfinite(std::abs(b.sum()))) throw NonFinite("the solution of the Newton system is not finite");
}

template <class Scalar>
double MultifrontalLu<Scalar>::reciprocal_condition() const
{
    std::vector<double> largest(place.size(), 0.);
    for (size_t k = 0; k < value.size(); ++k)
        largest[row_of[k]] = std::max(largest[row_of[k]], std::abs(value[k]));
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (size_t k = 0; k < place.size(); ++k) {
        const double ratio = std::abs(pivot[place[k]]) / largest[k];
        least = std::min(least, ratio);
        most = std::max(most, ratio);
    }
    return most > 0 ? least / most : 0;
}

template class MultifrontalLu<double>;
template class MultifrontalLu<std::complex<double>>;

}  // namespace hilda::lie
