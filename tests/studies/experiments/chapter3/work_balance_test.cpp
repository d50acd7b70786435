// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter3/work_balance.hpp"

#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "studies/framework/problem.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using run::NodeIntegral;
using studies::WorkBalance;

namespace {

struct Balance {
    double change = 0, loads = 0, drivers = 0;  ///< E - E(0), W_loads, W_drivers [J]
    std::vector<std::string> sources;
    double error() const { return change - loads - drivers; }
};

class Recorder final : public lie::Observer {
public:
    explicit Recorder(const dae::Model& model) : model(model), work(model) {}
    void accepted(const lie::State& x, long n, int) override
    {
        work.add(x);
        end = lie::energy(model, x);
        if (n == 0) start = end;
    }
    const dae::Model& model;
    WorkBalance work;
    double start = 0, end = 0;
};

Balance balance_of(const std::string& model, const std::string& scheme, double h, double end)
{
    dae::Description d = dae::read_model(model, "model");
    dae::start(d);
    const auto integrator = lie::scheme(scheme).make(*d.model, {});
    Recorder recorder(*d.model);
    lie::Observer* observers[] = {&recorder};
    lie::march(d.x, *integrator, lie::TimeGrid::over(end, h), observers);
    return {recorder.end - recorder.start, recorder.work.loads(), recorder.work.drivers(),
            recorder.work.sources()};
}

/// A body of 2 kg at x = 5 m with the velocity 3 m/s along x and one force, without gravity
std::string sliding_body(const std::string& force)
{
    return R"({"hilda_model": 1, "name": "slide", "gravity": [0, 0, 0], "end": 1,
        "bodies": [{"name": "b", "mass": 2, "inertia": [1, 1, 1], "r": [5, 0, 0], "r_dot": [3, 0, 0]}],
        "forces": [)" +
           force + "]}";
}

std::string spring(const std::string& keys)
{
    return R"({"name": "s", "type": "spring-damper", "body_i": "ground", "body_j": "b", "free_length": 4, )" +
           keys + "}";
}

/// Error of the integral of exp(-t) cos(3 t) over [0, 2] with n steps
double integral_error(int n)
{
    NodeIntegral integral;
    const double h = 2. / n;
    for (int k = 0; k <= n; ++k) integral.add(std::exp(-k * h) * std::cos(3 * k * h), h);
    const auto antiderivative = [](double t) {
        return std::exp(-t) * (3 * std::sin(3 * t) - std::cos(3 * t)) / 10;
    };
    return integral.value() - (antiderivative(2) - antiderivative(0));
}

}  // namespace

TEST_CASE("the integral over the nodes is of fourth order, also after a change of the step",
          "[studies][work]")
{
    NodeIntegral line;
    for (int k = 0; k <= 7; ++k) line.add(2 + 3 * (0.1 * k), 0.1);
    CHECK(line.value() == Approx(2 * 0.7 + 1.5 * 0.49));
    CHECK(std::abs(integral_error(200)) < 1e-6);
    CHECK(std::log2(std::abs(integral_error(200) / integral_error(400))) == Approx(4).margin(0.2));

    NodeIntegral restarted;  // a change of the step, as at the end of a run that is no multiple of h
    for (const double t : {0., 0.1, 0.2, 0.3}) restarted.add(t, 0.1);
    restarted.add(0.35, 0.05);
    CHECK(restarted.value() == Approx(0.5 * 0.35 * 0.35));
    CHECK(NodeIntegral().value() == 0);
}

TEST_CASE("the work of a damper is the lost kinetic energy of a body that it slows down", "[studies][work]")
{
    const Balance b =
        balance_of(sliding_body(spring(R"("stiffness": 0, "damping": 0.8)")), "rA-rkmk-4", 1e-3, 1);
    const double expected = -9 * (1 - std::exp(-0.8));  // 1/2 m v^2 with v = 3 exp(-c t / m)
    CHECK(b.loads == Approx(expected).epsilon(1e-9));
    CHECK(b.drivers == 0);
    CHECK(std::abs(b.error()) < 1e-9);
    CHECK(b.sources == std::vector<std::string>{"force 's'"});
}

TEST_CASE("a spring does no work beside its potential, exactly", "[studies][work]")
{
    const Balance b =
        balance_of(sliding_body(spring(R"("stiffness": 100, "damping": 0)")), "rA-half-2", 1e-3, 1);
    CHECK(b.sources.empty());
    CHECK(b.loads == 0);
    CHECK(b.change != 0);  // the error of the scheme
}

TEST_CASE("a force law without potential, of time or of the distance, is balanced by its work",
          "[studies][work]")
{
    for (const char* law : {"-2*l", "5*sin(3*t)", "0.3*ldot^3"}) {
        const Balance b = balance_of(
            sliding_body(spring(R"("stiffness": 40, "damping": 0, "force": ")" + std::string(law) + '"')),
            "rA-rkmk-4", 1e-3, 1);
        CAPTURE(law, b.change, b.loads);
        CHECK(b.sources.size() == 1);
        CHECK(std::abs(b.loads) > 0.1);
        CHECK(std::abs(b.error()) < 3e-8);
    }
}

TEST_CASE("the work of a driver is the change of the energy, with the order of the scheme", "[studies][work]")
{
    const std::string model = studies::problem("single_pendulum").model;
    const Balance exact = balance_of(model, "rA-rattle", 1e-3, 1);
    CHECK(exact.sources.size() == 1);
    CHECK_THAT(exact.sources.front(), Catch::Matchers::StartsWith("driver '"));
    CHECK(exact.loads == 0);
    CHECK(std::abs(exact.drivers) > 1);
    CHECK(std::abs(exact.error()) < 1e-6 * std::abs(exact.drivers));
    for (const auto& [scheme, order] : {std::pair("rA-half-1", 1.), {"rA-full-1", 1.}, {"rA-half-2", 2.}}) {
        const double coarse = balance_of(model, scheme, 2e-3, 1).error(),
                     fine = balance_of(model, scheme, 1e-3, 1).error();
        INFO(scheme << " " << coarse << " " << fine);
        CHECK(std::log2(std::abs(coarse / fine)) == Approx(order).margin(0.25));
    }
}

TEST_CASE("sliding friction is balanced by its work", "[studies][work]")
{
    const Balance b = balance_of(studies::problem("rolling_ball").model, "rA-half-1-momentum", 1e-4, 0.5);
    CHECK(b.loads < -1);
    CHECK(std::abs(b.error()) < 1e-4 * std::abs(b.loads));
    CHECK(b.sources.size() == 1);
}
