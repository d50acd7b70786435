// SPDX-License-Identifier: GPL-3.0-or-later
/// Tests of all registered schemes on Euler parameters and Euler angles.

#include "lie/schemes.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

std::vector<const lie::Scheme*> classical()
{
    std::vector<const lie::Scheme*> all;
    for (const lie::Scheme& s : lie::schemes())
        if (!s.adaptive && (s.formulation == "rp" || s.formulation == "reps")) all.push_back(&s);
    return all;
}

lie::State at_end(const lie::Scheme& scheme, const lie::System& system, const lie::State& start, double h)
{
    const auto integrator = scheme.make(system, {.tolerance = 1e-13});
    return lie::march(start, *integrator, lie::TimeGrid::over(0.4, h, 0.4)).row.back();
}

/// Quantities with the declared order `order`: r, A, ṙ, ω̄
Eigen::VectorXd motion(const lie::State& x)
{
    Eigen::VectorXd q(18);
    const lie::Motion& body = x.body[0];
    q << body.r, Eigen::Map<const Eigen::VectorXd>(body.A.data(), 9), body.rdot, body.omega_bar;
    return q;
}

/// Accelerations that fill_node() computes; they have the order of λ
Eigen::VectorXd accelerations(const lie::State& x)
{
    Eigen::VectorXd q(6);
    q << x.body[0].rddot, x.body[0].omegadot_bar;
    return q;
}

double order(const Eigen::VectorXd& coarse, const Eigen::VectorXd& middle, const Eigen::VectorXd& fine)
{
    return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

}  // namespace

TEST_CASE("the schemes on Euler parameters and Euler angles are registered", "[reference][rp][reps]")
{
    for (const char* name : {"rp-full-1", "rp-bdf2", "rp-newmark", "rp-hht", "rp-half-1", "rp-half-1-kick",
                             "reps-half-1", "reps-half-1-kick"})
        CHECK(lie::scheme(name).name == name);
}

TEST_CASE("the declared order of schemes on classical coordinates is the measured order",
          "[reference][order]")
{
    const bool free = GENERATE(false, true);
    const tests::SpinningTop top(free);
    const lie::State start = top.start();
    for (const lie::Scheme* s : classical()) {
        const double h = 2e-4;
        const lie::State a = at_end(*s, top, start, 4 * h), b = at_end(*s, top, start, 2 * h),
                         c = at_end(*s, top, start, h);
        const double of_motion = order(motion(a), motion(b), motion(c)),
                     of_accelerations = order(accelerations(a), accelerations(b), accelerations(c));
        INFO(s->name << (free ? ", free, " : ", ") << "declares " << s->order << " and " << s->order_lambda
                     << " for lambda, shows " << of_motion << ", accelerations " << of_accelerations);
        CHECK(of_motion == Approx(s->order).margin(0.15));
        if (free) continue;
        const double of_lambda = order(a.lambda, b.lambda, c.lambda);
        INFO("lambda " << of_lambda);
        CHECK(of_lambda == Approx(s->order_lambda).margin(0.25));
        CHECK(of_accelerations == Approx(s->order_lambda).margin(0.25));
    }
}

TEST_CASE("a step on classical coordinates does not allocate memory", "[reference][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted under a sanitizer");
        return;
    }
    const tests::SpinningTop top;
    dae::Model mechanism;
    lie::State start;
    tests::slider_crank(mechanism, start);
    mechanism.load(dae::SpringDamper(0, Vec3(0.01, 0, 0), 2, Vec3(0, 0.02, 0), 10, 0.1, 0.05));
    dae::start(mechanism, start);
    for (const lie::Scheme* s : classical())
        for (const lie::System* system :
             {static_cast<const lie::System*>(&top), static_cast<const lie::System*>(&mechanism)}) {
            const auto integrator = s->make(*system, {.reparametrise = true});
            lie::State x = system == &top ? top.start() : start;
            for (int n = 0; n < 3; ++n) integrator->step(x, 1e-3);  // choose pivots and size the buffers
            const long taken = tests::allocations_during([&] {
                for (int n = 0; n < 100; ++n) integrator->step(x, 1e-3);
            });
            INFO(s->name);
            CHECK(taken == 0);
        }
}

