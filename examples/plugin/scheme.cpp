// SPDX-License-Identifier: GPL-3.0-or-later
/// my-scheme: Heun's method on the index-1 equations, with projection. A starting point for your own
/// integrator.
///
///     r_{n+1} = r_n + h ṙ_n + h²/2 r̈_n,        A_{n+1} = A_n exp(h ω̄_n + h²/2 ω̄̇_n),      then Φ = 0 by projection
///     v_{n+1} = v_n + h/2 (v̇_n + v̇*),          v = (ṙ, ω̄), v̇* at the predicted state,     then Φ̇ = 0 by projection
///
/// v̇ and λ are the solution of the saddle system K (v̇, λ) = (F, τ̄, γ). The method is of second order.

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

namespace {

using namespace hilda::lie;

class MyScheme final : public Integrator {
public:
    MyScheme(const System& model, const Settings&)
        : model(model), K(model), loads(model.bodies()), solution(K.size())
    {}

    /// Advances x from t_n to t_n + h and returns the number of iterations. If it throws, x is still the
    /// state of t_n.
    int step(State& x, double h) override
    {
        next = x;  // v̇_n is known: the start and each step compute it
        for (Motion& body : next.body) {
            body.r += h * body.rdot + h * h / 2 * body.rddot;
            body.A = orthonormalised(body.A * exp(h * body.omega_bar + h * h / 2 * body.omegadot_bar));
            body.rdot += h * body.rddot;
            body.omega_bar += h * body.omegadot_bar;
        }
        next.t += h;
        set_accelerations(next);
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& from = x.body[i];
            Motion& body = next.body[i];
            body.rdot = from.rdot + h / 2 * (from.rddot + body.rddot);
            body.omega_bar = from.omega_bar + h / 2 * (from.omegadot_bar + body.omegadot_bar);
        }
        const int iterations = project_positions(model, K, next);
        project_velocities(model, K, next);
        set_accelerations(next);
        x = next;
        ++steps, total += iterations;
        return iterations;
    }

    const System& system() const override { return model; }
    Statistics statistics() const override
    {
        return {steps, total, K.factorizations(), K.refactorizations(), 0};
    }

private:
    const System& model;
    Saddle K;
    Loads loads;
    Eigen::VectorXd solution;
    State next;
    long steps = 0, total = 0;

    /// v̇ and λ of a state
    void set_accelerations(State& x)
    {
        K.assemble(x);
        solve_accelerations(model, K, x, loads, solution);
    }
};

const bool registered =
    register_scheme<MyScheme>({.name = "my-scheme",
                               .description = "Heun's method on the index-1 equations, projected",
                               .order = 2,
                               .order_lambda = 2,
                               .formulation = "rA",
                               .unknowns = "none; projection",
                               .source = "Heun (1900), with projection",
                               .supports = {Feature::history}});

}  // namespace
