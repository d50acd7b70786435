// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle matrix of a constrained mechanical system:
///
///              | M   0   Φ_rᵀ |
///     K(r,A) = | 0   J̄   Π̄ᵀ   |      unknowns: (r, θ̄) of body 0, of body 1, ..., then one multiplier per row
///              | Φ_r Π̄   0    |
///
/// Its solution gives the accelerations and multipliers of a state (Fang 2022, Eqs. 2.9, 2.17). It is also
/// the Newton matrix of the fully implicit scheme (3.23, without the derivatives of the loads) and of the two
/// half-implicit schemes (3.32, 3.51), evaluated once per step at t_n.
///
/// K depends on the step h only through the compliance of regularised rows, which is on the diagonal with a
/// negative sign (Rows::regularised).
///
/// Dependent rows. If the system keeps redundant rows (System::keeps_redundant_rows), the zero block of the
/// multipliers is replaced by -ε D with D = diag(S), the diagonal of the Schur complement S = C M⁻¹ Cᵀ, C =
/// (Φ_r, Π̄). Its Schur complement S + ε D is positive definite for all rows: no rank is decided and no pivot
/// is rejected. It does not depend on the units and the scaling of the rows. solve() is then one correction
/// of an iteration whose residuals are those of the rows without ε (augmented Lagrangian). solve_refined()
/// contains the iteration.
///
/// A system with algebraic variables α has in addition the column Φ_α of the constraint rows and its
/// transpose, with a zero diagonal block (Eq. 5.48). The α are the last unknowns.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/solver/linear_solver.hpp"
#include "lie/state.hpp"

#include <algorithm>
#include <memory>
#include <span>

namespace hilda::lie {

class Condensed;
class Elimination;
class KluSaddle;
class SaddleFactors;
class System;

/// The diagonal blocks of K for the bodies
enum class Metric {
    mass,  ///< M and J̄
    unit   ///< the identity, for least-squares problems with the constraint rows
};

/// The factored saddle matrix of a system: its rows, the shift of redundant rows, and the refinement of the
/// solution. Elimination removes the algebraic variables, and KluSaddle or Condensed factors the rest.
///
/// solve() throws NonFinite if the solution is not finite.
class Saddle {
public:
    /// Analyses the sparsity pattern. If algebraic variables are eliminated, the analysis is repeated when
    /// the set of inactive rows changes. The system must outlive the saddle matrix.
    ///
    /// `springs` is the pattern of the rows of implicit springs, which follow the rows of the system.
    explicit Saddle(const System& system, Metric metric = Metric::mass,
                    LinearSolver solver = LinearSolver::klu, const Rows& springs = {});
    ~Saddle();

    /// For a system that keeps redundant rows: ε for the next assemble(), at least 1e-10. Other systems
    /// ignore it.
    void set_shift(double epsilon) { shift = std::max(epsilon, smallest_shift); }
    /// Largest number of refinements of solve_in_step() with redundant rows. Two are enough for a scheme of
    /// order 2; near a singular configuration more of them only follow the residual of the last Newton step.
    void set_refinements(int most) { refinements = most; }
    double used_shift() const { return keeps ? shift : 0; }
    bool keeps_redundant_rows() const { return keeps; }

    /// Sets the rows of the springs and their compliances for the next assemble(). They have the pattern
    /// given to the constructor.
    void set_springs(const Rows& rows, std::span<const double> compliance)
    {
        C.set_springs(rows, compliance);
    }
    /// Evaluates the rows in the state x and factors K. `compliance` has a number for each regularised row of
    /// friction; without it these rows are inactive.
    ///
    /// The condensed solver factors the Schur complement. If the rows are nearly dependent, KLU replaces it
    /// for this matrix. KLU reuses the pivot order of the last full factorisation (klu_refactor) and chooses
    /// new pivots when the estimate of the reciprocal condition is too small. Throws SingularMatrix if new
    /// pivots do not help, and NonFinite if the rows are not finite.
    void assemble(const State& x, std::span<const double> compliance = {});
    /// Factors K with other compliances. The rows remain those of the last assemble(), which had compliances.
    void refactor(std::span<const double> compliance);

    /// The state at which the present KLU pivots were chosen, with the compliances of the regularised rows in
    /// the place of State::history. It has no bodies if there are no pivots.
    const State& pivots() const { return pivot_state; }
    /// Chooses new KLU pivots in the state x. A state of pivots() gives the same pivots: its compliances of
    /// friction rows replace `compliance`.
    void choose_pivots(const State& x, std::span<const double> compliance = {});

