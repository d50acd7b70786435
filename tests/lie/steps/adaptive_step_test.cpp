// SPDX-License-Identifier: GPL-3.0-or-later
/// Error control, dense output and continuation of the integrators that choose their steps.

#include "lie/steps/adaptive_step.hpp"
#include "lie/check.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/lie/one_body_state.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::State;
using lie::Vec3;
using tests::motion;
using tests::numbers;

namespace {

std::vector<const lie::Scheme*> adaptive_forms()
{
    std::vector<const lie::Scheme*> all;
    for (const lie::Scheme& s : lie::schemes())
        if (s.adaptive_form && !s.needs_tree) all.push_back(s.adaptive_form.get());
    return all;
}

/// Those with error control, and those that choose their steps in another way
std::vector<const lie::Scheme*> with_internal_steps()
{
    std::vector<const lie::Scheme*> all = adaptive_forms();
    for (const lie::Scheme& s : lie::schemes())
        if (s.adaptive && s.formulation == "rA") all.push_back(&s);
    return all;
}

std::vector<State> rows(const lie::Scheme& s, const lie::System& system, const State& start, double rtol,
                        double end, double interval)
{
    const auto integrator = s.make(system, {.rtol = rtol});
    return lie::march(start, *integrator, lie::TimeGrid::over(end, interval)).row;
}

/// The top with a load that is added to the gravity
class LoadedTop final : public lie::System {
public:
    using Load = double (*)(double t);
    explicit LoadedTop(Load load) : load(load) {}

    const lie::Mass& mass() const override { return top.mass(); }
    const lie::Rows& pattern() const override { return top.pattern(); }
    void loads(const State& x, lie::Loads& out) const override
    {
        top.loads(x, out);
        out.F[0].x() += load(x.t);
    }
    void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.phi(x, out); }
    void variation(const State& x, lie::Rows& out) const override { top.variation(x, out); }
    void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.nu(x, out); }
    void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.gamma(x, out); }

    const tests::SpinningTop top;

private:
    const Load load;
};

/// Gives access to one step and its continuous extension.
class OneStep final : public lie::RungeKuttaStep {
public:
    using ExplicitStep::ExplicitStep;
    /// The state at x.t + s h of a step of the length h
    State inside(const State& x, double s, double h)
    {
        State end = x_n = x;
        advance(end, h);
        State at = x;
        add_stages(at, h);
        at = x;
        interpolate(at, s, h);
        return at;
    }
};

}  // namespace

TEST_CASE("the error of an adaptive run is proportional to the tolerance", "[lie][adaptive]")
{
    const tests::SpinningTop top;
    const State start = top.start();
    const State exact = rows(lie::scheme("rA-dop853").with_adaptive_steps(), top, start, 1e-13, 1, 1).back();
    for (const lie::Scheme* s : adaptive_forms()) {
        const auto error = [&](double rtol) {
            return (numbers(rows(*s, top, start, rtol, 1, 1).back()) - numbers(exact)).norm();
        };
        const double coarse = error(1e-6), fine = error(1e-9);
        INFO(s->name << ": " << coarse << ", " << fine);
        CHECK(coarse / fine > 200);
        CHECK(coarse / fine < 20000);
        CHECK(fine < 1e-6);
    }
}

TEST_CASE("output instants do not change the internal steps", "[lie][adaptive]")
{
    const tests::SpinningTop top;
    const State start = top.start();
    for (const lie::Scheme* s : with_internal_steps()) {
        const auto seldom = s->make(top, {.rtol = 1e-8}), often = s->make(top, {.rtol = 1e-8});
        const State a = lie::march(start, *seldom, lie::TimeGrid::over(1, 1)).row.back(),
                    b = lie::march(start, *often, lie::TimeGrid::over(1, 1. / 256)).row.back();
        INFO(s->name);
        CHECK(seldom->statistics().steps == often->statistics().steps);
        CHECK(numbers(a) == numbers(b));
    }
}

