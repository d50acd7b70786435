// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/klu_saddle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hilda::lie {

KluSaddle::KluSaddle(const Mass& mass) : mass(mass), bodies(static_cast<int>(mass.m.size())) {}

void KluSaddle::analyse(const Rows& pattern)
{
    const int rows = pattern.rows();
    scale = Eigen::VectorXd::Ones(6 * bodies + rows + pattern.algebraic_variables());
    scaled = false;
    slot.clear(), mass_slot.clear(), unilateral_slot.clear(), regularised_slot.clear();
    // Columns of body b: its 3 + 9 mass entries, then one entry for each row that depends on the body.
    std::vector<std::vector<std::pair<int, int>>> lower(6 * bodies);  // of each column: row, index into slot
    std::vector<std::vector<std::pair<int, int>>> of_row(rows), of_alpha(pattern.algebraic_variables());
    for (int k = 0; k < rows; ++k)
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (pattern.entry[n].nonzero >> c & 1) {
                    const int at = 6 * pattern.entry[n].body + c, s = static_cast<int>(slot.size());
                    lower[at].emplace_back(6 * bodies + k, s);
                    of_row[k].emplace_back(at, s);
                    slot.push_back({0, 0, 1});
                }
    int alpha = 0;
    for (const Rows::AlgebraicGroup& group : pattern.algebraic)
        for (int c = 0; c < group.count; ++c, ++alpha)
            for (int k = 0; k < group.rows; ++k) {
                const int s = static_cast<int>(slot.size());
                of_alpha[alpha].emplace_back(6 * bodies + group.first + k, s);
                of_row[group.first + k].emplace_back(6 * bodies + rows + alpha, s);
                slot.push_back({0, 0, 1});
            }

    std::vector<int> column_start(1, 0), row_index;
    const auto end_column = [&] { column_start.push_back(static_cast<int>(row_index.size())); };
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c) {
            const int first = c < 3 ? c : 3, last = c < 3 ? c : 5;
            for (int d = first; d <= last; ++d) {
                mass_slot.push_back(static_cast<int>(row_index.size()));
                row_index.push_back(6 * b + d);
            }
            for (const auto& [row, s] : lower[6 * b + c]) {
                slot[s].lower = static_cast<int>(row_index.size());
                row_index.push_back(row);
            }
            end_column();
        }
    for (int k = 0; k < rows; ++k) {
        for (const auto& [row, s] : of_row[k]) {
            slot[s].upper = static_cast<int>(row_index.size());
            row_index.push_back(row);
        }
        if (std::find(pattern.unilateral.begin(), pattern.unilateral.end(), k) != pattern.unilateral.end()) {
            unilateral_slot.push_back(static_cast<int>(row_index.size()));
            row_index.push_back(6 * bodies + k);
        }
        if (pattern.is_regularised(k)) {
            if (row_index.back() != 6 * bodies + k) row_index.push_back(6 * bodies + k);
            regularised_slot.push_back(static_cast<int>(row_index.size()) - 1);
        }
        end_column();
    }
    for (const auto& column : of_alpha) {
        for (const auto& [row, s] : column) {
            slot[s].lower = static_cast<int>(row_index.size());
            row_index.push_back(row);
        }
        end_column();
    }
    klu.analyse(std::move(column_start), std::move(row_index));
}

void KluSaddle::set_scales(const Rows& rows)
{
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            scale[6 * b + c] = 1 / std::sqrt(c < 3 ? mass.m[b] : mass.J_bar[b](c - 3, c - 3));
    for (int k = 0; k < rows.rows(); ++k) {
        double sum = 0;
        for (int n = rows.start[k]; n < rows.start[k + 1]; ++n) {
            const int at = 6 * rows.entry[n].body;
            sum += rows.entry[n].r.cwiseProduct(scale.segment<3>(at)).squaredNorm() +
                   rows.entry[n].pi.cwiseProduct(scale.segment<3>(at + 3)).squaredNorm();
        }
        scale[6 * bodies + k] = sum > 0 ? 1 / std::sqrt(sum) : std::numeric_limits<double>::infinity();
    }
    // The compliance of a weak spring may be larger than the inverse effective mass by many orders.
    for (size_t n = rows.regularised.size() - static_cast<size_t>(rows.springs); n < rows.regularised.size();
         ++n)
        if (double& of_row = scale[6 * bodies + rows.regularised[n]]; std::isfinite(of_row))
            of_row = 1 / std::sqrt(1 / (of_row * of_row) + rows.compliance[n]);
    int alpha = 6 * bodies + rows.rows();
    for (const Rows::AlgebraicGroup& group : rows.algebraic) {
        auto of_rows = scale.segment(6 * bodies + group.first, group.rows);
        const double factor = of_rows.minCoeff();
        of_rows.setConstant(std::isfinite(factor) ? factor : 1);
        for (int c = 0; c < group.count; ++c) scale[alpha++] = 1 / of_rows[0];
    }
    for (int k = 0; k < rows.rows(); ++k)
        if (!std::isfinite(scale[6 * bodies + k])) scale[6 * bodies + k] = 1;

    int s = 0;
    for (int k = 0; k < rows.rows(); ++k)
        for (int n = rows.start[k]; n < rows.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (rows.entry[n].nonzero >> c & 1)
                    slot[s++].factor = scale[6 * bodies + k] * scale[6 * rows.entry[n].body + c];
    // The factor of Φ_α remains 1.
    s = 0;
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            for (int d = c < 3 ? c : 3; d <= (c < 3 ? c : 5); ++d)
                klu.value[mass_slot[s++]] =
                    (c < 3 ? mass.m[b] : mass.J_bar[b](d - 3, c - 3)) * scale[6 * b + c] * scale[6 * b + d];
    scaled = true;
}

void KluSaddle::set_values(const Rows& rows)
{
    const Slot* s = slot.data();
    for (const Rows::Entry& entry : rows.entry)
        for (int c = 0; c < 6; ++c)
            if (entry.nonzero >> c & 1) {
                klu.value[s->upper] = klu.value[s->lower] =
                    s->factor * (c < 3 ? entry.r[c] : entry.pi[c - 3]);
                ++s;
            }
    for (const Rows::AlgebraicGroup& group : rows.algebraic)
        for (int c = 0; c < group.count; ++c)
            for (int k = 0; k < group.rows; ++k, ++s)
                klu.value[s->upper] = klu.value[s->lower] = s->factor * group.D(k, c);
    for (const int at : regularised_slot) klu.value[at] = 0;
    for (size_t n = 0; n < unilateral_slot.size(); ++n)  // an inactive row does not change its multiplier
        klu.value[unilateral_slot[n]] = rows.is_inactive(rows.unilateral[n]) ? -1 : 0;
    for (size_t n = 0; n < regularised_slot.size(); ++n) {
        const double of_row = scale[6 * bodies + rows.regularised[n]];
        klu.value[regularised_slot[n]] -= of_row * of_row * rows.compliance[n];
    }
}

bool KluSaddle::refactor(const Rows& rows)
{
    if (!scaled) set_scales(rows);
    set_values(rows);
    return klu.refactor();
}

void KluSaddle::factor(const Rows& rows)
{
    set_scales(rows);
    set_values(rows);
    klu.factor("the saddle matrix");
}

void KluSaddle::solve(Eigen::VectorXd& b)
{
    b.array() *= scale.array();
    klu.solve(b.data());
    b.array() *= scale.array();
}

void KluSaddle::solve_constraints(Eigen::VectorXd& b)
{
    b.head(6 * bodies).setZero();
    solve(b);
}

}  // namespace hilda::lie
