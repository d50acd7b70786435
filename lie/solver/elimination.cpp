// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/elimination.hpp"

#include "lie/check.hpp"

#include <algorithm>

namespace hilda::lie {

namespace {

// Smallest accepted ratio of two diagonal entries of R. Below it, the algebraic variables are indeterminate
// in double precision.
constexpr double smallest_diagonal_ratio = 1e-13;

}  // namespace

Elimination::Elimination(const Rows& pattern, const std::vector<char>& inactive)
{
    int row = 0, alpha = 0;
    const auto append_rows_until = [&](int end) {
        bool begun = false;
        for (; row < end; ++row) {
            if (inactive[row]) {
                inactive_rows.push_back({row, 1, 0, 0});
                begun = false;
                continue;
            }
            if (!begun) group.push_back({row, 0, 0, remaining.rows(), 0, -1, {}, {}, {}, {}});
            begun = true;
            ++group.back().rows;
            remaining.entry.insert(remaining.entry.end(), pattern.entry.begin() + pattern.start[row],
                                   pattern.entry.begin() + pattern.start[row + 1]);
            remaining.start.push_back(static_cast<int>(remaining.entry.size()));
        }
    };
    for (size_t n = 0; n < pattern.algebraic.size(); ++n) {
        const Rows::AlgebraicGroup& m = pattern.algebraic[n];
        append_rows_until(m.first);
        if (inactive[m.first + m.rows - 1]) {
            inactive_rows.push_back({m.first, m.rows, alpha, m.count});
            row += m.rows;
            alpha += m.count;
            continue;
        }
        group.push_back(
            {m.first, m.rows, m.count, remaining.rows(), alpha, static_cast<int>(n), {}, {}, {}, {}});
        Group& g = group.back();
        g.QR.setZero(m.rows, m.count);
        g.Z.setZero(m.rows, m.rows - m.count);
        g.beta.setZero(m.count);
        g.lambda_p.setZero(m.rows);
        for (int k = 0; k < m.rows - m.count; ++k) {
            // Zᵀ B has entries for the bodies of all rows of the group, in order of their first occurrence.
            for (int e = pattern.start[m.first]; e < pattern.start[m.first + m.rows]; ++e) {
                const int body = pattern.entry[e].body;
                const bool known =
                    std::any_of(remaining.entry.begin() + remaining.start.back(), remaining.entry.end(),
                                [&](const Rows::Entry& other) { return other.body == body; });
                if (!known)
                    remaining.entry.push_back(
                        {.body = body, .nonzero = 0b111111, .r = Vec3::Zero(), .pi = Vec3::Zero()});
            }
            remaining.start.push_back(static_cast<int>(remaining.entry.size()));
        }
        row += m.rows;
        alpha += m.count;
    }
    append_rows_until(pattern.rows());
    for (int k = pattern.position_rows(); k < pattern.rows(); ++k) remaining.velocity_rows += !inactive[k];
    for (size_t n = 0; n < pattern.regularised.size(); ++n)
        for (const Group& g : group)
            if (const int k = pattern.regularised[n] - g.first; k >= 0 && k < g.rows) {
                regularised.push_back(static_cast<int>(n));
                remaining.regularised.push_back(g.reduced_first + k);
            }
    remaining.compliance.resize(regularised.size());
    remaining.springs = pattern.springs;
}

void Elimination::reflect(const Group& g, Few& v, bool transpose)
{
    for (int n = 0; n < g.count; ++n) {
        const int k = transpose ? n : g.count - 1 - n;
        double sum = v[k];
        for (int r = k + 1; r < g.rows; ++r) sum += g.QR(r, k) * v[r];
        sum *= g.beta[k];
        v[k] -= sum;
        for (int r = k + 1; r < g.rows; ++r) v[r] -= sum * g.QR(r, k);
    }
}

void Elimination::factor(const Rows& full)
{
    for (size_t n = 0; n < regularised.size(); ++n) remaining.compliance[n] = full.compliance[regularised[n]];
    for (Group& g : group) {
        if (g.count == 0) {
            std::copy(full.entry.begin() + full.start[g.first],
                      full.entry.begin() + full.start[g.first + g.rows],
                      remaining.entry.begin() + remaining.start[g.reduced_first]);
            continue;
        }
        const Rows::AlgebraicGroup& m = full.algebraic[g.algebraic];
        g.QR = m.D;
        double largest = 0, smallest = std::numeric_limits<double>::infinity();
        for (int k = 0; k < g.count; ++k) {
            double below = 0;
            for (int r = k + 1; r < g.rows; ++r) below += g.QR(r, k) * g.QR(r, k);
            const double head = g.QR(k, k), norm = std::sqrt(head * head + below);
            const double diagonal = head > 0 ? -norm : norm, v = head - diagonal;
            largest = std::max(largest, norm), smallest = std::min(smallest, norm);
            if (!(norm > 0)) break;
            g.beta[k] = -v / diagonal;
            for (int r = k + 1; r < g.rows; ++r) g.QR(r, k) /= v;
            g.QR(k, k) = diagonal;
            for (int c = k + 1; c < g.count; ++c) {
                double sum = g.QR(k, c);
                for (int r = k + 1; r < g.rows; ++r) sum += g.QR(r, k) * g.QR(r, c);
                sum *= g.beta[k];
                g.QR(k, c) -= sum;
                for (int r = k + 1; r < g.rows; ++r) g.QR(r, c) -= sum * g.QR(r, k);
            }
        }
        if (!(smallest > smallest_diagonal_ratio * largest))
            throw SingularMatrix("the constraint rows of a contact do not determine its contact points",
                                 smallest / largest);
        for (int k = 0; k < g.rows - g.count; ++k) {
            Few z = Few::Unit(g.rows, g.count + k);
            reflect(g, z, false);
            g.Z.col(k) = z;
            const auto first = remaining.entry.begin() + remaining.start[g.reduced_first + k];
            const auto last = remaining.entry.begin() + remaining.start[g.reduced_first + k + 1];
            for (auto entry = first; entry != last; ++entry) entry->r.setZero(), entry->pi.setZero();
            for (int r = 0; r < g.rows; ++r)
                for (int e = full.start[g.first + r]; e < full.start[g.first + r + 1]; ++e)
                    for (auto entry = first; entry != last; ++entry)
                        if (entry->body == full.entry[e].body) {
                            entry->r += z[r] * full.entry[e].r;
                            entry->pi += z[r] * full.entry[e].pi;
                        }
        }
    }
}

void Elimination::reduce(const Rows& full, const Eigen::VectorXd& whole, bool only_g,
                         Eigen::VectorXd& reduced)
{
    const auto body_part = static_cast<int>(whole.size()) - full.rows() - full.algebraic_variables();
    bodies = body_part / 6;
    if (only_g)
        reduced.head(body_part).setZero();
    else
        reduced.head(body_part) = whole.head(body_part);
    const auto g_part = whole.segment(body_part, full.rows());
    const auto p_part = whole.tail(full.algebraic_variables());
    for (Group& g : group) {
        if (g.count == 0) {
            reduced.segment(body_part + g.reduced_first, g.rows) = g_part.segment(g.first, g.rows);
            continue;
        }
        for (int k = 0; k < g.rows - g.count; ++k) {
            double sum = 0;
            for (int r = 0; r < g.rows; ++r) sum += g.Z(r, k) * g_part[g.first + r];
            reduced[body_part + g.reduced_first + k] = sum;
        }
        g.lambda_p.setZero();
        if (only_g || p_part.segment(g.alpha, g.count).isZero(0)) continue;
        for (int c = 0; c < g.count; ++c) {  // R⁻ᵀ p
            double sum = p_part[g.alpha + c];
            for (int r = 0; r < c; ++r) sum -= g.QR(r, c) * g.lambda_p[r];
            g.lambda_p[c] = sum / g.QR(c, c);
        }
        reflect(g, g.lambda_p, false);
        for (int r = 0; r < g.rows; ++r)
            for (int e = full.start[g.first + r]; e < full.start[g.first + r + 1]; ++e) {
                reduced.segment<3>(6 * full.entry[e].body) -= g.lambda_p[r] * full.entry[e].r;
                reduced.segment<3>(6 * full.entry[e].body + 3) -= g.lambda_p[r] * full.entry[e].pi;
            }
    }
}

void Elimination::expand(const Rows& full, const Eigen::VectorXd& reduced, Eigen::VectorXd& whole) const
{
    const int body_part = 6 * bodies;
    whole.head(body_part) = reduced.head(body_part);
    auto g_part = whole.segment(body_part, full.rows());
    auto alpha_part = whole.tail(full.algebraic_variables());
    for (const InactiveRows& l : inactive_rows) {
        g_part.segment(l.first, l.rows).setZero();
        alpha_part.segment(l.alpha, l.count).setZero();
    }
    for (const Group& g : group) {
        if (g.count == 0) {
            g_part.segment(g.first, g.rows) = reduced.segment(body_part + g.reduced_first, g.rows);
            continue;
        }
        Few residual(g.rows);
        for (int r = 0; r < g.rows; ++r) residual[r] = g_part[g.first + r] - full.dot(g.first + r, reduced);
        reflect(g, residual, true);
        for (int c = g.count - 1; c >= 0; --c) {
            double sum = residual[c];
            for (int d = c + 1; d < g.count; ++d) sum -= g.QR(c, d) * alpha_part[g.alpha + d];
            alpha_part[g.alpha + c] = sum / g.QR(c, c);
        }
        for (int r = 0; r < g.rows; ++r) {
            double sum = g.lambda_p[r];
            for (int k = 0; k < g.rows - g.count; ++k)
                sum += g.Z(r, k) * reduced[body_part + g.reduced_first + k];
            g_part[g.first + r] = sum;
        }
    }
}

}  // namespace hilda::lie
