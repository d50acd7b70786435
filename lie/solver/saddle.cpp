// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/saddle.hpp"

#include "lie/check.hpp"
#include "lie/solver/condensed.hpp"
#include "lie/solver/elimination.hpp"
#include "lie/solver/klu_saddle.hpp"
#include "lie/system.hpp"

#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

// Solutions of the condensed system are refined if a pivot is below this part of its diagonal entry. The
// motion then loses half of the digits of the multipliers.
constexpr double accurate_pivot = 1e-8;
constexpr int most_of_lost = 4;  // refinements

Mass unit_mass(int bodies)
{
    return {std::vector<double>(bodies, 1), std::vector<Mat3>(bodies, Mat3::Identity())};
}

}  // namespace

Saddle::Saddle(const System& system, Metric metric, LinearSolver solver, const Rows& springs)
    : system(system), keeps(system.keeps_redundant_rows()), solver(solver), bodies(system.bodies()),
      m(system.rows() + springs.rows()), unknowns(system.pattern().algebraic_variables()),
      unit(metric == Metric::unit ? unit_mass(bodies) : Mass()),
      mass(metric == Metric::unit ? unit : system.mass()), C(system.pattern()), inactive(m, 0),
      klu(std::make_unique<KluSaddle>(mass)), factors(klu.get()), work(size()), residual(size()),
      right_side(size())
{
    if (springs.rows() > 0) C.append_springs(springs);
    // Otherwise the inactive rows are known only with the first state.
    if ((solver == LinearSolver::klu && !keeps) || unknowns == 0 || C.unilateral.empty()) choose_solver();
}

Saddle::~Saddle() = default;

const Rows& Saddle::solved() const { return elimination ? elimination->reduced() : C; }

double Saddle::reciprocal_condition() const { return factors->reciprocal_condition(); }
long Saddle::factorizations() const { return klu->factorizations(); }
long Saddle::entries_of_factors() const { return klu->entries_of_factors(); }
long Saddle::refactorizations() const { return klu->refactorizations() + condensed_factorizations; }

void Saddle::choose_solver()
{
    if (unknowns > 0 && (solver != LinearSolver::klu || keeps)) {
        elimination = std::make_unique<Elimination>(C, inactive);
        reduced.resize(6 * bodies + elimination->reduced().rows());
    }
    chosen = true;
    factors = klu.get();
    condensed = nullptr;
    if (!keeps) klu->analyse(solved());  // the pattern of redundant rows may be structurally singular
    if (solver == LinearSolver::klu && !keeps) return;
    condensed = std::make_unique<Condensed>(mass, solved());
    if (solver == LinearSolver::automatic && !keeps && condensed->operations() > klu->operations())
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
        klu->rescale();
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
    lost_digits = false;
    if (condensed && condensed->factor(solved(), used_shift())) {
        factors = condensed.get();
        lost_digits = !keeps && condensed->reciprocal_condition() < accurate_pivot;
        ++condensed_factorizations;
        return;
    }
    if (keeps) throw NonFinite("the saddle matrix is not finite");
    factors = klu.get();
    if (!klu->refactor(solved())) factor_with_new_pivots(x);
}

void Saddle::choose_pivots(const State& x, std::span<const double> compliance)
{
    const auto rows = static_cast<Eigen::Index>(C.regularised.size());
    if (!compliance.empty() && x.history.size() == rows)
        compliance = {x.history.data(), static_cast<size_t>(rows - C.springs)};
    set_rows(x, compliance);
    if (keeps) return factor_rows(x);
    factor_with_new_pivots(x);
}

void Saddle::factor_with_new_pivots(const State& x)
{
    lost_digits = false;
    factors = klu.get();
    klu->factor(solved());
    pivot_state = x;
    pivot_state.history =
        Eigen::VectorXd::Map(C.compliance.data(), static_cast<Eigen::Index>(C.compliance.size()));
}

void Saddle::solve(Eigen::VectorXd& b)
{
    if (elimination) {
        elimination->reduce(C, b, false, reduced);
        factors->solve(reduced);
        elimination->expand(C, reduced, b);
    } else {
        factors->solve(b);
    }
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_constraints(Eigen::VectorXd& b)
{
    if (elimination) {
        elimination->reduce(C, b, true, reduced);
        factors->solve_constraints(reduced);
        elimination->expand(C, reduced, b);
    } else {
        algebraic_part(b).setZero();
        factors->solve_constraints(b);
    }
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_refined(Eigen::VectorXd& b)
{
    refine(b, keeps ? most_refinements : lost_digits ? most_of_lost : 1);
    minimise_multipliers(b);
}

void Saddle::solve_in_step(Eigen::VectorXd& b)
{
    if (keeps || lost_digits)
        refine(b, keeps ? refinements : most_of_lost);
    else
        solve(b);
}

void Saddle::refine(Eigen::VectorXd& b, int most)
{
    right_side = b;
    solve(b);
    for (int k = 1; k <= most; ++k) {
        multiply(b, residual);
        work = right_side - residual;
        solve(work);
        b += work;
        if ((keeps || lost_digits) && is_rounding(work, b)) return;
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
        out.segment<3>(6 * b) = mass.m[b] * z.segment<3>(6 * b);
        out.segment<3>(6 * b + 3) = mass.J_bar[b] * z.segment<3>(6 * b + 3);
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
