// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/contact_step.hpp"

#include "lie/check.hpp"
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
    if (!system.has_cones()) return false;
    x_n = &x;
    h = step;
    system.cones(x, h, contacts);
    if (contacts.cone.empty()) return false;
    system.variation(x, C);
    return true;
}

const Eigen::VectorXd& ContactStep::solve(bool first, const Eigen::VectorXd& right)
{
    problem.q = right.head(problem.q.size()) / h;
    problem.nu = right.tail(problem.nu.size()) / h;
    if (first) start();
    // A later call changes the right side only. The impulses remain if they are as good as before.
    const double of_start = first ? start_tolerance : std::max(tolerance, 2 * residual);
    const ConeSolver::Outcome outcome =
        solver.solve(problem, iterate, {.start = of_start, .result = tolerance});
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
    start_tolerance = is_steady() ? tolerance : unsteady * tolerance;
}

void ContactStep::set_rebounds()
{
    for (size_t i = 0; i < x_n->body.size(); ++i)
        y_n.segment<6>(6 * i) << x_n->body[i].rdot, x_n->body[i].omega_bar;
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
        if (problem.u(c, without_contacts.y)[0] + cone.gap / h < 0)
            problem.beta[c] = std::min(problem.beta[c], cone.restitution * approach);
    }
}

/// Whether the last step has left the velocities of the contact points unchanged, except the tangential ones
/// of sliding. If not, its impulses contain those that have stopped the bodies. They are not those of this
/// step even if the velocity that they cause is within the tolerance, and would start the bodies again.
bool ContactStep::is_steady()
{
    for (size_t i = 0; i < x_n->body.size(); ++i)
        y_n.segment<6>(6 * i) << h * x_n->body[i].rddot, h * x_n->body[i].omegadot_bar;
    for (int c = 0; c < problem.contacts(); ++c) {
        const Vec3 change = problem.u(c, y_n);
        if ((slipped[c] ? std::abs(change[0]) : change.norm()) > steady * tolerance) return false;
    }
    return true;
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
    const double sticks = slipping * std::max(tolerance, residual);  // [m/s]
    for (int c = 0; c < problem.contacts(); ++c) {
        const ConeRows::Cone& cone = contacts.cone[c];
        const Vec3 u = problem.u(c, iterate.y);
        const bool slips = iterate.p[c][0] > 0 && std::hypot(u[1], u[2]) > sticks;
        x.cone_forces[c] = {cone.key, cone.axes * iterate.p[c] / h, slips ? 1. : 0.};
    }
}

void ContactStep::count(Statistics& all) const
{
    all.cone_iterations += solver.iterations();
    all.cone_factorizations += solver.factorizations();
    all.cone_residual = std::max(all.cone_residual, worst_residual);
    all.friction_relaxed += relaxed_steps;
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