TEST_CASE("a failed step on classical coordinates leaves the state unchanged", "[reference][newton]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme* s : classical()) {
        const auto good = s->make(top, {});
        const auto hopeless = s->make(top, {.tolerance = 1e-300, .max_iterations = 2});
        lie::State x = top.start();
        for (int n = 0; n < 2; ++n) {  // at the start and with a history
            const lie::State before = x;
            CHECK_THROWS_AS(hopeless->step(x, 1e-2), lie::NoConvergence);
            CHECK(x.t == before.t);
            CHECK(x.body[0].r == before.body[0].r);
            CHECK(x.body[0].A == before.body[0].A);
            CHECK(x.body[0].omega_bar == before.body[0].omega_bar);
            CHECK(x.lambda == before.lambda);
            CHECK(x.history.size() == before.history.size());
            CHECK((x.history - before.history).norm() == 0);
            good->step(x, 1e-2);
        }
    }
}

TEST_CASE("the history of a classical scheme is stored in the state", "[reference][schemes]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme* s : classical()) {
        const auto one = s->make(top, {.reparametrise = true}), other = s->make(top, {.reparametrise = true});
        lie::State x = top.start();
        for (int n = 0; n < 10; ++n) one->step(x, 1e-3);
        lie::State y = x;
        one->step(x, 1e-3);
        other->step(y, 1e-3);
        INFO(s->name);
        CHECK((motion(x) - motion(y)).norm() < 1e-14);  // pivots may differ
        CHECK((x.lambda - y.lambda).norm() < 1e-12 * x.lambda.norm());
    }
}

TEST_CASE("schemes on classical coordinates satisfy the constraints and keep A orthogonal",
          "[reference][invariants]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme* s : classical()) {
        const auto integrator = s->make(top, {.reparametrise = true});
        lie::State x = top.start();
        Eigen::VectorXd Phi(3);
        double phi = 0, orthogonality = 0, p = 0;
        for (int n = 0; n < 1000; ++n) {
            integrator->step(x, 1e-3);
            top.phi(x, Phi);
            phi = std::max(phi, Phi.norm());
            orthogonality = std::max(orthogonality, lie::orthogonality_error(x.body[0].A));
            if (s->formulation != "rp") continue;
            const int at = s->name.find("half") != std::string::npos ? 9 : 0;  // position of p in the history
            p = std::max(p, std::abs(x.history.segment<4>(at).norm() - 1));
        }
        INFO(s->name << " residual " << phi << ", orthogonality " << orthogonality << ", |p| - 1 " << p);
        CHECK(phi < 1e-12);
        CHECK(orthogonality < 1e-14);
        CHECK(p < 1e-14);
    }
}

TEST_CASE("rp-newmark and rp-hht take the spectral radii with a numerical damping of the multipliers",
          "[reference][rp]")
{
    const tests::SpinningTop top(false);
    struct Range {
        const char *name, *message;
        double least;
    };
    for (const Range& r : {Range{"rp-newmark", "rho_infinity must be from 0 to less than 1, got", 0},
                           Range{"rp-hht", "rho_infinity must be from 0.5 to less than 1, got", 0.5}}) {
        CAPTURE(r.name);
        for (const double rho : {r.least, 0.99})
            CHECK_NOTHROW(lie::scheme(r.name).make(top, {.rho_infinity = rho}));
        for (const double rho : {r.least - 0.1, 1., std::nan("")})
            CHECK_THROWS_WITH(lie::scheme(r.name).make(top, {.rho_infinity = rho}),
                              Catch::Matchers::Contains(r.message));
    }
}

TEST_CASE("the damping of rp-newmark and rp-hht at infinite frequency is that of rho_infinity",
          "[reference][rp]")
{
    // A spring of free length 0, which is linear, with ω h = 1000: the amplitude is ρⁿ times a polynomial of
    // degree 2 in n at most.
    const std::string name = GENERATE(std::string("rp-newmark"), std::string("rp-hht"));
    for (const double rho : {0.6, 0.8, 0.9}) {
        dae::Model model;
        model.gravity.setZero();
        lie::State x;
        x.body.resize(1);
        x.body[0].r = Vec3(1e-3, 0, 0);
        model.add({.name = "ball", .m = 1, .J_bar = lie::Mat3::Identity()});
        model.load(dae::SpringDamper(dae::ground, Vec3::Zero(), 0, Vec3::Zero(), 1e6, 0, 0));
        dae::start(model, x);
        const auto integrator = lie::scheme(name).make(model, {.tolerance = 1e-11, .rho_infinity = rho});
        const auto rows = lie::march(x, *integrator, lie::TimeGrid::over(60, 1, 1)).row;
        const auto size = [&](std::size_t n) { return std::abs(rows[n].body[0].rddot.x()); };
        CAPTURE(name, rho, size(0), size(30), size(60));
        const double of_step = std::pow(size(60) / size(30), 1 / 30.);
        CHECK(of_step >= 0.99 * rho);
        CHECK(of_step <= 1.01 * std::pow(2., 2 / 30.) * rho);
    }
}

