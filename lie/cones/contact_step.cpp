// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/contact_step.hpp"

#include "lie/check.hpp"
#include "lie/cones/overlap_correction.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace hilda::lie {

namespace {

// Tolerance of the first impulses after a step that is not steady, relative to that of the contact law
constexpr double unsteady = 1e-2;
// A change of the velocities of the contact points that is steady, and the speed of a contact point that
// slips, relative to the tolerance of the contact law
constexpr double steady = 0.1, slipping = 1e3;
// Reduced restitution: work that is a rounding error, relative to the energy of the impact, the accuracy of
// zero work, relative to that of the given coefficients, and the number of solutions
constexpr double negligible_work = 1e-9, accurate_work = 1e-3;
constexpr int most_reductions = 20;
// Solutions of a step with contact points that the one before has missed
constexpr int most_rounds = 10;

}  // namespace

ContactStep::ContactStep(const System& system, double tolerance, std::string scheme)
    : system(system), tolerance(tolerance), scheme(std::move(scheme)), C(system.pattern()),
      problem(system.mass(), C), solver(system.mass(), C), y_n(problem.unknowns())
{
    problem.C_b = &C;
}

bool ContactStep::find(const State& x, double step)
{
    contacts.cone.clear();
    missed.cone.clear();
    rounds = 0;
    if (!system.has_cones()) return false;
    x_n = &x;
    h = step;
    system.cones(x, h, contacts);
    if (contacts.cone.empty()) return false;
    system.variation(x, C);
    return true;
}

bool ContactStep::add_missed(const State& x, const ConeRows& at_end)
{
    const auto is_missed = [&](const ConeRows::Cone& cone) {
        return cone.restitution == 0 && -cone.gap > OverlapCorrection::allowed * cone.size &&
               !contacts.has(cone.key);
    };
    if (std::none_of(at_end.cone.begin(), at_end.cone.end(), is_missed)) return false;
    if (rounds++ == most_rounds) return false;
    const bool none = contacts.cone.empty();
    reaching = *x_n;
    for (size_t b = 0; b < x.body.size(); ++b) {
        Motion& body = reaching.body[b];
        if (x.body[b].rdot.norm() > body.rdot.norm()) body.rdot = x.body[b].rdot;
        if (x.body[b].omega_bar.norm() > body.omega_bar.norm()) body.omega_bar = x.body[b].omega_bar;
    }
    system.cones(reaching, h, contacts);
    for (const ConeRows::Cone& cone : at_end.cone) {
        if (!is_missed(cone)) continue;
        missed.cone.push_back(cone);
        missed.cone.back().gap -= h * cone.normal_velocity(x);
    }
    contacts.add_unlisted(missed);
    if (none) system.variation(*x_n, C);
    return true;
}

const Eigen::VectorXd& ContactStep::solve(bool first, const Eigen::VectorXd& right)
{
    problem.q = right.head(problem.q.size()) / h;
    problem.nu = right.tail(problem.nu.size()) / h;
    if (first) start();
    // A later call changes the right side only. The impulses remain if they are as good as before.
    if (!first)
        for (int c = 0; c < problem.contacts(); ++c)
            start_tolerance[c] = std::max(tolerance, 2 * solver.residual(c));
    const ConeSolver::Outcome outcome = solve_with_rebounds();
    if (outcome.status == ConeSolver::Status::failed) fail(outcome);
    residual = outcome.residual;
    is_relaxed = outcome.status == ConeSolver::Status::friction_relaxed;
    return iterate.y;
}

void ContactStep::start()
{
    const size_t count = contacts.cone.size();
    problem.cones = &contacts.cone;
    problem.mu.resize(count);
    problem.beta.resize(count);
    iterate.p.resize(count);
    slipped.resize(count);
    auto last = x_n->cone_forces.begin();
    for (size_t c = 0; c < count; ++c) {
        const ConeRows::Cone& cone = contacts.cone[c];
        while (last != x_n->cone_forces.end() && last->key < cone.key) ++last;
        const bool known = last != x_n->cone_forces.end() && last->key == cone.key;
        slipped[c] = known && last->slips != 0;
        problem.mu[c] = slipped[c] ? cone.mu_k : cone.mu_s;
        iterate.p[c] = known ? Vec3(h * (cone.axes.transpose() * last->F)) : Vec3(Vec3::Zero());
        problem.beta[c] = cone.gap > rounding_of_gap(cone) ? cone.gap / h : 0;
    }
    solver.start(problem);
    set_rebounds();
    set_start_tolerances();
}

void ContactStep::set_rebounds()
{
    for (size_t i = 0; i < x_n->body.size(); ++i)
        y_n.segment<6>(6 * i) << x_n->body[i].rdot, x_n->body[i].omega_bar;
    rebound.assign(contacts.cone.size(), 0);
    rebounds = is_reduced = false;
    bool found = false;
    for (int c = 0; c < problem.contacts(); ++c) {
        const ConeRows::Cone& cone = contacts.cone[c];
        if (!(cone.restitution > 0)) continue;
        const double approach = problem.u(c, y_n)[0];
        if (!(approach < 0)) continue;
        if (!found) {
            found = true;
            without_contacts.p.assign(contacts.cone.size(), Vec3::Zero());
            solver.set_velocities(problem, without_contacts);
        }
        if (!(problem.u(c, without_contacts.y)[0] + cone.gap / h < 0)) continue;
        rebound[c] = cone.restitution * approach;
        problem.beta[c] = rebound[c];
        rebounds = true;
    }
}

/// β of the contact points of an island that rebound, with a factor of their coefficients
void ContactStep::set_rebounds_of(int island, double factor)
{
    for (int c = 0; c < problem.contacts(); ++c)
        if (rebound[c] < 0 && solver.island(c) == island) problem.beta[c] = factor * rebound[c];
}

