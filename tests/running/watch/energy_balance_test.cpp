// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/energy_balance.hpp"

#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using run::EnergyBalance;

namespace {

/// A body of 2 kg on a spring of 50 N/m along x (frequency 5 rad/s), deflected by 0.1 m, with a damper [N
/// s/m] and a force along x [N]
struct Oscillator {
    dae::Description d;

    explicit Oscillator(const std::string& damping = "0", const std::string& force = "0")
        : d(dae::read_model(
              R"({"hilda_model": 1, "name": "m", "gravity": [0, 0, 0], "end": 1,
 "bodies": [{"name": "mass", "mass": 2, "inertia": [1, 1, 1], "r": [0.1, 0, 0]}],
 "forces": [{"type": "spring-damper", "name": "spring", "body_i": "ground", "body_j": "mass",
   "s_bar_p_i": [-1, 0, 0], "stiffness": 50, "free_length": 1, "damping": )" +
                  damping + "}" +
                  (force == "0" ? ""
                                : R"(, {"type": "force", "name": "drive", "body": "mass", "frame": "global",
   "components": [")" + force + R"(", 0, 0]})") +
                  "]}",
              "model"))
    {
        dae::start(d);
    }

    /// The balance at the end of a run
    run::EnergyRecord record(double h, double end) const
    {
        struct Observer final : lie::Observer {
            EnergyBalance balance;
            Observer(const dae::Model& model, const lie::State& x, double h) : balance(model, x, h) {}
            void accepted(const lie::State& at, long n, int) override
            {
                balance.add_work(at);
                balance.evaluate(at, n);
            }
        } observer(*d.model, d.x, h);
        lie::Observer* observers[] = {&observer};
        const auto integrator = lie::scheme("rA-half-1-momentum").make(*d.model, {});
        lie::march(d.x, *integrator, lie::TimeGrid::over(end, h), observers);
        return observer.balance.record;
    }
};

}  // namespace

TEST_CASE("the energy of leapfrog on an oscillator rises by at most half of the error estimate",
          "[run][energy_balance]")
{
    const Oscillator free;
    const double E = 0.5 * 50 * 0.01;
    for (const double h : {0.1, 0.05, 0.01}) {
        CAPTURE(h);
        const run::EnergyRecord r = free.record(h, 20);
        CHECK(r.start == Approx(E).epsilon(1e-12));
        CHECK(r.kinetic_most == Approx(E).epsilon(0.1));
        CHECK(r.step_error == Approx(std::pow(5 * h, 2) * E).epsilon(0.1));
        CHECK(r.rise < 0.5 * r.step_error);
        CHECK(r.rise > 0.05 * r.step_error);
        CHECK(r.work() == 0);
    }
}

TEST_CASE("the energy that a damper dissipates is the integral of c v²", "[run][energy_balance]")
{
    const double c = 4, decay = c / 4, t = 0.8;  // x = 0.1 e^(-t) (cos wt + decay/w sin wt)
    const double w = std::sqrt(25 - decay * decay), e = std::exp(-decay * t);
    const double x = 0.1 * e * (std::cos(w * t) + decay / w * std::sin(w * t)),
                 v = -0.1 * e * 25 / w * std::sin(w * t);
    const double left = 0.5 * 50 * x * x + 0.5 * 2 * v * v, lost = 0.5 * 50 * 0.01 - left;
    const Oscillator damped("4");
    const double coarse = std::abs(damped.record(4e-3, t).dissipated() - lost),
                 fine = std::abs(damped.record(2e-3, t).dissipated() - lost);
    CHECK(coarse < 0.5 * std::pow(5 * 4e-3, 2) * lost);
    CHECK(coarse / fine == Approx(4).epsilon(0.1));
    CHECK(damped.record(2e-3, t).rise < 1e-6 * lost);
}

TEST_CASE("the work of a prescribed force balances the change of the energy", "[run][energy_balance]")
{
    const Oscillator driven("0", "3*cos(2*t)");
    REQUIRE_FALSE(EnergyBalance(*driven.d.model, driven.d.x, 1e-3).is_passive());
    const run::EnergyRecord coarse = driven.record(4e-3, 3), fine = driven.record(2e-3, 3);
    CHECK(std::abs(fine.last - fine.start) > 0.1);
    CHECK(std::abs(fine.dissipated()) < 1e-4 * fine.kinetic_most);
    CHECK(coarse.dissipated() / fine.dissipated() == Approx(4).epsilon(0.2));
    CHECK(fine.work() == Approx(fine.work_of_loads()));
}

TEST_CASE("a model is passive if no driver moves and all forces are passive", "[run][energy_balance]")
{
    const Oscillator free, damped("1"), driven("0", "sin(t)");
    CHECK(EnergyBalance(*free.d.model, free.d.x, 1e-3).is_passive());
    CHECK(EnergyBalance(*damped.d.model, damped.d.x, 1e-3).is_passive());
    CHECK_FALSE(EnergyBalance(*driven.d.model, driven.d.x, 1e-3).is_passive());
}
