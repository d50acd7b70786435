// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of the N-four-bar and of Bricard's mechanism, which keep their redundant rows, with all integrators.

#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "studies/framework/problem.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace hilda;

namespace {

/// The model of a problem with its joints in a random order; seed 0 is the order of the problem
dae::Description started_in_order(const std::string& problem, unsigned seed = 0)
{
    auto json = nlohmann::ordered_json::parse(studies::problem(problem).model);
    std::mt19937 random(seed);
    if (seed > 0) std::shuffle(json["constraints"].begin(), json["constraints"].end(), random);
    dae::Description d = dae::read_model(json.dump(), problem);
    dae::start(d);
    return d;
}

/// Largest deviation of the energy from its value at the start
class EnergyError final : public lie::Observer {
public:
    explicit EnergyError(const lie::System& system) : system(system) {}

    void accepted(const lie::State& node, long n, int /*iterations*/) override
    {
        const double energy = lie::energy(system, node);
        if (n == 0) at_start = energy;
        largest = std::max(largest, std::abs(energy - at_start));
    }

    double largest = 0;

private:
    const lie::System& system;
    double at_start = 0;
};

struct Result {
    lie::State end;
    double energy_error;
};

Result run(const dae::Description& d, const lie::Scheme& scheme, double t_end, double h)
{
    lie::Settings settings;
    settings.rtol = 1e-8;
    const auto integrator = scheme.make(*d.model, settings);
    EnergyError energy(*d.model);
    lie::Observer* const observers[] = {&energy};
    lie::March march(d.x, *integrator, h);
    for (long n = std::lround(t_end / h); n > 0; --n) march.advance(observers);
    march.finish(observers);
    return {march.node(), energy.largest};
}

lie::State exact(const std::string& problem, double t)
{
    dae::Description d = started_in_order(problem);
    return studies::problem(problem).reference_solution(d, {t}).row.front();
}

double position_distance(const lie::State& x, const lie::State& y)
{
    double most = 0;
    for (size_t b = 0; b < x.body.size(); ++b) most = std::max(most, (x.body[b].r - y.body[b].r).norm());
    return most;
}

/// Orders of the joints, and integrators with their steps [s]. An adaptive one has nodes every 0.1 s.
void check_all_orders(const std::string& problem, unsigned orders, double h, double energy_error,
                      double difference)
{
    for (const auto& [scheme, step] : {std::pair(lie::scheme("rA-half-1-momentum"), h),
                                       {lie::scheme("rA-rattle"), h},
                                       {lie::scheme("rA-dop853").with_adaptive_steps(), 0.1}}) {
        const Result natural = run(started_in_order(problem), scheme, 10, step);
        for (unsigned seed = 0; seed < orders; ++seed) {
            INFO(problem << " " << scheme.name << ", order " << seed);
            const Result result = run(started_in_order(problem, seed), scheme, 10, step);
            CHECK(result.energy_error < energy_error);
            CHECK(position_distance(result.end, natural.end) < difference);
        }
    }
}

}  // namespace

TEST_CASE("integrators with redundant rows pass a flat configuration of the N-four-bar with their order",
          "[studies][singular]")
{
    const dae::Description d = started_in_order("n_four_bar");
    const lie::State x = exact("n_four_bar", 1);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::redundant)) continue;
        INFO(s.name);
        const double coarse = position_distance(run(d, s, 1, 4e-3).end, x),
                     fine = position_distance(run(d, s, 1, 2e-3).end, x);
        INFO(coarse << ' ' << fine);
        if (s.name.starts_with("rA-full-1")) {
            CHECK(std::log2(coarse / fine) == Approx(1).margin(0.3));
        } else if (s.name.starts_with("rA-half") || s.name == "rA-rattle" || s.name == "rA-genalpha") {
            CHECK(fine < 2e-4);
            CHECK(std::log2(coarse / fine) > 1.8);
            CHECK(std::log2(coarse / fine) < 2.8);
        } else {  // the crossing has an error of order 2 in compositions, and none in explicit schemes
            CHECK(fine < 1e-4);
        }
    }
    const lie::Scheme& dop853 = lie::scheme("rA-dop853").with_adaptive_steps();
    CHECK(position_distance(run(d, dop853, 1, 0.1).end, x) < 1e-7);
}

TEST_CASE("Bricard's mechanism has the order of the integrator", "[studies][singular]")
{
    const dae::Description d = started_in_order("bricard");
    const lie::State x = exact("bricard", 0.5);
    for (const char* name : {"rA-half-1-momentum", "rA-rattle", "rA-genalpha", "rA-rkmk-4"}) {
        const lie::Scheme& s = lie::scheme(name);
        const double coarse = position_distance(run(d, s, 0.5, 4e-3).end, x),
                     fine = position_distance(run(d, s, 0.5, 2e-3).end, x);
        INFO(name << ' ' << coarse << ' ' << fine);
        CHECK(std::log2(coarse / fine) == Approx(s.order).margin(0.2));
    }
}

TEST_CASE("integrators with redundant rows run the N-four-bar for 10 s (long)", "[studies][singular]")
{
    for (const auto& [problem, h] :
         {std::pair("n_four_bar", 1e-3), {"n_four_bar_10", 1e-3}, {"n_four_bar_40", 2e-3}}) {
        const dae::Description d = started_in_order(problem);
        const double scale = static_cast<double>(d.x.body.size()) / 5;
        for (const lie::Scheme& s : lie::schemes()) {
            if (!s.supports.contains(lie::Feature::redundant) || s.name.starts_with("rA-rattle-")) continue;
            INFO(problem << " " << s.name);
            const Result result = run(d, s, 10, h);
            if (s.order > 1) CHECK(result.energy_error < 2e-2 * scale * (h / 1e-3) * (h / 1e-3));
        }
    }
}

TEST_CASE("the order of the joints does not change the motion in 10 s (long)", "[studies][singular]")
{
    check_all_orders("bricard", 18, 1e-3, 1e-4, 1e-5);
    check_all_orders("n_four_bar", 6, 1e-3, 1e-3, 1e-5);
    check_all_orders("n_four_bar_10", 3, 1e-3, 5e-3, 1e-5);
}

TEST_CASE("the flyball governor runs with implicit springs", "[studies][singular]")
{
    const dae::Description d = started_in_order("flyball_governor");
    const lie::State x = exact("flyball_governor", 0.2);
    const lie::Scheme& s = lie::scheme("rA-half-1-momentum");
    CHECK(position_distance(run(d, s, 0.2, 1e-3).end, x) < 1e-3);
}