/// Σ p_c · (u_c⁻ + u_c⁺)/2 of each island [J]
void ContactStep::set_work()
{
    for (Island& island : islands) island.work = island.scale = 0;
    for (int c = 0; c < problem.contacts(); ++c) {
        const Vec3 before = problem.u(c, without_contacts.y);
        Island& of = islands[solver.island(c)];
        of.work += 0.5 * iterate.p[c].dot(problem.u(c, iterate.y) + before);
        of.scale += iterate.p[c].norm() * before.norm();
    }
}

/// The solution with the largest restitution of each island by which its impulses do no work, up to 10⁻³ of
/// the work that the given coefficients do
ConeSolver::Outcome ContactStep::solve_with_rebounds()
{
    const auto solve_again = [&] {
        return solver.solve(problem, iterate, start_tolerance, {.result = tolerance});
    };
    ConeSolver::Outcome outcome = solve_again();
    if (!rebounds || is_reduced || outcome.status == ConeSolver::Status::failed) return outcome;
    islands.assign(std::max(1, solver.islands()), {});
    set_work();
    for (Island& island : islands) {
        if (!(island.work > negligible_work * island.scale)) continue;
        island.searches = is_reduced = true;
        island.at_full = island.at_high = island.work;
    }
    if (!is_reduced) return outcome;
    start_tolerance.assign(contacts.cone.size(), unsteady * tolerance);
    const auto number_of = [&](const Island& island) { return static_cast<int>(&island - islands.data()); };
    for (int k = 0; k < most_reductions; ++k) {
        bool any = false;
        for (Island& island : islands) {
            if (!island.searches) continue;
            // first the plastic impact, then regula falsi, shifted to the side of a loss
            if (k > 0)
                island.factor = island.low + 0.99 * (island.high - island.low) * island.at_low /
                                                 (island.at_low - island.at_high);
            set_rebounds_of(number_of(island), island.factor);
            any = true;
        }
        if (!any) return outcome;
        outcome = solve_again();
        if (outcome.status == ConeSolver::Status::failed) return outcome;
        set_work();
        for (Island& island : islands) {
            if (!island.searches) continue;
            if (island.work > 0) {
                island.high = island.factor, island.at_high = island.work;
            } else {
                island.low = island.factor, island.at_low = island.work;
                if (k > 0 && -island.work <= accurate_work * island.at_full) island.searches = false;
            }
            if (k == 0 && island.at_low == 0)
                island.searches = false;  // also the plastic impact does no work
        }
    }
    for (const Island& island : islands)
        if (island.searches) set_rebounds_of(number_of(island), island.low);
    return solve_again();
}

/// The tolerance of the contact law for a contact point whose velocity the last step has left unchanged,
/// except the tangential one of sliding, and less for the others. The impulses of the last step contain those
/// that have stopped them. They are not those of this step even if the velocity that they cause is within the
/// tolerance, and would start the bodies again.
void ContactStep::set_start_tolerances()
{
    for (size_t i = 0; i < x_n->body.size(); ++i)
        y_n.segment<6>(6 * i) << h * x_n->body[i].rddot, h * x_n->body[i].omegadot_bar;
    start_tolerance.resize(contacts.cone.size());
    for (int c = 0; c < problem.contacts(); ++c) {
        const Vec3 change = problem.u(c, y_n);
        const bool is_steady = (slipped[c] ? std::abs(change[0]) : change.norm()) <= steady * tolerance;
        start_tolerance[c] = is_steady ? tolerance : unsteady * tolerance;
    }
}

/// Rounding error of a gap, from the coordinates of the bodies [m]
double ContactStep::rounding_of_gap(const ConeRows::Cone& cone) const
{
    double largest = cone.size;
    for (const int b : {cone.i, cone.j})
        if (b >= 0) largest = std::max(largest, x_n->body[b].r.cwiseAbs().maxCoeff());
    return 4 * std::numeric_limits<double>::epsilon() * largest;
}

void ContactStep::set_forces(State& x)
{
    x.cone_forces.resize(contacts.cone.size());
    if (contacts.cone.empty()) return;
    worst_residual = std::max(worst_residual, residual);
    if (is_relaxed) ++relaxed_steps;
    if (is_reduced) ++reduced_steps;
    const double sticks = slipping * std::max(tolerance, residual);  // [m/s]
    for (int c = 0; c < problem.contacts(); ++c) {
        const ConeRows::Cone& cone = contacts.cone[c];
        const Vec3 u = problem.u(c, iterate.y);
        const bool slips = iterate.p[c][0] > 0 && tangential(u) > sticks;
        x.cone_forces[c] = {cone.key, cone.axes * iterate.p[c] / h, slips ? 1. : 0.};
    }
}

void ContactStep::count(Statistics& all) const
{
    all.cone_iterations += solver.iterations();
    all.cone_factorizations += solver.factorizations();
    all.cone_residual = std::max(all.cone_residual, worst_residual);
    all.friction_relaxed += relaxed_steps;
    all.restitution_reduced += reduced_steps;
}

void ContactStep::fail(const ConeSolver::Outcome& outcome) const
{
    std::ostringstream what;
    what.precision(3);
    what << scheme << ": the impulses of " << contacts.cone.size() << " contact points were not found. ";
    if (outcome.worst >= 0)
        what << "The contact law has an error of " << outcome.residual << " m/s at "
             << system.cone_name(contacts.cone[outcome.worst].key) << "; ";
    what << "reduce the step";
    throw NumericalFailure("cones_not_solved", what.str());
}

}  // namespace hilda::lie
