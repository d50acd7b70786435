// SPDX-License-Identifier: GPL-3.0-or-later
/// Example of a scheme in one file: symplectic Euler with the accelerations of the saddle system.
///
/// The constraints are satisfied at acceleration level only. Positions and velocities drift from them by
/// O(h). The example shows the minimum that a scheme implements.

#include "io/option_values.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"

#include <cmath>

namespace hilda::lie {
namespace {

class DemoKick final : public Integrator {
public:
    DemoKick(const System& model, const Settings& settings)
        : model(model), damping(settings.of_scheme.at("--damping")), K(model), loads(model.bodies()),
          a(K.size())
    {}

    int step(State& x, double h) override
    {
        K.assemble(x);
        solve_accelerations(model, K, x, loads, a);
        const double decay = std::exp(-damping * h);
        for (int i = 0; i < model.bodies(); ++i) {
            Motion& body = x.body[i];
            body.rdot = decay * (body.rdot + h * body.rddot);
            body.omega_bar = decay * (body.omega_bar + h * body.omegadot_bar);
            body.r += h * body.rdot;
            body.A = orthonormalised(body.A * exp(h * body.omega_bar));
        }
        x.t += h;
        ++steps;
        return 1;
    }

    const System& system() const override { return model; }
    Statistics statistics() const override
    {
        return {steps, steps, K.factorizations(), K.refactorizations(), 0};
    }

private:
    const System& model;
    const double damping;  ///< [1/s]
    Saddle K;
    Loads loads;
    Eigen::VectorXd a;
    long steps = 0;
};

void check_damping(const std::string& option, const std::string& text)
{
    io::nonnegative_number(option, text);
}

const bool registered =
    register_scheme<DemoKick>({.name = "demo-kick",
                               .description = "symplectic Euler at acceleration level, an example",
                               .order = 1,
                               .order_lambda = 1,
                               .formulation = "rA",
                               .unknowns = "none",
                               .options = {{{.name = "--damping",
                                             .value = "D",
                                             .help = "rate at which demo-kick damps all velocities [1/s]; "
                                                     "default: 0",
                                             .check = check_damping,
                                             .scope = io::Scope::numerical},
                                            0}},
                               .source = "Fang (2022), Eqs. 2.9, 2.17",
                               .supports = {Feature::history}});

}  // namespace
}  // namespace hilda::lie
