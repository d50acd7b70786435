// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include "dae/forces/spring_damper.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace hilda;
using run::Outcome;
using run::Simulation;

namespace {

/// A mass of 1 kg on a spring of 1e6 N/m along x, stretched by 0.01 m: h ω = 1000 h
struct Oscillator {
    dae::Model model;
    lie::State x;

    Oscillator()
    {
        model.gravity.setZero();
        model.add({.name = "mass", .m = 1, .J_bar = lie::Mat3::Identity()});
        dae::SpringDamper spring(dae::ground, lie::Vec3::Zero(), 0, lie::Vec3::Zero(), 1e6, 0, 1);
        spring.name = "spring";
        model.load(spring);
        x.body.resize(1);
        x.body[0].r = {1.01, 0, 0};
        dae::start(model, x);
    }
};

/// The numbers of the nodes in the order in which an observer receives them. Fails at one of them.
class Nodes final : public lie::Observer {
public:
    explicit Nodes(long fails_at = -1) : fails_at(fails_at) {}
    void accepted(const lie::State& x, long n, int /*iterations*/) override
    {
        number.push_back(n);
        t = x.t;
        if (n == fails_at) throw lie::NodeFailure("planned", "the test asked for it");
    }
    std::vector<long> number;
    double t = 0;

private:
    const long fails_at;
};

class StopAt final : public run::StepLoop {
public:
    StopAt(long at, Next how) : at(at), how(how) {}
    Next before_step(lie::March& march) override { return march.number() == at ? how : Next::step; }
    void before_finish(const lie::March& march) override { finished_at = march.number(); }
    long finished_at = -1;

private:
    const long at;
    const Next how;
};

}  // namespace

TEST_CASE("a simulation from C++ refuses a step above the stability limit of a spring", "[run][simulation]")
{
    const Oscillator of;
    const auto at = [&](double h, bool accept) {
        return Simulation({.model = of.model,
                           .start = of.x,
                           .scheme = lie::scheme("rA-half-1-momentum"),
                           .grid = lie::TimeGrid::over(1, h),
                           .accept_unstable = accept})
            .run();
    };
    CHECK_THROWS_AS(at(2.02e-3, false), io::UsageError);
    CHECK(at(1e-4, false).status == "ok");
    Simulation accepted({.model = of.model,
                         .start = of.x,
                         .scheme = lie::scheme("rA-half-1-momentum"),
                         .grid = lie::TimeGrid::over(1, 2.02e-3),
                         .accept_unstable = true});
    REQUIRE(accepted.warnings().size() == 1);
    CHECK(accepted.warnings()[0].name == "unstable_step");
    CHECK(accepted.warnings()[0].text.find("'spring'") != std::string::npos);
    // lie::march() takes it from 50 J to more than 1e8 J without a warning.
    const Outcome outcome = accepted.run();
    CHECK(outcome.failed());
}

TEST_CASE("a simulation gives the nodes of lie::march, and counts its steps", "[run][simulation]")
{
    const Oscillator of;
    const lie::Scheme& scheme = lie::scheme("rA-half-1-kick");
    const lie::TimeGrid grid = lie::TimeGrid::over(0.1, 1e-4, 1e-2);
    Simulation simulation({.model = of.model, .start = of.x, .scheme = scheme, .grid = grid});
    lie::TrajectoryRecorder rows(simulation.grid());
    simulation.observe(rows);
    const Outcome outcome = simulation.run();
    CHECK(outcome.status == "ok");
    CHECK(outcome.statistics.steps == 1000);
    CHECK(outcome.t == Approx(0.1).epsilon(1e-14));
    const auto integrator = scheme.make(of.model, {});
    const lie::Trajectory marched = lie::march(of.x, *integrator, grid);
    REQUIRE(rows.trajectory.row.size() == marched.row.size());
    for (size_t k = 0; k < marched.row.size(); ++k)
        CHECK(rows.trajectory.row[k].body[0].r == marched.row[k].body[0].r);
    // x = 1 + 0.01 cos(1000 t); leapfrog: the phase error is (h ω)²/24 of the phase
    CHECK(std::abs(simulation.state().body[0].r.x() - 1 - 0.01 * std::cos(100.)) <
          0.01 * 100 * 1e-2 / 24 * 1.1);
}

TEST_CASE("a simulation ends by its caller, at a node or between two nodes", "[run][simulation]")
{
    using Next = run::StepLoop::Next;
    const Oscillator of;
    for (const auto& [how, status, last] :
         {std::tuple{Next::stop, "stopped", 5L}, {Next::interrupt, "interrupted", 4L}}) {
        Simulation simulation({.model = of.model,
                               .start = of.x,
                               .scheme = lie::scheme("rA-half-1-kick"),
                               .grid = lie::TimeGrid::over(0.1, 1e-4)});
        Nodes nodes;
        simulation.observe(nodes);
        StopAt loop(5, how);
        const Outcome outcome = simulation.run(&loop);
        CAPTURE(status);
        CHECK(outcome.status == status);
        CHECK_FALSE(outcome.failed());
        CHECK(nodes.number.back() == last);
        CHECK(outcome.t == Approx(5e-4));
        CHECK(loop.finished_at == -1);  // not the last node of the grid
    }
}

