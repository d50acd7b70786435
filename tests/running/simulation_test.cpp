// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include "dae/forces/spring_damper.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "run/tables/run_table.hpp"
#include "studies/framework/problem.hpp"

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

/// At the node with this number
std::function<Simulation::Next()> next_at(const Simulation& simulation, long number, Simulation::Next what)
{
    return
        [&simulation, number, what] { return simulation.number() == number ? what : Simulation::Next::step; };
}

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
    using Next = Simulation::Next;
    const Oscillator of;
    for (const auto& [how, status, last] :
         {std::tuple{Next::stop, "stopped", 5L}, {Next::interrupt, "interrupted", 4L}}) {
        Simulation simulation({.model = of.model,
                               .start = of.x,
                               .scheme = lie::scheme("rA-half-1-kick"),
                               .grid = lie::TimeGrid::over(0.1, 1e-4)});
        Nodes nodes;
        simulation.observe(nodes);
        const Outcome outcome = simulation.run(next_at(simulation, 5, how));
        CAPTURE(status);
        CHECK(outcome.status == status);
        CHECK_FALSE(outcome.failed());
        CHECK(nodes.number.back() == last);
        CHECK(outcome.t == Approx(5e-4));
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
    using Next = Simulation::Next;
    Simulation interrupted(setup()), stopped(setup());
    Nodes of_interrupted, of_stopped;
    interrupted.observe(of_interrupted);
    stopped.observe(of_stopped);
    const auto stop = next_at(stopped, 5, Next::stop);
    CHECK(interrupted.run(next_at(interrupted, 5, Next::interrupt)).status == "interrupted");
    CHECK(interrupted.run().status == "ok");
    CHECK(of_interrupted.number == of_whole.number);
    CHECK(interrupted.state().body[0].r == whole.state().body[0].r);
    CHECK(stopped.run(stop).status == "stopped");
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

namespace {

/// The table of events in memory
class Tables final : public run::RunTables {
public:
    std::unique_ptr<run::RunTable> table(const std::string& name,
                                         std::vector<run::TableColumn> columns) override
    {
        CHECK(name == "events");
        CHECK(columns.size() > 3);
        return std::make_unique<Table>(times);
    }
    std::vector<double> times;  ///< of the rows [s]

private:
    class Table final : public run::RunTable {
    public:
        explicit Table(std::vector<double>& times) : times(times) {}
        void open() override {}
        void row(const std::vector<double>& values) override { times.push_back(values[0]); }
        void sync() override {}
        void transfer(io::Archive& a) override { a.list(times); }
        void close() override {}
        std::vector<std::string> files() const override { return {}; }
        std::string label() const override { return "events"; }

    private:
        std::vector<double>& times;
    };
};

/// A ball that is thrown upwards with 8 m/s at g = 10 m/s², with events at the top and 2.25 m below the start
dae::Description thrown_ball()
{
    dae::Description d =
        dae::read_model(R"({"hilda_model": 1, "name": "ball", "gravity": [0, 0, -10], "end": 2,
  "bodies": [{"name": "ball", "mass": 2, "inertia": [1, 2, 3], "r": [0, 0, 0], "r_dot": [1, 0, 8], "omega": [0, 1, 3]}],
  "events": [{"name": "top", "value": "ball.vz"},
             {"name": "ground", "value": "ball.rz + 2.25", "direction": "falling", "action": "stop"}]})",
                        "ball.json");
    dae::start(d);
    return d;
}

bool equal_states(const lie::State& a, const lie::State& b)
{
    bool all = a.t == b.t && a.alpha == b.alpha && a.lambda == b.lambda &&
               a.discrete_state == b.discrete_state && a.internal_state == b.internal_state &&
               a.applied_loads == b.applied_loads;
    for (size_t k = 0; k < a.body.size(); ++k) {
        const lie::Motion &x = a.body[k], &y = b.body[k];
        all = all && x.r == y.r && x.rdot == y.rdot && x.rddot == y.rddot && x.A == y.A &&
              x.omega_bar == y.omega_bar && x.omegadot_bar == y.omegadot_bar;
    }
    return all;
}

lie::Loads load(int bodies, const lie::Vec3& F, const lie::Vec3& n_bar)
{
    lie::Loads all(bodies);
    all.F.back() = F, all.n_bar.back() = n_bar;
    return all;
}

}  // namespace

