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
    if (!first) start_tolerance.assign(contacts.cone.size(), std::max(tolerance, 2 * residual));
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
        rebounds = true;
    }
    set_restitution(1);
}

/// β of the contact points that rebound, with a factor of their coefficients
void ContactStep::set_restitution(double factor)
{
    for (int c = 0; c < problem.contacts(); ++c)
        if (rebound[c] < 0) problem.beta[c] = factor * rebound[c];
}

/// Σ p_c · (u_c⁻ + u_c⁺)/2 [J]
double ContactStep::work()
{
    double sum = 0;
    for (int c = 0; c < problem.contacts(); ++c)
        sum += 0.5 * iterate.p[c].dot(problem.u(c, iterate.y) + problem.u(c, without_contacts.y));
    return sum;
}

/// The solution with the largest restitution by which the impulses do no work, up to 10⁻³ of the work that
/// the given coefficients do
ConeSolver::Outcome ContactStep::solve_with_rebounds()
{
    const auto solve_again = [&] {
        return solver.solve(problem, iterate, start_tolerance, {.result = tolerance});
    };
    ConeSolver::Outcome outcome = solve_again();
    if (!rebounds || is_reduced || outcome.status == ConeSolver::Status::failed) return outcome;
    double energy = 0;  // that the impulses exchange, the scale of rounding errors
    for (int c = 0; c < problem.contacts(); ++c)
        energy += iterate.p[c].norm() * problem.u(c, without_contacts.y).norm();
    const double at_full = work();
    if (!(at_full > negligible_work * energy)) return outcome;
    is_reduced = true;
    start_tolerance.assign(contacts.cone.size(), unsteady * tolerance);
    double low = 0, high = 1, at_high = at_full, at_low = 0;
    for (int k = 0; k < most_reductions; ++k) {
        // first the plastic impact, then regula falsi, shifted to the side of a loss
        const double factor = k == 0 ? 0 : low + 0.99 * (high - low) * at_low / (at_low - at_high);
        set_restitution(factor);
        outcome = solve_again();
        if (outcome.status == ConeSolver::Status::failed) return outcome;
        const double now = work();
        if (now > 0) {
            high = factor, at_high = now;
        } else {
            low = factor, at_low = now;
            if (k > 0 && -now <= accurate_work * at_full) return outcome;
        }
        if (k == 0 && at_low == 0) return outcome;  // also the plastic impact does no work
    }
    set_restitution(low);
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
