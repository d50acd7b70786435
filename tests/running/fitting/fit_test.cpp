// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fitting/fit.hpp"

#include "io/error.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

constexpr double stiffness = 30, damping = 0.5, inertia = 1.5, speed = 2;  // N m/rad, N m s/rad, kg m², rad/s

/// A wheel on a torsion spring: inertia φ̈ + damping φ̇ + stiffness φ = 0
const char* const wheel = R"({"hilda_model": 1, "name": "wheel", "gravity": [0, 0, 0],
  "parameters": {"k": 20, "c": 0.2, "J": 1.5},
  "bodies": [{"name": "wheel", "mass": 1, "inertia": [1, "J", 1], "r": [0, 0, 0], "omega": [0, 2, 0]}],
  "constraints": [{"type": "revolute", "name": "axle", "body_i": "ground", "body_j": "wheel",
                   "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]}],
  "forces": [{"type": "torsion-spring", "name": "spring", "body_i": "ground", "body_j": "wheel",
              "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0], "free_angle": 0, "stiffness": "k", "damping": "c"}]})";

/// sin φ, which is the component A13 of the wheel
double exact(double t)
{
    const double decay = damping / (2 * inertia), omega = std::sqrt(stiffness / inertia - decay * decay);
    return std::sin(speed / omega * std::exp(-decay * t) * std::sin(omega * t));
}

run::FitData data(double noise, unsigned seed, bool irregular = false)
{
    run::FitData all{.t = {}, .columns = {"wheel.A13"}, .values = Eigen::MatrixXd(40, 1)};
    std::mt19937 engine(seed);
    std::normal_distribution<double> error(0, 1);
    std::uniform_real_distribution<double> jitter(-0.4, 0.4);
    for (int k = 0; k < 40; ++k) {
        all.t.push_back(0.05 * (k + 1 + (irregular ? jitter(engine) : 0)));
        all.values(k, 0) = exact(all.t.back()) + noise * error(engine);
    }
    return all;
}

run::FitProblem problem(const std::string& scheme, const run::FitData& data)
{
    run::FitProblem all;
    all.read = [](std::span<const std::string> set) { return dae::read_model(wheel, "wheel.json", set); };
    all.parameters = {{.pointer = "/parameters/k", .start = 20, .low = 1},
                      {.pointer = "/parameters/c", .start = 0.2, .low = 0, .high = 10}};
    all.data = data;
    all.run.scheme = &lie::scheme(scheme);
    if (scheme == "rA-dop853") all.run.scheme = &all.run.scheme->with_adaptive_steps();
    all.run.settings.rtol = 1e-11;
    return all;
}

bool warns(const run::FitResult& result, const std::string& what)
{
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [&](const std::string& text) { return text.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE("a fit finds the spring and damper of exact data")
{
    for (const bool irregular : {false, true}) {
        const run::FitResult result = run::fit(problem("rA-dop853", data(0, 1, irregular)));
        CAPTURE(irregular, result.reason);
        CHECK(result.has_converged);
        CHECK(result.parameters[0].value == Approx(stiffness).epsilon(irregular ? 1e-6 : 1e-9));
        CHECK(result.parameters[1].value == Approx(damping).epsilon(irregular ? 1e-5 : 1e-8));
        CHECK(result.values == 40);
        CHECK(result.degrees_of_freedom == 38);
    }
}

TEST_CASE("the error of a fit by the time steps is predicted, with a warning")
{
    for (const char* scheme : {"rA-half-1-kick", "rA-full-1"}) {
        run::FitProblem of = problem(scheme, data(0, 1));
        of.run.step = of.run.scheme->order == 1 ? 5e-4 : 2.5e-3;
        const run::FitResult result = run::fit(of);
        const run::FittedParameter& k = result.parameters[0];
        CAPTURE(scheme, k.value, k.bias);
        CHECK(std::abs(k.value - stiffness) > 1e-5);
        CHECK(k.bias == Approx(k.value - stiffness).epsilon(0.05));
        CHECK(warns(result, "the time steps change /parameters/k"));
    }
    CHECK_FALSE(warns(run::fit(problem("rA-dop853", data(1e-3, 1))), "time steps"));
}

TEST_CASE("the standard errors of a fit are those of repeated data")
{
    constexpr int samples = 60;
    constexpr double noise = 1e-2;
    double sum[2] = {}, inside = 0, sigma = 0, correlation = 0;
    for (unsigned seed = 0; seed < samples; ++seed) {
        run::FitProblem of = problem("rA-rkmk-4", data(noise, seed));
        of.run.step = 1e-2;
        const bool is_known = seed % 2 == 0;
        if (is_known) of.sigma = {noise};
        const run::FitResult result = run::fit(of);
        REQUIRE(result.has_converged);
        const double truth[] = {stiffness, damping};
        double scaled[2];
        for (size_t p = 0; p < 2; ++p) {
            const run::FittedParameter& one = result.parameters[p];
            scaled[p] = (one.value - truth[p]) / one.error;
            sum[p] += scaled[p] * scaled[p] / samples;
            inside += (one.low_95 < truth[p] && truth[p] < one.high_95 ? 1. : 0.) / (2 * samples);
        }
        sigma += (is_known ? result.sigma * noise : result.sigma) / samples;
        correlation +=
            scaled[0] * scaled[1] / samples -
            result.covariance(0, 1) / (result.parameters[0].error * result.parameters[1].error) / samples;
    }
    // The mean of 60 squares of normal numbers has the standard deviation 0.18.
    CHECK(sum[0] == Approx(1).margin(0.55));
    CHECK(sum[1] == Approx(1).margin(0.55));
    CHECK(inside > 0.87);
    CHECK(sigma == Approx(noise).epsilon(0.06));
    CHECK(std::abs(correlation) < 0.4);
}

TEST_CASE("a fit names a combination of parameters that the data do not determine")
{
    run::FitProblem of = problem("rA-dop853", data(1e-4, 3));
    of.parameters.push_back({.pointer = "/parameters/J", .start = 1.2, .low = 0.1});
    const run::FitResult result = run::fit(of);
    CHECK(result.singular_values[2] < 1e-6 * result.singular_values[0]);
    CHECK(warns(result, "do not determine this combination"));
    for (const run::FittedParameter& one : result.parameters) CHECK(std::isnan(one.error));
    CHECK(result.parameters[0].value / result.parameters[2].value ==
          Approx(stiffness / inertia).epsilon(1e-3));
    // Equal relative changes of the three
    CHECK(std::abs(result.directions(0, 2)) == Approx(std::sqrt(1. / 3)).epsilon(1e-3));
}

TEST_CASE("a fit names parameters without effect, and errors that are unknown")
{
    run::FitProblem of = problem("rA-dop853", data(1e-4, 3));
    of.parameters = {{.pointer = "/bodies/0/mass", .start = 1}};
    const run::FitResult none = run::fit(of);
    CHECK(warns(
        none,
        "do not determine this combination of relative changes of the parameters: 1.00 /bodies/0/mass"));
    CHECK(std::isnan(none.parameters[0].error));

    of = problem("rA-dop853", data(1e-4, 3));
    of.data.t.resize(2);
    of.data.values.conservativeResize(2, 1);
    const run::FitResult exact_fit = run::fit(of);
    CHECK(exact_fit.chi_squared < 1e-20);
    CHECK(warns(exact_fit, "as many parameters as values"));
    CHECK(std::isnan(exact_fit.parameters[0].error));
    of.sigma = {1e-4};
    CHECK(run::fit(of).parameters[0].error > 0);
}

TEST_CASE("a fit leaves out missing values, and stops at bounds")
{
    run::FitData some = data(0, 1);
    for (int k = 0; k < 40; k += 3) some.values(k, 0) = std::nan("");
    const run::FitResult result = run::fit(problem("rA-dop853", some));
    CHECK(result.values == 26);
    CHECK(result.parameters[0].value == Approx(stiffness).epsilon(1e-8));

    run::FitProblem of = problem("rA-dop853", data(0, 1));
    of.parameters[0].high = 25;
    const run::FitResult at_bound = run::fit(of);
    CHECK(at_bound.parameters[0].at_bound);
    CHECK(at_bound.parameters[0].value == Approx(25));
    CHECK(warns(at_bound, "/parameters/k is at a bound"));
}

TEST_CASE("a fit avoids values with which the model is invalid")
{
    run::FitProblem of = problem("rA-dop853", data(0, 1));
    of.parameters = {{.pointer = "/parameters/J", .start = 0.1}, {.pointer = "/parameters/k", .start = 35}};
    of.read = [](std::span<const std::string> set) {
        std::vector<std::string> all(set.begin(), set.end());
        all.emplace_back("/parameters/c=0.5");
        return dae::read_model(wheel, "wheel.json", all);
    };
    const run::FitResult result = run::fit(of);  // without bounds: an inertia may become negative
    CAPTURE(result.reason);
    CHECK(result.has_converged);
    CHECK(result.parameters[0].value > 0);
}

TEST_CASE("the nodes of a sampled run follow the instants, and end with the last one")
{
    CHECK(run::interval_of({0.1, 0.2, 0.4}) == Approx(0.1));
    CHECK(run::interval_of({0, 0.2, 0.4}) == Approx(0.2));
    CHECK(run::interval_of({0.1, 0.1 + 1e-9, 0.5, 1}) > 1e-4);  // a limit for close instants
    // Samples of a motion end at 1 s: a later node has no motion.
    const char* const crank = R"({"hilda_model": 1, "name": "crank",
      "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}],
      "constraints": [
        {"type": "revolute", "name": "axle", "body_i": "ground", "body_j": "bar",
         "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
        {"type": "hinge-driver", "name": "turn", "body_i": "ground", "body_j": "bar", "axis_bar_i": [0, 0, 1],
         "axis_bar_j": [0, 0, 1], "angle": {"t": [0, 0.2, 0.4, 0.6, 0.8, 1], "f": [0, 0.04, 0.16, 0.36, 0.64, 1]}}]})";
    for (const char* scheme : {"rA-dop853", "rA-rkmk-4"}) {
        dae::Description model = dae::read_model(crank, "crank.json");
        run::SampledRunOptions options{.scheme = &lie::scheme(scheme), .step = 3e-3, .fix_initial = true};
        if (std::string(scheme) == "rA-dop853") options.scheme = &options.scheme->with_adaptive_steps();
        const run::Samples samples = run::sample(model, {"bar.A11"}, {0.33, 0.71, 0.97, 1.0}, options);
        CHECK(samples.values(3, 0) == Approx(std::cos(1.)).epsilon(1e-6));
    }
}

TEST_CASE("invalid fits are refused")
{
    const auto refuse = [](const auto& change, const std::string& expected) {
        run::FitProblem of = problem("rA-dop853", data(0, 1));
        change(of);
        CHECK_THROWS_WITH(run::fit(of), Contains(expected));
    };
    refuse([](auto& of) { of.parameters.clear(); }, "no parameter to fit");
    refuse([](auto& of) { of.parameters[1].pointer = "/parameters/k"; }, "is given twice");
    refuse([](auto& of) { of.parameters[0].pointer = "/parameters/x"; }, "/parameters/x");
    refuse([](auto& of) { of.parameters[0].low = 20; }, "between the bounds 20 and inf, got 20");
    refuse([](auto& of) { of.data.columns = {"wheel.A31x"}; }, "did you mean 'wheel.A31'");
    refuse([](auto& of) { of.data.t[3] = of.data.t[2]; }, "t must increase");
    refuse([](auto& of) { of.data.t[0] = -1; }, "not negative in row 1, got -1");
    refuse([](auto& of) { of.data.values.setConstant(std::nan("")); }, "wheel.A13 has no value");
    refuse([](auto& of) { of.data.values(2, 0) = INFINITY; }, "is infinite in row 3");
    refuse([](auto& of) { of.sigma = {0}; }, "standard deviation must be positive");
    refuse([](auto& of) { of.sigma = {1, 1}; }, "2 standard deviations for 1 columns");
    refuse([](auto& of) { of.data.values.bottomRows(39).setConstant(std::nan("")); },
           "1 value for 2 parameters");
    refuse(
        [](auto& of) {
            of.data.columns = {"wheel.A13", "wheel.rx"};
            of.data.values = Eigen::MatrixXd::Ones(40, 2);
        },
        "have different units");
}

TEST_CASE("hilda fit writes the parameters, the data and a figure")
{
    const Scratch in;
    write(in / "wheel.json", wheel);
    std::string rows = "t,wheel.A13,note\n";
    const run::FitData of = data(1e-3, 5);
    for (size_t k = 0; k < of.t.size(); ++k)
        rows += std::to_string(of.t[k]) + ',' +
                (k == 7 ? "" : std::to_string(of.values(static_cast<long>(k), 0))) + ",\n";
    write(in / "data.csv", rows);
    const std::vector<std::string> command = {
        "fit",       "wheel.json",  "--data",        "data.csv",    "--column",
        "wheel.A13", "--parameter", "/parameters/k", "--parameter", "/parameters/c=0.3:0:5:0.1"};
    const Ended done = call(in, command);
    INFO(done.out << done.err);
    CHECK(done.code == 0);
    CHECK_THAT(done.out, Contains("39 values, 2 parameters, rA-dop853 with rtol = 1e-10") &&
                             Contains("/parameters/k") && Contains("written to out/fit-wheel"));
    for (const char* file : {"fit.json", "fit.csv", "model.json", "fit.png"})
        CHECK(fs::file_size(in / "out/fit-wheel" / file) > 0);
    CHECK_THAT(read(in / "out/fit-wheel/fit.csv"), Contains("t,wheel.A13.data,wheel.A13.model\n"));
    CHECK(call(in, {"run", "out/fit-wheel/model.json", "--end", "0.1", "--output", "again"}).code == 0);
    CHECK(call(in, {"rerun", "out/fit-wheel"}).code == 0);

    const auto refused = [&](std::vector<std::string> more, int code, const std::string& expected) {
        std::vector<std::string> words = {"fit", "wheel.json", "--output", "new"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = call(in, words);
        CAPTURE(more, ended.err);
        CHECK(ended.code == code);
        CHECK_THAT(ended.err, Contains(expected));
        CHECK_FALSE(fs::exists(in / "new"));
    };
    refused({}, 2, "--data is required");
    refused({"--data", "data.csv"}, 2, "--parameter /json/pointer is required");
    refused({"--data", "data.csv", "--column", "wheel.A13", "--parameter", "k=1"}, 2,
            "expected /json/pointer=START");
    refused({"--data", "data.csv", "--parameter", "/parameters/k=5:1", "--column", "wheel.A13"}, 2,
            "expected START, START:LOW:HIGH");
    refused({"--data", "data.csv", "--parameter", "/parameters/k=5:6:7", "--column", "wheel.A13"}, 2,
            "6 < 5 < 7 is not true");
    refused({"--data", "data.csv", "--column", "wheel.A13", "--parameter", "/bodies/0/name"}, 2,
            "the model has no number there");
    refused({"--data", "data.csv", "--parameter", "/parameters/k"}, 3, "the column note has no value");
    refused({"--data", "none.csv", "--parameter", "/parameters/k"}, 5, "none.csv: does not exist");
    refused({"--data", "data.csv", "--parameter", "/parameters/k", "--column", "wheel.A3"}, 3,
            "has no column");
    refused({"--data", "data.csv", "--column", "wheel.A13", "--parameter", "/parameters/k", "--sigma", "x=1"},
            2, "no column 'x'");
    write(in / "bad.csv", "t,wheel.A13\n0.1,0\n0.2,x\n");
    refused({"--data", "bad.csv", "--parameter", "/parameters/k"}, 3,
            "bad.csv:3: wheel.A13: expected a finite number, got 'x'");
}

TEST_CASE("examples: the fit of the swing has the stiffness and damping of its data")
{
    const std::string folder = std::string(source_dir) + "/examples/fit/";
    run::FitProblem of;
    of.read = [&](std::span<const std::string> set) { return dae::load_model(folder + "swing.json", set); };
    of.data = run::read_fit_data(folder + "swing.csv", {});
    of.parameters = {{.pointer = "/forces/0/stiffness", .start = 10},
                     {.pointer = "/forces/0/damping", .start = 1, .low = 0, .high = 10}};
    of.run.scheme = &lie::scheme("rA-dop853").with_adaptive_steps();
    const run::FitResult result = run::fit(of);
    CHECK(std::abs(result.parameters[0].value - 27.3) < 3 * result.parameters[0].error);
    CHECK(std::abs(result.parameters[1].value - 1.37) < 3 * result.parameters[1].error);
    CHECK(result.sigma == Approx(1e-3).epsilon(0.25));

    // Only ratios of the four have an effect. The model needs an inertia of at least 0.6.
    of.parameters.push_back({.pointer = "/bodies/0/mass", .start = 2});
    of.parameters.push_back({.pointer = "/bodies/0/inertia/0", .start = 0.7, .low = 0.6, .high = 0.8});
    CHECK(warns(run::fit(of), "0.50 /forces/0/stiffness, 0.50 /forces/0/damping, 0.50 /bodies/0/mass, 0.50"));
    of.parameters[3].low = 0;
    const run::FitResult stopped = run::fit(of);
    CHECK_FALSE(stopped.has_converged);
    CHECK(warns(stopped, "the model fails beside the last values; the last failure: "));
}