TEST_CASE("a failure has its time, its scheme and its cause, and each node is passed once",
          "[run][simulation]")
{
    const Oscillator of;
    Simulation simulation({.model = of.model,
                           .start = of.x,
                           .scheme = lie::scheme("rA-half-1-kick"),
                           .grid = lie::TimeGrid::over(0.1, 1e-4)});
    Nodes before, failing(7), behind;
    simulation.observe(before);
    simulation.observe_checked(failing);
    simulation.observe_checked(behind);
    const Outcome outcome = simulation.run();
    CHECK(outcome.status == "planned");
    CHECK(outcome.cause == "the test asked for it");
    CHECK(outcome.message.find("the test asked for it") != std::string::npos);
    CHECK(outcome.message.find("rA-half-1-kick") != std::string::npos);
    CHECK(before.number == std::vector<long>{0, 1, 2, 3, 4, 5, 6, 7});
    CHECK(behind.number.back() == 6);

    // A step that fails: the node at its start is passed as well.
    Simulation turning({.model = of.model,
                        .start =
                            [&] {
                                lie::State x = of.x;
                                x.body[0].omega_bar = {0, 0, 40};
                                return x;
                            }(),
                        .scheme = lie::scheme("rA-half-1-kick"),
                        .grid = lie::TimeGrid::over(1, 0.1),
                        .accept_unstable = true});
    Nodes nodes;
    turning.observe(nodes);
    const Outcome half_turn = turning.run();
    CHECK(half_turn.status == "step_too_large");
    CHECK(nodes.number == std::vector<long>{0});
}

TEST_CASE("steps and a run give the nodes of a run, each once, and a second run gives the same outcome",
          "[run][simulation]")
{
    const Oscillator of;
    const auto setup = [&] {
        return run::SimulationSetup{.model = of.model,
                                    .start = of.x,
                                    .scheme = lie::scheme("rA-half-1-kick"),
                                    .grid = lie::TimeGrid::over(1e-3, 1e-4)};
    };
    Simulation whole(setup()), in_steps(setup());
    Nodes of_whole, of_steps;
    whole.observe(of_whole);
    in_steps.observe(of_steps);
    CHECK(whole.run().status == "ok");
    while (in_steps.step()) {
    }
    CHECK(in_steps.number() == 10);
    CHECK(of_steps.number.back() == 9);
    CHECK(in_steps.run().status == "ok");
    CHECK(of_steps.number == of_whole.number);
    CHECK(in_steps.state().body[0].r == whole.state().body[0].r);
    CHECK(whole.outcome().statistics.steps == 10);
    CHECK(whole.run().statistics.steps == 10);
    CHECK_FALSE(whole.step());
    CHECK(of_whole.number == std::vector<long>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10});

    // An interrupted run continues; a run that was stopped does not.
    using Next = run::StepLoop::Next;
    Simulation interrupted(setup()), stopped(setup());
    Nodes of_interrupted, of_stopped;
    interrupted.observe(of_interrupted);
    stopped.observe(of_stopped);
    StopAt interrupt(5, Next::interrupt), stop(5, Next::stop);
    CHECK(interrupted.run(&interrupt).status == "interrupted");
    CHECK(interrupted.run().status == "ok");
    CHECK(of_interrupted.number == of_whole.number);
    CHECK(interrupted.state().body[0].r == whole.state().body[0].r);
    CHECK(stopped.run(&stop).status == "stopped");
    CHECK(stopped.run().status == "stopped");
    CHECK(of_stopped.number == std::vector<long>{0, 1, 2, 3, 4, 5});
}

TEST_CASE("an exception that is no failure of the simulation is thrown on, with the outcome so far",
          "[run][simulation]")
{
    struct Full final : lie::Observer {
        void accepted(const lie::State& /*x*/, long n, int /*iterations*/) override
        {
            if (n == 3) throw io::IoError("the disk is full");
        }
    } full;
    const Oscillator of;
    Simulation simulation({.model = of.model,
                           .start = of.x,
                           .scheme = lie::scheme("rA-half-1-kick"),
                           .grid = lie::TimeGrid::over(1e-3, 1e-4)});
    simulation.observe(full);
    CHECK_THROWS_AS(simulation.run(), io::IoError);
    CHECK_FALSE(simulation.outcome().failed());
    CHECK(simulation.outcome().t == Approx(3e-4));
}
