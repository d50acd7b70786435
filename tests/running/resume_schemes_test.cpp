// SPDX-License-Identifier: GPL-3.0-or-later
/// A checkpoint contains all data that a scheme needs to continue with the same digits.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "run/recording/checkpoint.hpp"
#include "run/recording/pivot_node.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/bristle.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

namespace {

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return a.size() == b.size() && a == b; }

bool same(const lie::State& a, const lie::State& b)
{
    bool all = a.t == b.t && same(a.alpha, b.alpha) && same(a.lambda, b.lambda) &&
               a.discrete_state == b.discrete_state && a.internal_state == b.internal_state &&
               same(a.history, b.history);
    for (size_t k = 0; k < a.body.size(); ++k) {
        const lie::Motion &x = a.body[k], &y = b.body[k];
        all = all && x.r == y.r && x.rdot == y.rdot && x.rddot == y.rddot && x.A == y.A &&
              x.omega_bar == y.omega_bar && x.omegadot_bar == y.omegadot_bar;
    }
    return all;
}

}  // namespace

TEST_CASE("each scheme with adaptive steps continues from a checkpoint with the same digits", "[run][resume]")
{
    const std::string name = GENERATE("slider_crank", "n_pendulum_2_spin", "andrews_squeezer");
    const auto solver = GENERATE(lie::LinearSolver::klu, lie::LinearSolver::condensed);
    dae::Description d = dae::read_model(studies::problem(name).model, name);
    dae::start(d);
    for (const lie::Scheme& listed : lie::schemes()) {
        const lie::Scheme& scheme = listed.with_adaptive_steps();
        if (!scheme.adaptive || !scheme.resumes || !scheme.takes(*d.model)) continue;
        const lie::Settings settings{.linear_solver = solver, .rtol = 1e-8};
        const double h = name == "andrews_squeezer" ? 6e-4 : 2e-2;
        constexpr long half = 25;
        const auto integrator = scheme.make(*d.model, settings);
        lie::March whole(d.x, *integrator, h);
        run::PivotNode pivots(*integrator);
        lie::Observer* observers[] = {&pivots};
        while (whole.number() < half) whole.advance(observers);
        run::Checkpoint written;
        written.node = whole.node();
        written.number = whole.number();
        written.pivots = pivots.node;
        while (whole.number() < 2 * half) whole.advance(observers);

        const run::Checkpoint read = run::from_bytes(run::to_bytes(written), "checkpoint");
        const auto fresh = scheme.make(*d.model, settings);
        run::PivotNode restored(*fresh);
        restored.restore(read.pivots, h);
        lie::March resumed(read.node, *fresh, h, read.number);
        while (resumed.number() < 2 * half) resumed.advance({});
        INFO(scheme.name << " on " << name);
        CHECK(same(resumed.node(), whole.node()));
    }
}

// The driver of the slider-crank passes two singular points in half a revolution, so that the integrator
// chooses new pivots during the run.
TEST_CASE("each scheme continues from a checkpoint with the same digits", "[run][resume]")
{
    const std::string name = GENERATE("slider_crank", "n_pendulum_2_spin", "edge_mill", "ball_in_bowl_xy",
                                      "ball_in_bowl", "rattleback", "braked_ball_in_bowl");
    // Implicit friction: the pivots and scales of KLU depend on the compliance of the regularised rows.
    const std::vector<std::string> implicit = {
        R"(/contacts/0/friction={"law": "implicit", "mu_s": 0.25, "mu_k": 0.2, "K_E": 1e4, "D_slide": 100})"};
    const bool regularised = name == "braked_ball_in_bowl";
    const auto described = [&](bool has_bristles) {
        dae::Description d = dae::read_model(studies::problem(name).model, name,
                                             regularised ? implicit : std::vector<std::string>());
        const int last = d.model->bodies() - 1;
        if (has_bristles) d.model->load(tests::Bristle(dae::ground, last, 0.5, 10));
        if (has_bristles && last > 0) d.model->load(tests::Bristle(0, last, 2, 1e-4));
        dae::start(d);
        return d;
    };
    dae::Description with_bristles = described(true), without = described(false);
    for (const lie::Scheme& scheme : lie::schemes()) {
        dae::Description& d = scheme.supports.contains(lie::Feature::history) ? with_bristles : without;
        if (scheme.adaptive) continue;
        const bool has_history = !d.x.internal_state.empty() && d.model->internal_states_are_history();
        if (&d == &without && has_history) continue;  // of a contact
        if (!d.model->general_constraints().empty() && !scheme.supports.contains(lie::Feature::nonholonomic))
            continue;
        if (!scheme.takes(*d.model)) continue;
        const lie::Settings settings{
            .linear_solver = regularised ? lie::LinearSolver::klu : lie::LinearSolver::automatic,
            .reparametrise = true};
        constexpr double h = 2e-3;
        constexpr long half = 150;
        const auto integrator = scheme.make(*d.model, settings);
        lie::March whole(d.x, *integrator, h);
        run::PivotNode pivots(*integrator);
        lie::Observer* observers[] = {&pivots};
        while (whole.number() < half) whole.advance(observers);
        run::Checkpoint written;
        written.node = whole.node();
        written.number = whole.number();
        written.iterations = whole.iterations_of_last_step();
        written.pivots = pivots.node;
        written.statistics = integrator->statistics();
        using Type = contact::ContactEvent::Type;
        written.contacts.events = {{Type::impact, 0.25, 0, 1.5}, {Type::fallback_active, 0.5, 2, 0}};
        written.contacts.node_forces = {{0.125, 3}, {0.25, -1}};
        while (whole.number() < 2 * half) whole.advance(observers);
        const lie::Statistics counted = integrator->statistics();

        const run::Checkpoint read = run::from_bytes(run::to_bytes(written), "checkpoint");
        CHECK(read.contacts.events == written.contacts.events);
        REQUIRE(read.contacts.node_forces.size() == 2);
        CHECK(read.contacts.node_forces[1].t == 0.25);
        CHECK(read.contacts.node_forces[1].F_N == -1);
        const auto fresh = scheme.make(*d.model, settings);
        run::PivotNode restored(*fresh);
        restored.restore(read.pivots, h);
        const lie::Statistics of_restoration = fresh->statistics();
        lie::March resumed(read.node, *fresh, h, read.number, read.iterations);
        while (resumed.number() < 2 * half) resumed.advance({});
        INFO(scheme.name << " on " << name);
        CHECK(same(resumed.node(), whole.node()));
        const lie::Statistics of_rest = fresh->statistics();
        CHECK(of_rest.iterations - of_restoration.iterations ==
              counted.iterations - read.statistics.iterations);
        CHECK(of_rest.factorizations - of_restoration.factorizations ==
              counted.factorizations - read.statistics.factorizations);
        CHECK(of_rest.refactorizations - of_restoration.refactorizations ==
              counted.refactorizations - read.statistics.refactorizations);
        if (&d == &without) continue;
        if (d.model->bodies() > 1) CHECK(read.node.internal_state != d.x.internal_state);

        // a changed internal state variable of a force changes the result
        lie::State changed = read.node;
        changed.internal_state[d.model->forces()[0]->first_internal_state + 1] += 1e-3;
        lie::March other(changed, *fresh, h, read.number, read.iterations);
        while (other.number() < 2 * half) other.advance({});
        CHECK(!same(other.node().lambda, whole.node().lambda));
    }
}
