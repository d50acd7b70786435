// SPDX-License-Identifier: GPL-3.0-or-later
/// The rigid contact points of a step, and the velocities and impulses at its end.

#pragma once

#include "lie/cones/cone_islands.hpp"
#include "lie/state.hpp"
#include "lie/statistics.hpp"

#include <string>
#include <vector>

namespace hilda::lie {

class System;

/// The cone problem of a time-stepping scheme. From the contact points at t_n it takes
///
///     β = max(g, 0)/h, or e u_n(v_n) < 0 if the contact closes within the step and if this is smaller
///     μ = μ_k for a contact point that slipped in the step before, μ_s for the others
///     p = h F of the step before as initial guess, rotated into the present axes
///
/// An overlap g < 0 does not enter β: g/h would throw the bodies apart. The contact closes within the step if
/// u_n + g/h < 0 for the velocities of a step without contacts.
///
/// Contact points are listed if the velocities at t_n can close them within the step. Those that only the
/// impulses of the step close are found at its end, by their overlap, and the step is solved again with them
/// (add_missed). An impact with e > 0 that another impact causes takes place in the next step instead: its
/// approaching velocity is that after the first one.
///
/// Newton's law with friction or with different coefficients can increase the energy (Stronge, 1990). The
/// coefficients of an island are then reduced by a common factor s, the largest one by which its impulses do
/// no work:
///
///     Σ p_c · (u_c⁻ + u_c⁺)/2 ≤ 0,     u⁻ without contacts,     e → s e,  0 ≤ s ≤ 1
///
/// With s = 0 their work is not positive. Other islands keep their coefficients.
class ContactStep {
public:
    /// `tolerance`: of the contact law [m/s]. `scheme`: its name, for messages
    ContactStep(const System& system, double tolerance, std::string scheme);

    /// Finds the contact points of a step h from x, and the joint rows if there are any. x must remain
    /// unchanged until set_forces(). Returns whether there are contact points.
    bool find(const State& x, double h);
    bool empty() const { return contacts.cone.empty(); }
    /// If a contact point without restitution that was not listed overlaps in `at_end`, those of the end x of
    /// the step: lists the contact points again with the larger ones of the velocities of x_n and of x. Those
    /// that are still not listed, such as other parts of the bodies, are added with their rows of the end and
    /// the gap g - h u_n. Returns whether the step must be solved again, at most ten times.
    bool add_missed(const State& x, const ConeRows& at_end);
    /// The joint rows at t_n, if there are contact points
    const Rows& rows() const { return C; }

    /// The velocities v of all bodies at the end of the step, then h λ, for
    ///
    ///     M v + C_bᵀ h λ - Σ C_cᵀ p_c = q,   C_b v = ν
    ///
    /// `right` is h (q, ν). A step may call it several times, with `first` for the first time: the impulses
    /// before are then the initial guess. Throws NumericalFailure "cones_not_solved".
    const Eigen::VectorXd& solve(bool first, const Eigen::VectorXd& right);

    /// The forces of the contact points, p/h, and whether they slip. Ends the step: counts it.
    void set_forces(State& x);
    /// Adds the counters of the cone problems.
    void count(Statistics& all) const;

private:
    void start();
    void set_rebounds();
    ConeSolver::Outcome solve_with_rebounds();
    void set_work();
    void set_rebounds_of(int island, double factor);
    void set_start_tolerances();
    double rounding_of_gap(const ConeRows::Cone& cone) const;
    [[noreturn]] void fail(const ConeSolver::Outcome& outcome) const;

    const System& system;
    const double tolerance;
    const std::string scheme;
    Rows C;
    ConeRows contacts;
    ConeRows missed;            ///< those of the ends of the solutions before of this step
    int rounds = 0;             ///< number of these solutions
    std::vector<char> slipped;  ///< whether each contact point slipped in the last step
    ConeProblem problem;
    ConeIslands solver;
    ConeSolver::Iterate iterate, without_contacts;
    Eigen::VectorXd y_n;
    std::vector<double> rebound;  ///< e u_n(v_n) of the contact points that close with e > 0, else 0 [m/s]
    bool rebounds = false;        ///< whether there are any
    bool is_reduced = false;      ///< whether their coefficients were reduced
    /// Search for the factor s of an island
    struct Island {
        double work = 0, scale = 0;      ///< of the impulses; the energy that they exchange [J]
        double factor = 0;               ///< the present one
        double low = 0, high = 1;        ///< factors without and with positive work
        double at_low = 0, at_high = 0;  ///< their work [J]
        double at_full = 0;              ///< that of the given coefficients [J]
        bool searches = false;
    };
    std::vector<Island> islands;
    State reaching;  ///< x_n with the velocities of add_missed()
    const State* x_n = nullptr;
    double h = 0;
    std::vector<double> start_tolerance;  ///< of the first impulses, for each contact point [m/s]
    double residual = 0, worst_residual = 0;
    bool is_relaxed = false;  ///< whether the last solution has the status friction_relaxed
    long relaxed_steps = 0, reduced_steps = 0;
};

}  // namespace hilda::lie
