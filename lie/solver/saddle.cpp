// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/saddle.hpp"

#include "lie/check.hpp"
#include "lie/solver/condensed.hpp"
#include "lie/solver/elimination.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

Saddle::Saddle(const System& system, Metric metric, LinearSolver solver, const Rows& springs)
    : system(system), keeps(system.keeps_redundant_rows()), metric(metric), solver(solver),
      bodies(system.bodies()), m(system.rows() + springs.rows()),
      unknowns(system.pattern().algebraic_variables()), C(system.pattern()), inactive(m, 0), work(size()),
      residual(size()), right_side(size())
{
    if (springs.rows() > 0) C.append_springs(springs);
    // Otherwise the inactive rows are known only with the first state.
    if ((solver == LinearSolver::klu && !keeps) || unknowns == 0 || C.unilateral.empty()) choose_solver();
}

Saddle::~Saddle() = default;

const Rows& Saddle::solved() const { return elimination ? elimination->reduced() : C; }

double Saddle::reciprocal_condition() const
{
    return by_condensed ? condensed->smallest_pivot() : klu.reciprocal_condition();
}

void Saddle::choose_solver()
{
    if (unknowns > 0 && (solver != LinearSolver::klu || keeps)) {
        elimination = std::make_unique<Elimination>(C, inactive);
        reduced.resize(6 * bodies + elimination->reduced().rows());
    }
    scale = Eigen::VectorXd::Ones(elimination ? reduced.size() : size());
    scaled = false;
    chosen = true;
    condensed = nullptr;
    if (!keeps) analyse();  // the pattern of redundant rows may be structurally singular
    if (solver == LinearSolver::klu && !keeps) return;
    Mass unit;
    unit.m.assign(bodies, 1);
    unit.J_bar.assign(bodies, Mat3::Identity());
    condensed = std::make_unique<Condensed>(metric == Metric::mass ? system.mass() : unit, solved());
    if (solver == LinearSolver::automatic && !keeps && condensed->operations() > klu.operations())
        condensed = nullptr;
    else
        condensed->prepare(solved());
}

/// Excludes from the factorisation the rows that are inactive in the state last evaluated.
void Saddle::leave_out_inactive()
{
    bool changed = false;
    for (const int k : C.unilateral)
        if (const char now = C.is_inactive(k); now != inactive[k]) {
            inactive[k] = now;
            changed = true;
        }
    if (!chosen || (changed && elimination))
        choose_solver();
    else if (changed)
        scaled = false;
}

void Saddle::analyse()
{
    const Rows& R = solved();
    const int rows = R.rows();
    slot.clear(), mass_slot.clear(), unilateral_slot.clear(), regularised_slot.clear();
    // Columns of body b: its 3 + 9 mass entries, then one entry for each row that depends on the body.
    std::vector<std::vector<std::pair<int, int>>> lower(6 * bodies);  // of each column: row, index into slot
    std::vector<std::vector<std::pair<int, int>>> of_row(rows), of_alpha(unknowns);
    for (int k = 0; k < rows; ++k)
        for (int n = R.start[k]; n < R.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (R.entry[n].nonzero >> c & 1) {
                    const int at = 6 * R.entry[n].body + c, s = static_cast<int>(slot.size());
                    lower[at].emplace_back(6 * bodies + k, s);
                    of_row[k].emplace_back(at, s);
                    slot.push_back({0, 0, 1});
                }
    int alpha = 0;
    for (const Rows::AlgebraicGroup& group : R.algebraic)
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
        if (std::find(R.unilateral.begin(), R.unilateral.end(), k) != R.unilateral.end()) {
            unilateral_slot.push_back(static_cast<int>(row_index.size()));
            row_index.push_back(6 * bodies + k);
        }
        if (R.is_regularised(k)) {
            if (row_index.back() != 6 * bodies + k) row_index.push_back(6 * bodies + k);
            regularised_slot.push_back(static_cast<int>(row_index.size()) - 1);
        }
        end_column();
    }
    if (!R.algebraic.empty())
        for (const auto& column : of_alpha) {
            for (const auto& [row, s] : column) {
                slot[s].lower = static_cast<int>(row_index.size());
                row_index.push_back(row);
            }
            end_column();
        }
    klu.analyse(std::move(column_start), std::move(row_index));
}