namespace {

/// Distance of two nodes [s], and the rtol of adaptive steps
struct Resolution {
    double h, rtol;
};

/// The numbers of the states that a scheme computes until `end`, or until it fails
std::vector<double> computed(const lie::Scheme& scheme, const lie::System& system, lie::State x,
                             lie::Settings settings, const Resolution& resolution, double end)
{
    if (settings.rtol == lie::Settings().rtol) settings.rtol = resolution.rtol;
    const auto integrator = scheme.make(system, settings);
    std::vector<double> numbers;
    const auto add = [&](const auto& of) { numbers.insert(numbers.end(), of.data(), of.data() + of.size()); };
    try {
        while (x.t < end) {
            integrator->step(x, resolution.h);
            for (const lie::Motion& body : x.body)
                add(body.r), add(body.A), add(body.rdot), add(body.omega_bar);
            add(x.lambda);
        }
    } catch (const lie::NumericalFailure&) {
        numbers.push_back(0);
    }
    return numbers;
}

struct OtherValues {
    std::string option;
    std::vector<lie::Settings> settings;
    double end = 0.2;  ///< [s]
};

/// Values of each option other than the default. The Euler angles of the crank are singular at 0.236 s.
const std::vector<OtherValues> other_values = {
    {"--tolerance", {{.tolerance = 1e-3}, {.tolerance = 1e-13}}},
    {"--max-iterations", {{.max_iterations = 1}, {.max_iterations = 2}}},
    {"--linear-solver",
     {{.linear_solver = lie::LinearSolver::klu}, {.linear_solver = lie::LinearSolver::condensed}}},
    {"--rho-infinity", {{.rho_infinity = 0.6}}},
    {"--reparametrise", {{.reparametrise = true}}, 0.3},
    {"--rtol", {{.rtol = 1e-6}}},
    {"--atol", {{.atol = 1e-6}}}};

}  // namespace

TEST_CASE("an option of the settings has an effect on exactly the schemes that list it",
          "[reference][schemes]")
{
    struct Case {
        const lie::System& system;
        lie::State start;
        Resolution resolution;
    };
    const tests::SpinningTop top;
    dae::Model mechanism;
    lie::State start;
    tests::slider_crank(mechanism, start);
    dae::start(mechanism, start);
    const std::vector<Case> cases = {
        {mechanism, start, {2e-2, 1e-10}}, {mechanism, start, {0.1, 1e-4}}, {top, top.start(), {0.1, 1e-4}}};
    for (const lie::Scheme& scheme : lie::schemes())
        for (const lie::Scheme* form :
             {&scheme, static_cast<const lie::Scheme*>(scheme.adaptive_form.get())}) {
            if (form == nullptr) continue;
            for (const OtherValues& other : other_values) {
                CAPTURE(form->name, form->adaptive, other.option);
                bool has_effect = false;
                for (const Case& c : cases) {
                    if (!form->takes(c.system)) continue;
                    const auto with = [&](const lie::Settings& settings) {
                        return computed(*form, c.system, c.start, settings, c.resolution, other.end);
                    };
                    for (const lie::Settings& settings : other.settings)
                        has_effect = has_effect || with(settings) != with({});
                }
                CHECK(has_effect == form->uses_option(other.option));
            }
        }
}

TEST_CASE("an option that a scheme declares reaches its constructor, by default with its default value",
          "[reference][schemes]")
{
    static std::vector<double> seen;
    lie::Scheme scheme = lie::scheme("rA-half-1");
    scheme.options = {{{.name = "--twist", .value = "T", .help = "none"}, 0.25},
                      {{.name = "--sharp", .help = "none"}}};
    scheme.construct = [](const lie::System& system, const lie::Settings& settings) {
        for (const auto& [name, value] : settings.of_scheme) seen.push_back(value);
        return lie::scheme("rA-half-1").make(system, settings);
    };
    const tests::SpinningTop top;
    scheme.make(top, {});
    scheme.make(top, {.of_scheme = {{"--twist", 3}, {"--sharp", 1}}});
    CHECK(seen == std::vector<double>{0, 0.25, 1, 3});  // in the order of the names
    CHECK_THROWS_WITH(scheme.make(top, {.of_scheme = {{"--twist", std::nan("")}}}),
                      Catch::Contains("--twist must be finite"));
    scheme.name = "another";
    scheme.options = {{{.name = "twist", .help = "none"}}};
    CHECK_THROWS_WITH(lie::add_scheme(scheme), Catch::Contains("must begin with --, got twist"));
}