TEST_CASE("an event with the action stop ends a simulation, whether it runs or is stepped",
          "[run][simulation]")
{
    const dae::Description ball = thrown_ball();
    const double end = 0.8 + std::sqrt(0.64 + 0.45);
    for (const bool in_steps : {false, true}) {
        Tables tables;
        Simulation simulation({.model = *ball.model,
                               .start = ball.x,
                               .scheme = lie::scheme("rA-rkmk-4"),
                               .grid = lie::TimeGrid::over(2, 0.03),
                               .description = &ball,
                               .event_table = &tables});
        Nodes nodes;
        simulation.observe(nodes);
        if (in_steps)
            while (simulation.step()) {
            }
        const Outcome& outcome = simulation.run();
        CAPTURE(in_steps);
        CHECK(outcome.status == "stopped");
        CHECK(outcome.stopped_by == "ground");
        CHECK(simulation.has_ended());
        CHECK(outcome.t == Approx(end).epsilon(1e-12));
        CHECK(simulation.state().t == outcome.t);
        CHECK(simulation.state().body[0].r.z() == Approx(-2.25).epsilon(1e-12));
        CHECK(nodes.t == outcome.t);  // the event is the last node that the observers receive
        REQUIRE(tables.times.size() == 2);
        CHECK(tables.times[0] == Approx(0.8).epsilon(1e-12));
        CHECK_FALSE(simulation.step());
        CHECK_THROWS_AS(simulation.set_loads(lie::Loads(1)), io::UsageError);
    }
}

TEST_CASE("a simulation that continues from a record has the digits, counters and events of a whole one",
          "[run][simulation]")
{
    const dae::Description ball = thrown_ball();
    const auto name =
        GENERATE(as<std::string>(), "rA-half-1-momentum", "rA-rkmk-4", "rA-genalpha", "rA-dop853");
    const lie::Scheme& scheme =
        name == "rA-dop853" ? lie::scheme(name).with_adaptive_steps() : lie::scheme(name);
    CAPTURE(name);
    const auto made = [&](Tables& tables) {
        return std::make_unique<Simulation>(run::SimulationSetup{.model = *ball.model,
                                                                 .start = ball.x,
                                                                 .scheme = scheme,
                                                                 .grid = lie::TimeGrid::over(1.6, 0.02),
                                                                 .description = &ball,
                                                                 .event_table = &tables});
    };
    // A force and a torque from 0.4 s to 0.6 s
    const auto step = [](Simulation& simulation) {
        if (simulation.number() == 20) simulation.set_loads(load(1, {4, 0, 1}, {0, 0.5, 0}));
        if (simulation.number() == 30) simulation.set_loads(lie::Loads(1));
        REQUIRE(simulation.step());
    };
    Tables of_whole, of_first, of_second;
    const auto whole = made(of_whole), first = made(of_first), second = made(of_second);
    while (whole->number() < 70) step(*whole);
    while (first->number() < 25) step(*first);
    io::Archive written;
    first->transfer(written);
    const std::string bytes = written.bytes();
    io::Archive read(bytes, "record");
    second->transfer(read);
    read.end();
    CHECK(equal_states(second->state(), first->state()));
    CHECK(second->state().applied_loads.size() == 6);
    while (second->number() < 70) step(*second);
    CHECK(equal_states(second->state(), whole->state()));
    CHECK(second->statistics().iterations == whole->statistics().iterations);
    CHECK(second->statistics().steps == whole->statistics().steps);
    CHECK(of_second.times == of_whole.times);
    CHECK(of_whole.times.size() == 1);
    CHECK(second->run().statistics.factorizations == whole->run().statistics.factorizations);
    CHECK(second->outcome().statistics.steps == whole->outcome().statistics.steps);

    io::Archive of_another(bytes, "record");
    dae::Model two;
    two.gravity.setZero();
    for (int b = 0; b < 2; ++b)
        two.add({.name = "mass " + std::to_string(b), .m = 1, .J_bar = lie::Mat3::Identity()});
    lie::State x;
    x.body.resize(2);
    dae::start(two, x);
    Simulation other({.model = two, .start = x, .scheme = scheme, .grid = lie::TimeGrid::over(1.6, 0.02)});
    CHECK_THROWS_AS(other.transfer(of_another), io::IoError);
}

TEST_CASE("a watch that records changes neither the nodes nor the end of a run", "[run][simulation]")
{
    // h ω is 2.02: the energy of leapfrog grows without bound. A watch that stops ends the run.
    const Oscillator of;
    const lie::Scheme& scheme = lie::scheme("rA-half-1-momentum");
    const auto grid = lie::TimeGrid::over(0.202, 2.02e-3);
    const auto made = [&](run::Watch::Action action) {
        return std::make_unique<Simulation>(run::SimulationSetup{.model = of.model,
                                                                 .start = of.x,
                                                                 .scheme = scheme,
                                                                 .grid = grid,
                                                                 .watch = action,
                                                                 .accept_unstable = true});
    };
    const auto stopping = made(run::Watch::Action::stop), recording = made(run::Watch::Action::record);
    CHECK(stopping->run().status == "energy_created");
    Nodes nodes;
    recording->observe(nodes);
    CHECK(recording->run().status == "ok");
    REQUIRE(nodes.number.size() == static_cast<size_t>(grid.steps + 1));
    std::vector<std::string> names;
    for (const run::Finding& found : recording->findings()) names.push_back(found.name);
    CHECK(names == std::vector<std::string>{"unstable_step", "energy_rises"});
    const auto integrator = scheme.make(of.model, {});
    const lie::Trajectory marched = lie::march(of.x, *integrator, grid);
    CHECK(recording->state().body[0].r == marched.row.back().body[0].r);
}

