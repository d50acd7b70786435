// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/reference_solution.hpp"

#include "dae/kinematics.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace hilda::reference {

namespace {

// Far above the rounding of a closed form and far below what any change of a model does to it. Relative to
// the size of the velocities and of the loads, absolute in m and rad.
constexpr double agreement = 1e-9;

double distance(const lie::State& x, const lie::State& y)
{
    if (x.body.size() != y.body.size()) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion &a = x.body[b], &c = y.body[b];
        sum += (a.r - c.r).squaredNorm() + (a.A - c.A).squaredNorm() + (a.rdot - c.rdot).squaredNorm() +
               (a.omega_bar - c.omega_bar).squaredNorm();
    }
    return std::sqrt(sum);
}

/// The largest velocity, at least 1 [m/s or rad/s]
double velocity_scale(const lie::State& x)
{
    double most = 1;
    for (const lie::Motion& body : x.body) most = std::max({most, body.rdot.norm(), body.omega_bar.norm()});
    return most;
}

/// What the loads that move the bodies amount to [N and N m]
double load_scale(const dae::Model& model, const lie::State& x)
{
    double sum = 0;
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion& body = x.body[b];
        const lie::Mat3& J_bar = model.mass().J_bar[b];
        sum += model.mass().m[b] * (body.rddot.norm() + model.gravity.norm()) +
               (J_bar * body.omegadot_bar).norm() + body.omega_bar.cross(J_bar * body.omega_bar).norm();
    }
    return sum;
}

/// Gives x its multipliers, if there is a motion of the model that passes through it.
bool complete(const dae::Model& model, lie::State& x)
{
    if (!(model.largest_residual(x).value <= agreement)) return false;  // also what is not a number
    if (!(model.largest_velocity_residual(x).value <= agreement * velocity_scale(x))) return false;
    std::vector<dae::Reaction> missing;
    x.lambda = dae::inverse_dynamics(model, x, &missing);
    double lack = 0;
    for (const dae::Reaction& r : missing) lack += r.F.norm() + r.T.norm();
    return lack <= agreement * load_scale(model, x);
}

std::optional<lie::Trajectory> completed(const dae::Model& model, const lie::State& x,
                                         std::vector<double> instants, const ClosedForm& closed_form)
{
    instants.insert(instants.begin(), x.t);
    lie::Trajectory run = closed_form(instants);
    if (!(distance(x, run.row.front()) <= agreement * velocity_scale(x))) return std::nullopt;
    for (lie::State& y : run.row)
        if (!complete(model, y)) return std::nullopt;
    run.row.erase(run.row.begin());
    return run;
}

}  // namespace

lie::Trajectory trusted(const dae::Model& model, const lie::State& start, const std::vector<double>& instants)
{
    if (!start.internal_state.empty())
        lie::reject(
            "reference::trusted",
            "what contacts remember from step to step leaves no equations of motion between the steps: "
            "let an integrator be the reference (--reference NAME); numbers remembered",
            start.internal_state.size());
    if (6 * model.bodies() != model.rows()) return index1(model, start, instants);
    dae::Kinematics kinematics(model);
    lie::Trajectory run;
    lie::State x = start;
    for (const double instant : instants) {
        kinematics.move_to(x, instant);
        run.row.push_back(x);
    }
    return run;
}

lie::Trajectory trusted(const dae::Model& model, const lie::State& x, const std::vector<double>& instants,
                        const ClosedForm& closed_form)
{
    try {
        // What drives or remembers is beyond the closed forms here.
        if (x.discrete_state.empty() && x.internal_state.empty())
            if (auto run = completed(model, x, instants, closed_form)) return *std::move(run);
    } catch (const lie::InvalidInput&) {  // a closed form that does not cover the model
    } catch (const lie::NumericalFailure&) {
    }
    return trusted(model, x, instants);
}

}  // namespace hilda::reference
