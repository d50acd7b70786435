// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/reference_solution.hpp"

#include "dae/kinematics.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace hilda::reference {

namespace {

// Tolerance of the check of a closed form. It is far above the rounding errors of a closed form and far below
// the effect of a change of the model. Relative to the scale of velocities and loads; absolute for positions
// [m, rad].
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

/// Scale of the velocities: the largest |ṙ| or |ω̄|, at least 1 [m/s, rad/s]
double velocity_scale(const lie::State& x)
{
    double largest = 1;
    for (const lie::Motion& body : x.body)
        largest = std::max({largest, body.rdot.norm(), body.omega_bar.norm()});
    return largest;
}

/// Scale of the loads: sum of the norms of inertia forces, weights and gyroscopic moments [N, N m]
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

/// Sets the multipliers of x by inverse dynamics. Returns false if x does not satisfy the constraints or the
/// equations of motion.
bool set_multipliers(const dae::Model& model, lie::State& x)
{
    if (!(model.largest_residual(x).value <= agreement)) return false;  // false for NaN as well
    if (!(model.largest_velocity_residual(x).value <= agreement * velocity_scale(x))) return false;
    std::vector<dae::Reaction> unbalanced;
    x.lambda = dae::inverse_dynamics(model, x, &unbalanced);
    double imbalance = 0;
    for (const dae::Reaction& r : unbalanced) imbalance += r.F.norm() + r.T.norm();
    return imbalance <= agreement * load_scale(model, x);
}

std::optional<lie::Trajectory> from_closed_form(const dae::Model& model, const lie::State& x,
                                                std::vector<double> instants, const ClosedForm& closed_form)
{
    instants.insert(instants.begin(), x.t);
    lie::Trajectory run = closed_form(instants);
    if (!(distance(x, run.row.front()) <= agreement * velocity_scale(x))) return std::nullopt;
    for (lie::State& y : run.row)
        if (!set_multipliers(model, y)) return std::nullopt;
    run.row.erase(run.row.begin());
    return run;
}

}  // namespace

lie::Trajectory reference_solution(const dae::Model& model, const lie::State& start,
                                   const std::vector<double>& instants)
{
    if (model.has_cones())
        lie::reject("reference::reference_solution",
                    "a model with rigid contacts has no reference solution with adaptive steps; select an "
                    "integrator as the reference (--reference NAME); number of rigid contacts",
                    model.rigid_contacts().size());
    if (!start.internal_state.empty())
        lie::reject(
            "reference::reference_solution",
            "a model with continuous internal states (friction histories) has no reference solution with "
            "adaptive steps; select an integrator as the reference (--reference NAME); number of internal "
            "states",
            start.internal_state.size());
    if (6 * model.bodies() != model.rows() || model.keep_redundant) return index1(model, start, instants);
    dae::Kinematics kinematics(model);
    lie::Trajectory run;
    lie::State x = start;
    for (const double instant : instants) {
        kinematics.move_to(x, instant);
        run.row.push_back(x);
    }
    return run;
}

lie::Trajectory reference_solution(const dae::Model& model, const lie::State& x,
                                   const std::vector<double>& instants, const ClosedForm& closed_form)
{
    try {
        // The closed forms do not cover models with drivers or internal states.
        if (x.discrete_state.empty() && x.internal_state.empty())
            if (auto run = from_closed_form(model, x, instants, closed_form)) return *std::move(run);
    } catch (const lie::InvalidInput&) {  // the closed form does not cover the model
    } catch (const lie::NumericalFailure&) {
    }
    return reference_solution(model, x, instants);
}

}  // namespace hilda::reference
