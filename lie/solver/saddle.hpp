// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle matrix that carries the whole of `lie` and `dae`:
///
///              | M   0   Φ_rᵀ |
///     K(r,A) = | 0   J̄   Π̄ᵀ   |      unknowns: (r, θ) of body 0, of body 1, ..., then one multiplier a row
///              | Φ_r Π̄   0    |
///
/// It gives the accelerations and multipliers of a state (Fang 2022, Eqs. 2.9, 2.17), and it is the frozen
/// Newton matrix of the fully implicit scheme (3.23, force sensitivities dropped) and of both half-implicit
/// ones (3.32, 3.51). It does not contain h, but on the diagonal of rows that give way: Rows::soften.
///
/// With massless unknowns α there is Φ_α in the constraint rows and Φ_αᵀ under a zero diagonal block, as in Eq. 5.48;
/// α stands last.

#pragma once

#include "lie/check.hpp"
#include "lie/solver/condensed.hpp"
#include "lie/solver/elimination.hpp"
#include "lie/solver/klu.hpp"

#include <memory>

namespace hilda::lie {

/// Which metric stands in the diagonal blocks of K.
enum class Metric {
    mass,  ///< M and J̄, as above
    unit   ///< the identity: least-squares problems in the constraint rows alone
};

/// How K z = b is solved.
enum class LinearSolver {
    automatic,  ///< massless unknowns eliminated, the rest condensed where it takes fewer operations than klu
    klu,        ///< the whole of K by KLU
    condensed  ///< massless unknowns eliminated; the Schur complement C M⁻¹ Cᵀ of the constraints, by blocks
};

class Saddle {
public:
    /// Analyses the pattern once; but where rows may be empty, and the solver is not klu, anew whenever the set of empty
    /// rows has changed. The system must outlive the saddle matrix.
    explicit Saddle(const System& system, Metric metric = Metric::mass,
                    LinearSolver solver = LinearSolver::klu);

    /// Evaluates the rows in the state x and factors K there. Where K is condensed, that is the Schur
    /// complement; should the rows be too near to dependence for it, KLU takes over until they no longer are.
    /// With KLU the pivot order of the last full factorisation
    /// is kept while it serves (klu_refactor); when the reciprocal condition says that it no longer does,
    /// pivots are chosen anew. Throws SingularMatrix when that does not help, NonFinite when the rows are not
    /// finite. Rows that give way do so over a step h.
    void assemble(const State& x, double h = 0);
    /// How much softer than they are those rows are taken: p of each, by the next assemble() or give_way()
    void set_compliance_scale(int n, double p) { C.regularised[n].p = p; }
    /// Factors K anew with those, of the rows and the h of the last assemble(); x as there
    void refactor_regularised(const State& x);

    /// The state at which KLU's pivots in use were chosen; without bodies where there are none.
    const State& pivots() const { return pivot_state; }
    /// Has KLU choose them at x, as if the old ones had worn out there.
    void choose_pivots(const State& x);

    /// Solves K z = b in place; b has size() numbers. Throws NonFinite when z is not finite.
    void solve(Eigen::VectorXd& b);
    /// Solves K z = (0, g): of b only the constraint part is read.
    void solve_constraints(Eigen::VectorXd& b);
    /// The same as solve() with one step of iterative refinement: for starts and kinematics, where digits
    /// count.
    void solve_refined(Eigen::VectorXd& b);

    /// out = K z
    void multiply(const Eigen::VectorXd& z, Eigen::VectorXd& out) const { multiply(C, z, out); }
    /// The same with these rows in the place of those assembled
    void multiply(const Rows& C, const Eigen::VectorXd& z, Eigen::VectorXd& out) const;

    const Rows& rows() const { return C; }  ///< Φ_r, Π̄, Φ_α as last assembled
    int size() const { return 6 * bodies + m + unknowns; }
    Eigen::VectorBlock<Eigen::VectorXd> constraint_part(Eigen::VectorXd& z) const
    {
        return z.segment(6 * bodies, m);
    }
    /// Of the massless unknowns, group by group
    Eigen::VectorBlock<Eigen::VectorXd> algebraic_part(Eigen::VectorXd& z) const { return z.tail(unknowns); }

    /// KLU's estimate for the scaled matrix; of the condensed one its smallest pivot
    double reciprocal_condition() const
    {
        return by_condensed ? condensed->smallest_pivot() : klu.reciprocal_condition();
    }
    long factorizations() const { return klu.factorizations(); }  ///< with new pivots
    /// In a fixed order: with the pivots of the last full one, or condensed
    long refactorizations() const { return klu.refactorizations() + by_blocks; }
    bool is_condensed() const { return condensed != nullptr; }

private:
    void analyse();
    void choose_solver();
    void leave_out_inactive();
    void scale_rows();
    void fill();
    void factor(const State& x);
    void factor_rows(const State& x);

    /// The rows that the factors are made of
    const Rows& solved() const { return elimination ? elimination->reduced() : C; }
    void solve_solved(Eigen::VectorXd& b, bool only_constraints);

    const System& system;
    const Metric metric;
    const LinearSolver solver;
    int bodies, m, unknowns;
    Rows C;

    std::unique_ptr<Elimination> elimination;  ///< of the massless unknowns; without, they stay in K
    std::vector<char> inactive;                ///< of the rows, when that was made
    bool chosen = false;                       ///< what K is solved with, for these rows
    Eigen::VectorXd reduced;                   ///< right side and solution without them

    std::unique_ptr<Condensed> condensed;
    bool by_condensed = false;  ///< the factors in use
    double h = 0;               ///< of the last assemble()
    long by_blocks = 0;

    // K scaled to S K S with S chosen so that the diagonal blocks and the rows have length one
    Klu klu{Klu::Scaling::none};
    Eigen::VectorXd scale;
    struct Slot {
        int upper, lower;  ///< where a derivative stands in Φ_rᵀ or Π̄ᵀ, and in Φ_r or Π̄
        double factor;     ///< scale of its row times that of its column
    };
    std::vector<Slot> slot;
    std::vector<int> mass_slot;
    std::vector<int> unilateral_slot;   ///< diagonal entries of the rows that may be empty
    std::vector<int> regularised_slot;  ///< and of those that give way
    Eigen::VectorXd work, residual, right_side;

    State pivot_state;
    bool scaled = false;
};

}  // namespace hilda::lie