    /// Solves K z = b in place. b has size() components. For corrections of an iteration whose residuals are
    /// exact: the condensed solver may lose up to six digits of the motion.
    void solve(Eigen::VectorXd& b);
    /// Solves K z = (0, g) in place. Only the constraint part g of b is read.
    void solve_constraints(Eigen::VectorXd& b);
    /// solve() with one step of iterative refinement, for initial states and kinematics. With redundant rows
    /// there are up to ten steps, until the motion no longer changes, and the multipliers are those of
    /// minimise_multipliers().
    void solve_refined(Eigen::VectorXd& b);
    /// The solution in a step: solve() with refinement, if there are redundant rows or the condensed solver
    /// has lost digits; without minimise_multipliers()
    void solve_in_step(Eigen::VectorXd& b);
    /// Replaces the multipliers in z by those of minimum norm that exert the same forces Cᵀ λ. The norm is
    /// √(λᵀ D λ), that of the multipliers of rows of length one in the metric of the mass. Does nothing if
    /// the system does not keep redundant rows.
    void minimise_multipliers(Eigen::VectorXd& z);

    /// out = K z
    void multiply(const Eigen::VectorXd& z, Eigen::VectorXd& out) const { multiply(C, z, out); }
    /// out = K z with the rows C instead of those of the last assemble()
    void multiply(const Rows& C, const Eigen::VectorXd& z, Eigen::VectorXd& out) const;

    const Rows& rows() const { return C; }  ///< Φ_r, Π̄ and Φ_α of the last assemble()
    int size() const { return 6 * bodies + m + unknowns; }
    /// The components of the constraint rows, those of springs last
    Eigen::VectorBlock<Eigen::VectorXd> constraint_part(Eigen::VectorXd& z) const
    {
        return z.segment(6 * bodies, m);
    }
    /// The components of the algebraic variables, group by group
    Eigen::VectorBlock<Eigen::VectorXd> algebraic_part(Eigen::VectorXd& z) const { return z.tail(unknowns); }

    /// KLU's estimate for the scaled matrix, or the smallest relative pivot of the condensed matrix
    double reciprocal_condition() const;
    long factorizations() const;  ///< with new pivots
    /// Number of factorisations in a fixed order: KLU with the pivots of an earlier one, or condensed
    long refactorizations() const;
    bool is_condensed() const { return condensed != nullptr; }
    long entries_of_factors() const;  ///< of those of KLU

private:
    void choose_solver();
    void set_rows(const State& x, std::span<const double> compliance);
    void leave_out_inactive();
    void factor_rows(const State& x);
    void factor_with_new_pivots(const State& x);

    /// The rows of the factored matrix: after the elimination of the algebraic variables, if there is one
    const Rows& solved() const;

    void refine(Eigen::VectorXd& b, int most);
    bool is_rounding(const Eigen::VectorXd& change, const Eigen::VectorXd& of) const;

    static constexpr double smallest_shift = 1e-10;  ///< above rounding errors of S
    static constexpr int most_refinements = 10;
    int refinements = most_refinements;

    const System& system;
    const bool keeps;
    double shift = smallest_shift;
    const LinearSolver solver;
    const int bodies, m, unknowns;  ///< unknowns: number of algebraic variables
    const Mass unit;                ///< for Metric::unit
    const Mass& mass;               ///< of the system, or `unit`
    Rows C;
    std::vector<char> inactive;  ///< of each row, at the time of the analysis

    bool chosen = false;                       ///< whether the solver for these rows has been chosen
    std::unique_ptr<Elimination> elimination;  ///< of the algebraic variables; null if they remain in K
    Eigen::VectorXd reduced;                   ///< right side and solution after the elimination
    std::unique_ptr<KluSaddle> klu;
    std::unique_ptr<Condensed> condensed;  ///< null if KLU factors all matrices
    SaddleFactors* factors;                ///< the present ones: `klu` or `condensed`
    bool lost_digits = false;              ///< whether the solutions of `condensed` must be refined
    long condensed_factorizations = 0;

    Eigen::VectorXd work, residual, right_side;
    Eigen::VectorXd redundant;  ///< multipliers before minimise_multipliers()

    State assembled;  ///< state of the last assemble() with compliances, for refactor()
    State pivot_state;
};

}  // namespace hilda::lie
