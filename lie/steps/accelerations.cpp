// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/accelerations.hpp"

#include "lie/bounded_rows.hpp"
#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

namespace hilda::lie {

namespace {

// At a start there is no step. Regularised rows have the compliance of a step of this length, and friction
// opposes a sliding velocity as if to stop it within slip_decay_time [s].
constexpr double regularisation_step = 1, slip_decay_time = 1e-6;
// A slip below this value is counted as sticking [m/s].
constexpr double slow_slip = 1e-6;

/// C v of the regularised rows
Eigen::VectorXd slip_velocities(const Rows& C, const State& x)
{
    Eigen::VectorXd slip = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(C.regularised.size()));
    for (Eigen::Index k = 0; k < slip.size(); ++k) {
        const int row = C.regularised[static_cast<size_t>(k)];
        for (int n = C.start[row]; n < C.start[row + 1]; ++n) {
            const Motion& body = x.body[C.entry[n].body];
            slip[k] += C.entry[n].r.dot(body.rdot) + C.entry[n].pi.dot(body.omega_bar);
        }
    }
    return slip;
}

/// Replaces γ of the regularised rows by γ - C v/τ. The relative acceleration is γ without sliding, and
/// opposes the sliding velocity otherwise.
void oppose_slip(const Rows& C, const Eigen::VectorXd& slip, Eigen::Ref<Eigen::VectorXd> gamma)
{
    for (Eigen::Index k = 0; k < slip.size(); ++k)
        gamma[C.regularised[static_cast<size_t>(k)]] -= slip[k] / slip_decay_time;
}

/// Sets r̈, ω̄̇ and λ of x from the solution a.
void set_accelerations(const Saddle& K, State& x, Eigen::VectorXd& a)
{
    for (size_t i = 0; i < x.body.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        x.body[i].rddot = a.segment<3>(at);
        x.body[i].omegadot_bar = a.segment<3>(at + 3);
    }
    x.lambda = K.constraint_part(a);
}

}  // namespace

void solve_accelerations(const System& system, Saddle& K, State& x)
{
    constexpr int max_iterations = 100;
    BoundedRows friction(system);
    friction.start(x, regularisation_step);
    K.assemble(x, friction.compliance());
    Loads loads(system.bodies());
    Eigen::VectorXd right_side(K.size()), a;
    set_load_terms(system, K, x, loads, right_side);
    const Eigen::VectorXd slip = slip_velocities(K.rows(), x);
    oppose_slip(K.rows(), slip, K.constraint_part(right_side));
    if (!right_side.allFinite())
        throw NonFinite("the accelerations at the start: a load or a constraint is not finite");
    const auto find = [&] {
        for (int k = 0; k <= max_iterations; ++k) {
            a = right_side;
            K.solve_refined(a);
            if (friction.within_bounds(K, a) && !friction.release_impossible(K, a, slip, slip_decay_time))
                return set_accelerations(K, x, a);
        }
        friction.fail(K, a);
    };
    try {
        find();
    } catch (const NumericalFailure&) {
        // The impulses that would stop the slip of several contacts at once may press their bodies together
        // or apart without limit. These contacts start without friction; the first step has it.
        if (!friction.release_slipping(K, slip, slow_slip)) throw;
        find();
    }
}

void solve_accelerations(const System& system, Saddle& K, State& x, Loads& loads, Eigen::VectorXd& b)
{
    set_load_terms(system, K, x, loads, b);
    K.solve_in_step(b);
    set_accelerations(K, x, b);
}

void set_load_terms(const System& system, const Saddle& K, const State& x, Loads& loads, Eigen::VectorXd& b)
{
    system.loads(x, loads);
    for (int i = 0; i < system.bodies(); ++i)
        b.segment<6>(6 * i) << loads.F[i], loads.tau_bar(i, system.mass().J_bar[i], x.body[i].omega_bar);
    K.algebraic_part(b).setZero();
    system.gamma(x, K.constraint_part(b));
}

}  // namespace hilda::lie