TEST_CASE("loads that are set at the start give the digits of a constant force of the model",
          "[run][simulation]")
{
    const lie::Vec3 F(30, 10, -200), n_bar(20, -10, 3);
    class Constant final : public dae::Force {
    public:
        Constant(const lie::Vec3& F, const lie::Vec3& n_bar) : F(F), n_bar(n_bar) { name = "constant"; }
        void add(const lie::State& /*x*/, lie::Loads& out) const override
        {
            out.F.back() += F, out.n_bar.back() += n_bar;
        }
        int last_body() const override { return 1; }

    private:
        const lie::Vec3 F, n_bar;
    };
    const auto read = [] {
        return dae::read_model(studies::problem("double_pendulum_moving").model, "double_pendulum_moving");
    };
    dae::Description with_force = read(), without = read();
    with_force.model->load(std::make_unique<Constant>(F, n_bar));
    dae::start(with_force), dae::start(without);
    int compared = 0;
    for (const lie::Scheme& listed : lie::schemes())
        for (const lie::Scheme* scheme : {&listed, &listed.with_adaptive_steps()}) {
            if (!scheme->takes(*without.model)) continue;
            CAPTURE(scheme->name, scheme->adaptive);
            const auto made = [&](const dae::Description& d) {
                return std::make_unique<Simulation>(
                    run::SimulationSetup{.model = *d.model,
                                         .start = d.x,
                                         .scheme = *scheme,
                                         .grid = lie::TimeGrid::over(0.1, 2e-3),
                                         .settings = {.rtol = 1e-8}});
            };
            const auto set = made(without), of_model = made(with_force);
            if (!scheme->resumes) {
                CHECK_THROWS_AS(set->set_loads(load(2, F, n_bar)), io::UsageError);
                continue;
            }
            set->set_loads(load(2, F, n_bar));
            while (set->number() < 50) {
                REQUIRE(set->step());
                REQUIRE(of_model->step());
            }
            lie::State without_loads = set->state();
            without_loads.applied_loads.clear();
            CHECK(equal_states(without_loads, of_model->state()));
            CHECK(set->findings().empty());
            ++compared;
        }
    CHECK(compared > 20);
}

TEST_CASE("the additional step of complete_node gives what an observer receives, and changes nothing",
          "[run][simulation]")
{
    class Copy final : public lie::Observer {
    public:
        void accepted(const lie::State& x, long /*n*/, int /*iterations*/) override { node = x; }
        lie::State node;
    } last;
    const dae::Description ball = thrown_ball();
    const auto made = [&] {
        return std::make_unique<Simulation>(run::SimulationSetup{.model = *ball.model,
                                                                 .start = ball.x,
                                                                 .scheme = lie::scheme("rA-half-1-momentum"),
                                                                 .grid = lie::TimeGrid::over(1, 0.01)});
    };
    const auto asked = made(), other = made();
    asked->observe(last);
    for (int n = 0; n < 50; ++n) {
        const lie::State complete = asked->complete_node();
        REQUIRE(asked->step());
        REQUIRE(other->step());
        REQUIRE(equal_states(complete, last.node));
    }
    CHECK(equal_states(asked->state(), other->state()));
}

TEST_CASE("a step that fails is thrown with its time and scheme, and the simulation cannot continue",
          "[run][simulation]")
{
    const Oscillator of;
    Simulation simulation({.model = of.model,
                           .start = of.x,
                           .scheme = lie::scheme("rA-half-1-kick"),
                           .grid = lie::TimeGrid::over(0.1, 1e-4)});
    Nodes failing(7);
    simulation.observe_checked(failing);
    while (simulation.number() < 7) REQUIRE(simulation.step());
    CHECK_THROWS_WITH(simulation.step(), Catch::Contains("0.0007") && Catch::Contains("rA-half-1-kick") &&
                                             Catch::Contains("the test asked for it"));
    CHECK(simulation.outcome().status == "planned");
    CHECK(simulation.number() == 7);
    CHECK_THROWS_WITH(simulation.step(),
                      Catch::Contains("the simulation has failed at t = 0.0007 s (planned)"));
    CHECK(simulation.run().status == "planned");
}