TEST_CASE("the continuous extension has its order on the group", "[lie][adaptive][order]")
{
    const tests::SpinningTop top;
    const State start = top.start();
    const auto error = [&](const lie::Tableau& tableau, double length) {
        OneStep step(top, {.tolerance = 1e-14}, tableau);
        const double s = 0.37;
        const State exact = rows(lie::scheme("rA-dop853"), top, start, 0, s * length, s * length / 8).back();
        return (motion(step.inside(start, s, length)) - motion(exact)).norm();
    };
    for (const auto& [tableau, order, h] :
         {std::tuple(&lie::dormand_prince_5(), 4, 1e-2), {&lie::dop853(), 7, 4e-2}}) {
        const double coarse = error(*tableau, h), fine = error(*tableau, h / 2),
                     measured = std::log2(coarse / fine);
        INFO(tableau->name << ": " << measured << ", errors " << coarse << ' ' << fine);
        CHECK(measured == Approx(order + 1).margin(0.5));  // of the local error
    }
}

TEST_CASE("constraints are satisfied at every output instant", "[lie][adaptive][invariants]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme* s : adaptive_forms())
        for (const State& x : rows(*s, top, top.start(), 1e-3, 2, 0.01)) {
            const lie::Motion& body = x.body[0];
            INFO(s->name << " at " << x.t);
            CHECK((body.r + body.A * top.s_bar).norm() < 1e-12);
            CHECK((body.rdot + body.A * body.omega_bar.cross(top.s_bar)).norm() < 1e-13);
            CHECK(lie::orthogonality_error(body.A) < 1e-14);
        }
}

TEST_CASE("a run continues from each of its nodes with the same digits", "[lie][adaptive][resume]")
{
    const tests::SpinningTop top;
    for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed})
        for (const lie::Scheme* s : with_internal_steps()) {
            const lie::Settings settings{.linear_solver = solver, .rtol = 1e-7};
            const auto whole = s->make(top, settings);
            State x = top.start();
            std::vector<State> nodes = {x};
            for (int n = 0; n < 12; ++n) whole->step(x, 0.03), nodes.push_back(x);
            for (size_t n = 0; n < 12; ++n) {
                State y = nodes[n];
                const auto resumed = s->make(top, settings);
                if (whole->pivots() != nullptr && !whole->pivots()->body.empty())
                    resumed->choose_pivots(*whole->pivots(), 0.03);
                while (y.t < x.t - 0.01) resumed->step(y, 0.03);
                INFO(s->name << " from node " << n);
                CHECK(numbers(y) == numbers(x));
                CHECK(y.history == x.history);
            }
        }
}

TEST_CASE("a rejected step has no effect on the digits", "[lie][adaptive]")
{
    // State::history begins with: start, end and length of the last internal step, length of the next one
    constexpr Eigen::Index length = 2, next = 3;
    const tests::SpinningTop top;
    for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed})
        for (const lie::Scheme* s : adaptive_forms()) {
            const lie::Settings settings{.linear_solver = solver, .rtol = 1e-8};
            State node = top.start();
            s->make(top, settings)->step(node, 0.1);
            const double h = node.history[next];
            State rejected = node;
            rejected.history[next] = 0.3;
            const auto first = s->make(top, settings);
            const double interval = 0.1 * h + (node.history[1] - node.t);  // one internal step
            first->step(rejected, interval);
            const double accepted = rejected.history[length];
            CHECK(accepted < 0.1);
            State direct = node;
            direct.history[next] = accepted;
            const auto second = s->make(top, settings);
            second->step(direct, interval);
            INFO(s->name << ": " << accepted << " in the place of 0.3");
            CHECK(first->statistics().refactorizations > second->statistics().refactorizations);
            CHECK(numbers(direct) == numbers(rejected));
            CHECK(direct.history == rejected.history);
        }
}

TEST_CASE("an adaptive step does not allocate memory", "[lie][adaptive][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    const tests::SpinningTop top;
    for (const lie::Scheme* s : with_internal_steps()) {
        const auto integrator = s->make(top, {.rtol = 1e-9});
        State x = top.start();
        for (int n = 0; n < 3; ++n) integrator->step(x, 0.02);
        const long steps = integrator->statistics().steps;
        const long taken = tests::allocations_during([&] {
            for (int n = 0; n < 50; ++n) integrator->step(x, 0.02);
        });
        INFO(s->name);
        CHECK(integrator->statistics().steps > steps + 10);
        CHECK(taken == 0);
    }
}

