// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/index1.hpp"

#include "dae/model.hpp"
#include "lie/euler_parameters.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"

namespace hilda::reference {

namespace {

/// Number of unknowns of a body: r, p, ṙ, ω̄. The exact solution preserves |p|, and A does not depend on it.
constexpr int size = 13;

void write(const lie::State& x, VectorRef y)
{
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion& body = x.body[b];
        y.segment<size>(static_cast<Eigen::Index>(size * b)) << body.r, lie::euler_parameters(body.A),
            body.rdot, body.omega_bar;
    }
}

void read(double t, const ConstVectorRef& y, lie::State& x)
{
    x.t = t;
    for (size_t b = 0; b < x.body.size(); ++b) {
        const auto q = y.segment<size>(static_cast<Eigen::Index>(size * b));
        lie::Motion& body = x.body[b];
        body.r = q.head<3>();
        body.A = lie::rotation(q.segment<4>(3).normalized());
        body.rdot = q.segment<3>(7);
        body.omega_bar = q.tail<3>();
    }
}

}  // namespace

lie::Trajectory index1(const dae::Model& model, const lie::State& start, const std::vector<double>& instants,
                       const OdeTolerance& tolerance)
{
    // The number of rows is not the rank of a model that keeps redundant rows.
    if (6 * model.bodies() == model.rows() && !model.keep_redundant)
        lie::reject("reference::index1",
                    "the model must have at least one degree of freedom; for a fully driven mechanism use "
                    "kinematic analysis (dae::Kinematics); degrees of freedom",
                    0);
    if (model.has_cones())
        lie::reject(
            "reference::index1",
            "a model with rigid contacts cannot be integrated with adaptive steps; number of contacts",
            model.rigid_contacts().size());
    if (!start.internal_state.empty())
        lie::reject("reference::index1",
                    "a model with continuous internal states (friction histories) cannot be integrated with "
                    "adaptive steps; use an integrator with a fixed step; number of internal states",
                    start.internal_state.size());
    lie::Saddle K(model);
    lie::State x = start, stage = start;

    Ode ode(
        size * model.bodies(),
        [&](double t, const ConstVectorRef& y, VectorRef ydot) {
            read(t, y, stage);
            lie::solve_accelerations(model, K, stage);
            for (size_t b = 0; b < stage.body.size(); ++b) {
                const lie::Motion& body = stage.body[b];
                const auto at = static_cast<Eigen::Index>(size * b);
                const lie::Vec4 p = y.segment<4>(at + 3);
                ydot.segment<size>(at) << body.rdot, 0.5 * lie::G(p).transpose() * body.omega_bar, body.rddot,
                    body.omegadot_bar;
            }
        },
        tolerance);

    const auto accepted = [&](double t, const ConstVectorRef& y) {
        const lie::State before = x;
        read(t, y, x);
        model.accepted(before, x);
        stage.discrete_state = x.discrete_state, stage.internal_state = x.internal_state;
    };

    lie::Trajectory run;
    Eigen::VectorXd y(size * model.bodies());
    double t = x.t;
    for (const double instant : instants) {
        if (!(instant >= t))
            lie::reject("reference::index1",
                        "the instants must ascend and must not precede the start; instant after t = " +
                            std::to_string(t),
                        instant);
        write(x, y);
        ode.advance(t, y, instant, accepted);
        lie::project_positions(model, K, x);
        lie::project_velocities(model, K, x);
        lie::solve_accelerations(model, K, x);
        run.row.push_back(x);
    }
    return run;
}

}  // namespace hilda::reference