// S = diag(M, J̄)^(-1/2) for the bodies. For row k the scale is 1/|(Φ_r, Π̄) S|, so that the scaled row has
// length one. The condition number of the scaled matrix then depends on the mechanism only and not on its
// units, and its estimate can be compared with a limit. The rows of an algebraic group, whose Φ_α is of
// length one, share one scale, and the variables of the group have its reciprocal.
void Saddle::scale_rows()
{
    const Rows& R = solved();
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            if (metric == Metric::mass)
                scale[6 * b + c] =
                    1 / std::sqrt(c < 3 ? system.mass().m[b] : system.mass().J_bar[b](c - 3, c - 3));
    for (int k = 0; k < R.rows(); ++k) {
        double sum = 0;
        for (int n = R.start[k]; n < R.start[k + 1]; ++n) {
            const int at = 6 * R.entry[n].body;
            sum += R.entry[n].r.cwiseProduct(scale.segment<3>(at)).squaredNorm() +
                   R.entry[n].pi.cwiseProduct(scale.segment<3>(at + 3)).squaredNorm();
        }
        scale[6 * bodies + k] = sum > 0 ? 1 / std::sqrt(sum) : std::numeric_limits<double>::infinity();
    }
    // The compliance of a weak spring may be larger than the inverse effective mass by many orders.
    for (size_t n = R.regularised.size() - static_cast<size_t>(R.springs); n < R.regularised.size(); ++n)
        if (double& of_row = scale[6 * bodies + R.regularised[n]]; std::isfinite(of_row))
            of_row = 1 / std::sqrt(1 / (of_row * of_row) + R.compliance[n]);
    int alpha = 6 * bodies + R.rows();
    for (const Rows::AlgebraicGroup& group : R.algebraic) {
        auto of_rows = scale.segment(6 * bodies + group.first, group.rows);
        const double factor = of_rows.minCoeff();
        of_rows.setConstant(std::isfinite(factor) ? factor : 1);
        for (int c = 0; c < group.count; ++c) scale[alpha++] = 1 / of_rows[0];
    }
    for (int k = 0; k < R.rows(); ++k)
        if (!std::isfinite(scale[6 * bodies + k])) scale[6 * bodies + k] = 1;

    int s = 0;
    for (int k = 0; k < R.rows(); ++k)
        for (int n = R.start[k]; n < R.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (R.entry[n].nonzero >> c & 1)
                    slot[s++].factor = scale[6 * bodies + k] * scale[6 * R.entry[n].body + c];
    // The factor of Φ_α remains 1.
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
    for (const Rows::Entry& entry : solved().entry)
        for (int c = 0; c < 6; ++c)
            if (entry.nonzero >> c & 1) {
                klu.value[s->upper] = klu.value[s->lower] =
                    s->factor * (c < 3 ? entry.r[c] : entry.pi[c - 3]);
                ++s;
            }
    for (const Rows::AlgebraicGroup& group : solved().algebraic)
        for (int c = 0; c < group.count; ++c)
            for (int k = 0; k < group.rows; ++k, ++s)
                klu.value[s->upper] = klu.value[s->lower] = s->factor * group.D(k, c);
    const Rows& R = solved();
    for (const int at : regularised_slot) klu.value[at] = 0;
    for (size_t n = 0; n < unilateral_slot.size(); ++n)  // an inactive row does not change its multiplier
        klu.value[unilateral_slot[n]] = C.is_inactive(C.unilateral[n]) ? -1 : 0;
    for (size_t n = 0; n < regularised_slot.size(); ++n) {
        const double of_row = scale[6 * bodies + R.regularised[n]];
        klu.value[regularised_slot[n]] -= of_row * of_row * R.compliance[n];
    }
}

void Saddle::assemble(const State& x, std::span<const double> compliance)
{
    set_rows(x, compliance);
    factor_rows(x);
    if (!compliance.empty()) assembled = x;
}

void Saddle::refactor(std::span<const double> compliance)
{
    C.regularise(compliance);
    if (elimination) elimination->factor(C);
    factor_rows(assembled);
}

/// Evaluates the rows in the state x and eliminates the algebraic variables.
void Saddle::set_rows(const State& x, std::span<const double> compliance)
{
    system.variation(x, C);
    C.regularise(compliance);
    leave_out_inactive();
    if (elimination) elimination->factor(C);
}

void Saddle::factor_rows(const State& x)
{
    by_condensed = condensed != nullptr && condensed->factor(solved(), keeps ? shift : 0);
    if (by_condensed) {
        ++condensed_factorizations;
        return;
    }
    if (keeps) throw NonFinite("the saddle matrix is not finite");
    if (!scaled) scale_rows();
    fill();
    if (!klu.refactor()) factor(x);
}

void Saddle::choose_pivots(const State& x, std::span<const double> compliance)
{
    const auto rows = static_cast<Eigen::Index>(C.regularised.size());
    if (!compliance.empty() && x.history.size() == rows)
        compliance = {x.history.data(), static_cast<size_t>(rows - C.springs)};
    set_rows(x, compliance);
    if (keeps) return factor_rows(x);
    by_condensed = false;
    factor(x);
}

void Saddle::factor(const State& x)
{
    scale_rows();
    fill();
    klu.factor("the saddle matrix");
    pivot_state = x;
    pivot_state.history =
        Eigen::VectorXd::Map(C.compliance.data(), static_cast<Eigen::Index>(C.compliance.size()));
}

void Saddle::solve_solved(Eigen::VectorXd& b, bool only_constraints)
{
    if (by_condensed) {
        if (only_constraints)
            condensed->solve_constraints(b);
        else
            condensed->solve(b);
        return;
    }
    if (only_constraints) b.head(6 * bodies).setZero();
    b.array() *= scale.array();
    klu.solve(b.data());
    b.array() *= scale.array();
}

void Saddle::solve(Eigen::VectorXd& b)
{
    if (elimination) {
        elimination->reduce(C, b, false, reduced);
        solve_solved(reduced, false);
        elimination->expand(C, reduced, b);
    } else {
        solve_solved(b, false);
    }
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_constraints(Eigen::VectorXd& b)
{
    if (elimination) {
        elimination->reduce(C, b, true, reduced);
        solve_solved(reduced, true);
        elimination->expand(C, reduced, b);
    } else {
        algebraic_part(b).setZero();
        solve_solved(b, true);
    }
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_refined(Eigen::VectorXd& b)
{
    refine(b, keeps ? most_refinements : 1);
    minimise_multipliers(b);
}

void Saddle::solve_in_step(Eigen::VectorXd& b) { keeps ? refine(b, refinements) : solve(b); }

void Saddle::refine(Eigen::VectorXd& b, int most)
{
    right_side = b;
    solve(b);
    for (int k = 1; k <= most; ++k) {
        multiply(b, residual);
        work = right_side - residual;
        solve(work);
        b += work;
        if (keeps && is_rounding(work, b)) return;
    }
}

/// Whether a change of the motion of the bodies is a rounding error
bool Saddle::is_rounding(const Eigen::VectorXd& change, const Eigen::VectorXd& of) const
{
    constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
    return change.head(6 * bodies).norm() <= rounding * of.head(6 * bodies).norm();
}

// With f = Cᵀ λ and g = 0 the multipliers of the regularised system are (S + ε D)⁻¹ S λ. This removes the
// part of λ in the null space of S, and leaves the part that is D-orthogonal to it: the solution of minimum
// norm. An eigenvalue σ of D⁻¹ S changes it by the factor 1 - (ε/(σ + ε))ⁿ after n steps.
void Saddle::minimise_multipliers(Eigen::VectorXd& z)
{
    if (!keeps) return;
    constexpr int steps = 3;
    redundant = constraint_part(z);
    constraint_part(z).setZero();
    for (int k = 0; k < steps; ++k) {
        work.setZero();
        C.add_transpose(1, redundant - constraint_part(z), work);
        solve(work);
        constraint_part(z) += constraint_part(work);
    }
}

void Saddle::multiply(const Rows& C, const Eigen::VectorXd& z, Eigen::VectorXd& out) const
{
    for (int b = 0; b < bodies; ++b) {
        out.segment<6>(6 * b) = z.segment<6>(6 * b);
        if (metric == Metric::unit) continue;
        out.segment<3>(6 * b) *= system.mass().m[b];
        out.segment<3>(6 * b + 3) = system.mass().J_bar[b] * z.segment<3>(6 * b + 3);
    }
    const auto lambda = z.segment(6 * bodies, m);
    C.add_transpose(1, lambda, out);
    for (int k = 0; k < m; ++k) out[6 * bodies + k] = C.dot(k, z);
    for (size_t n = 0; n < C.compliance.size(); ++n)
        out[6 * bodies + C.regularised[n]] -= C.compliance[n] * lambda[C.regularised[n]];
    if (C.algebraic.empty()) return;
    out.tail(unknowns).setZero();
    C.add_algebraic_transpose(1, lambda, out.tail(unknowns));
    int at = 6 * bodies + m;
    for (const Rows::AlgebraicGroup& group : C.algebraic)
        for (int c = 0; c < group.count; ++c, ++at)
            for (int k = 0; k < group.rows; ++k) out[6 * bodies + group.first + k] += group.D(k, c) * z[at];
}

}  // namespace hilda::lie