TEST_CASE("a tolerance that cannot be reached ends with the step and the error", "[lie][adaptive]")
{
    // A load that differs in each evaluation
    static long evaluations = 0;
    const LoadedTop noisy([](double) { return 1e6 * static_cast<double>(++evaluations % 7 - 3); });
    const LoadedTop ends([](double t) { return t < 0.45 ? 0 : std::nan(""); });
    for (const lie::Scheme* s : adaptive_forms()) {
        State x = noisy.top.start();
        const State before = x;
        try {
            s->make(noisy, {.rtol = 1e-14})->step(x, 0.1);
            CHECK(false);
        } catch (const lie::NumericalFailure& failure) {
            CHECK(failure.status == "step_too_small");
            CHECK_THAT(failure.what(), Catch::StartsWith(s->name + " at t = 0 s: a step of ") &&
                                           Catch::Contains("error estimate of") &&
                                           Catch::Contains("rtol 1e-14, atol 1e-14"));
        }
        // With these loads Newton's method of an implicit scheme does not converge at all.
        if (s->loads != lie::LoadEvaluation::implicit)
            CHECK_THROWS_WITH(
                s->make(noisy, {.rtol = 1e-9})->step(x, 0.1),
                Catch::Contains("1000 steps cover less than 1e-06 of the distance of two nodes") &&
                    Catch::Contains("error estimate of"));
        CHECK(numbers(x) == numbers(before));
        CHECK(x.history.size() == 0);

        const auto integrator = s->make(ends, {.rtol = 1e-6});
        while (x.t < 0.3) integrator->step(x, 0.1);
        const State node = x;
        try {
            for (int n = 0; n < 3; ++n) integrator->step(x, 0.1);
            CHECK(false);
        } catch (const lie::NumericalFailure& failure) {
            CHECK(failure.status == "nonfinite");
            CHECK_THAT(failure.what(),
                       Catch::StartsWith(s->name + " at t = 0.45 s: a step of ") && Catch::Contains("fails"));
        }
        CHECK(x.t >= node.t);
        CHECK(x.t < 0.45);
        CHECK(x.history.size() == node.history.size());
    }
}

TEST_CASE("no body turns by more than 2 rad in an internal step", "[lie][adaptive]")
{
    // A rotation about the axis of the largest inertia is integrated without error, for any step.
    const tests::SpinningTop top(true);
    for (const lie::Scheme* s : adaptive_forms()) {
        State x = top.start();
        x.body[0].omega_bar = Vec3(0, 40, 0);
        x.body[0].omegadot_bar.setZero();
        const auto integrator = s->make(top, {.rtol = 1e-6});
        const lie::Mat3 A = x.body[0].A;
        integrator->step(x, 10);
        INFO(s->name);
        CHECK(integrator->statistics().steps >= 200);
        CHECK(integrator->statistics().steps < 220);
        CHECK((x.body[0].A - A * lie::exp(Vec3(0, 400, 0))).norm() < 1e-10);
    }
}

TEST_CASE("tolerances beyond their range are rejected", "[lie][adaptive]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme* s : with_internal_steps()) {
        for (const double rtol : {0., 9e-15, 0.11, std::nan("")})
            CHECK_THROWS_WITH(
                s->make(top, {.rtol = rtol}),
                Catch::StartsWith("integrator " + s->name + ": rtol must be from 1e-14 to 0.1"));
        CHECK_THROWS_WITH(s->make(top, {.rtol = 1e-6, .atol = 0.2}), Catch::Contains("atol must be"));
        CHECK_NOTHROW(s->make(top, {.rtol = 1e-14, .atol = 0.1}));
    }
}

TEST_CASE("an adaptive scheme refuses loads that depend on a history", "[lie][adaptive]")
{
    const tests::SpinningTop top;  // lie::System: internal states are histories unless stated otherwise
    for (const lie::Scheme* s : with_internal_steps()) {
        State x = top.start();
        x.internal_state = {0};
        CHECK_THROWS_WITH(s->make(top, {})->step(x, 0.1), Catch::Contains("do not support loads"));
    }
}
