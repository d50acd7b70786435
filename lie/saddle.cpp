// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/saddle.hpp"

namespace hilda::lie {

Saddle::Saddle(const System& system, Metric metric, LinearSolver solver)
    : system(system), metric(metric), bodies(system.bodies()), m(system.rows()), C(system.pattern()),
      scale(Eigen::VectorXd::Ones(size())), work(size()), residual(size()), right_side(size())
{
    analyse();
    if (solver == LinearSolver::klu) return;
    Mass unit;
    unit.m.assign(bodies, 1);
    unit.J_bar.assign(bodies, Mat3::Identity());
    condensed = std::make_unique<Condensed>(metric == Metric::mass ? system.mass() : unit, C);
    if (solver == LinearSolver::automatic && condensed->operations() > klu.operations()) condensed = nullptr;
}

void Saddle::analyse()
{
    // columns of body b: its 3 + 9 mass entries, then one entry per row that moves with it
    std::vector<std::vector<std::pair<int, int>>> lower(6 * bodies);  // per column: row, index into slot
    for (int k = 0; k < m; ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1) {
                    lower[6 * C.entry[n].body + c].emplace_back(6 * bodies + k,
                                                                static_cast<int>(slot.size()));
                    slot.push_back({0, 0, 1});
                }

    std::vector<int> column_start(1, 0), row_index;
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
            column_start.push_back(static_cast<int>(row_index.size()));
        }
    for (int k = 0, s = 0; k < m; ++k) {
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1) {
                    slot[s++].upper = static_cast<int>(row_index.size());
                    row_index.push_back(6 * C.entry[n].body + c);
                }
        column_start.push_back(static_cast<int>(row_index.size()));
    }
    klu.analyse(std::move(column_start), std::move(row_index));
}

// S = diag(M, J̄)^(-1/2) on the bodies, and on row k what brings (Φ_r, Π̄) S to length one. Then K is about as
// well conditioned as the mechanism is, whatever its units, and the reciprocal condition means something.
void Saddle::scale_rows()
{
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            if (metric == Metric::mass)
                scale[6 * b + c] =
                    1 / std::sqrt(c < 3 ? system.mass().m[b] : system.mass().J_bar[b](c - 3, c - 3));
    for (int k = 0; k < m; ++k) {
        double sum = 0;
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            const int at = 6 * C.entry[n].body;
            sum += C.entry[n].r.cwiseProduct(scale.segment<3>(at)).squaredNorm() +
                   C.entry[n].pi.cwiseProduct(scale.segment<3>(at + 3)).squaredNorm();
        }
        if (sum > 0) scale[6 * bodies + k] = 1 / std::sqrt(sum);
    }

    int s = 0;
    for (int k = 0; k < m; ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1)
                    slot[s++].factor = scale[6 * bodies + k] * scale[6 * C.entry[n].body + c];
    s = 0;
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            for (int d = c < 3 ? c : 3; d <= (c < 3 ? c : 5); ++d) {
                double entry = c == d;
                if (metric == Metric::mass)
                    entry = (c < 3 ? system.mass().m[b] : system.mass().J_bar[b](d - 3, c - 3)) *
                            scale[6 * b + c] * scale[6 * b + d];
                klu.value[mass_slot[s++]] = entry;
            }
    scaled = true;
}

void Saddle::fill()
{
    const Slot* s = slot.data();
    for (const Rows::Entry& entry : C.entry)
        for (int c = 0; c < 6; ++c)
            if (entry.nonzero >> c & 1) {
                klu.value[s->upper] = klu.value[s->lower] =
                    s->factor * (c < 3 ? entry.r[c] : entry.pi[c - 3]);
                ++s;
            }
}

void Saddle::assemble(const State& x)
{
    system.variation(x, C);
    by_condensed = condensed != nullptr && condensed->factor(C);
    if (by_condensed) {
        ++by_blocks;
        return;
    }
    if (!scaled) scale_rows();
    fill();
    if (!klu.refactor()) factor(x);
}

void Saddle::choose_pivots(const State& x)
{
    system.variation(x, C);
    by_condensed = false;
    factor(x);
}

void Saddle::factor(const State& x)
{
    scale_rows();
    fill();
    klu.factor("the saddle matrix");
    pivot_state = x;
}

void Saddle::solve(Eigen::VectorXd& b)
{
    if (by_condensed) {
        condensed->solve(b);
    } else {
        b.array() *= scale.array();
        klu.solve(b.data());
        b.array() *= scale.array();
    }
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_constraints(Eigen::VectorXd& b)
{
    if (by_condensed) {
        condensed->solve_constraints(b);
        if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
    } else {
        b.head(6 * bodies).setZero();
        solve(b);
    }
}

void Saddle::solve_refined(Eigen::VectorXd& b)
{
    right_side = b;
    solve(b);
    multiply(b, residual);
    work = right_side - residual;
    solve(work);
    b += work;
}

void Saddle::multiply(const Eigen::VectorXd& z, Eigen::VectorXd& out) const
{
    for (int b = 0; b < bodies; ++b) {
        out.segment<6>(6 * b) = z.segment<6>(6 * b);
        if (metric == Metric::unit) continue;
        out.segment<3>(6 * b) *= system.mass().m[b];
        out.segment<3>(6 * b + 3) = system.mass().J_bar[b] * z.segment<3>(6 * b + 3);
    }
    C.add_transpose(1, z.tail(m), out);
    for (int k = 0; k < m; ++k) out[6 * bodies + k] = C.dot(k, z);
}

}  // namespace hilda::lie
