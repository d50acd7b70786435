// SPDX-License-Identifier: GPL-3.0-or-later
/// Reference solutions of studies by an integrator.
#include "io/error.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/framework/study_options.hpp"
#include "tests/support/adaptive_scheme.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> convergence = {"study",   "convergence", "--problem",    "double_pendulum",
                                              "--end",   "0.3",         "--integrator", "rA-half-1",
                                              "--steps", "1e-2,5e-3",   "--no-plot"};

Ended study(const Scratch& in, const std::vector<std::string>& more)
{
    return call(in, with(convergence, more));
}

}  // namespace

TEST_CASE("a fine run of another integrator gives the same errors as the reference solution of the problem",
          "[studies][reference]")
{
    const Scratch in;
    REQUIRE(study(in, {"--quiet", "--output", "reference"}).code == 0);
    const Ended ended = study(in, {"--reference", "rA-half-2", "--reference-step", "1e-4", "--output", "a"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("reference solution: rA-half-2 at h = 0.0001 s"));
    REQUIRE(study(in, {"--reference", "rA-half-2", "--quiet", "--output", "b"}).code == 0);
    const auto reference_solution = csv(in / "reference/study.csv"), fine = csv(in / "a/study.csv"),
               usual = csv(in / "b/study.csv");
    REQUIRE(reference_solution.size() == 2);
    for (size_t k = 0; k < 2; ++k)
        for (const char* norm : {"r", "A", "Q"}) {
            CAPTURE(k, norm);
            CHECK(number(fine[k], norm) == Approx(number(reference_solution[k], norm)).epsilon(0.01));
            CHECK(number(usual[k], norm) == Approx(number(reference_solution[k], norm)).epsilon(0.05));
        }
}

TEST_CASE("a reference that is coarser than a run is rejected without --accept-reference",
          "[studies][reference]")
{
    const Scratch in;
    for (const char* step : {"5e-3", "1e-2"}) {
        for (const char* message : {"study convergence: the reference rA-half-2 at h = ", "coarser", "5e-3"})
            check_refused(in, with(convergence, {"--reference", "rA-half-2", "--reference-step", step}), 2,
                          message);
    }
    const Ended forced = study(in, {"--reference", "rA-half-2", "--reference-step", "1e-3", "--steps", "1e-3",
                                    "--accept-reference"});
    CHECK(forced.code != 0);  // --steps is given twice
    CHECK(call(in, {"study", "compare", "--end", "0.1", "--steps", "1e-3", "--integrator", "rA-half-1",
                    "--reference", "rA-half-2", "--reference-step", "1e-3", "--no-plot", "--quiet"})
              .code == 2);
    CHECK(call(in, {"study", "compare", "--end", "0.1", "--steps", "1e-3", "--integrator", "rA-half-1",
                    "--reference", "rA-half-2", "--reference-step", "1e-3", "--no-plot", "--quiet",
                    "--accept-reference"})
              .code == 0);
}

TEST_CASE("an invalid reference is reported in one line", "[studies][reference]")
{
    const Scratch in;
    const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
        check_refused(in, with(convergence, more), 2, message);
    };
    refused({"--reference", "rA-half2"},
            "--reference: unknown integrator 'rA-half2'; did you mean 'rA-half-2'?");
    refused({"--reference", "rA-half-1,rA-half-2"}, "must be one integrator");
    refused({"--reference-step", "1e-4"}, "--reference NAME");
    refused({"--reference", "rA-half-2", "--reference-step", "0"}, "--reference-step: must be a positive");
    refused({"--reference", "rA-half-2", "--reference-step", "3e-4"}, "must divide");
    refused({"--reference", "rA-half-2", "--reference-rtol", "1e-12"}, "has a fixed step");
    refused({"--reference", "rA-half-2", "--reference-rtol", "1e-15"}, "--reference-rtol");
    for (const std::string& name : adaptive_schemes())
        refused({"--reference", name, "--reference-step", "1e-4"}, "chooses its own steps");
}

TEST_CASE("adaptive schemes are references and evaluated runs by their tolerance", "[studies][reference]")
{
    studies::StudyOptions options;
    options.quiet = true;
    options.end = 0.3;
    options.jobs = 1;
    std::vector<studies::Benchmark> all = studies::benchmarks("test", options, {"double_pendulum"});
    const studies::Study study{.name = "test", .answers = "", .run = {}};
    const studies::StudyContext context(study, options);
    studies::Reference(context, {}).evaluate(all);

    studies::EvaluatedRun coarse, fine;
    for (studies::EvaluatedRun* run : {&coarse, &fine}) {
        run->c = &all.front(), run->scheme = &inner_steps;
        run->h = all.front().instants.dt * all.front().instants.stride;
    }
    coarse.rtol = 1e-4, fine.rtol = 1e-6;
    evaluate(coarse, options.settings);
    evaluate(fine, options.settings);
    CHECK(coarse.status == "ok");
    CHECK(coarse.errors.instants == 30);
    CHECK(fine.statistics.steps > 5 * coarse.statistics.steps);
    CHECK(fine.errors.value[studies::norm::r] < 0.05 * coarse.errors.value[studies::norm::r]);
    CHECK(fine.name() == "inner-steps on double_pendulum at rtol = 1e-6");

    for (const std::string& name : adaptive_schemes()) {
        options.reference = name;
        CHECK_NOTHROW(studies::Reference(context, {.smallest_step = 1e-4, .smallest_rtol = 1e-11}));
        CHECK_THROWS_AS(studies::Reference(context, {.smallest_step = 1e-4, .smallest_rtol = 9e-12}),
                        io::UsageError);
        options.reference_rtol = 1e-8;
        CHECK_THROWS_AS(studies::Reference(context, {.smallest_rtol = 5e-8}), io::UsageError);
        CHECK_NOTHROW(studies::Reference(context, {.smallest_step = 1e-4}));
        options.reference_rtol.reset();
    }
}

TEST_CASE("adaptive schemes are accepted as --reference and rejected by studies of fixed steps",
          "[studies][reference]")
{
    const Scratch in;
    for (const std::string& name : adaptive_schemes()) {
        CAPTURE(name);
        const Ended evaluated = study(in, {"--reference", name, "--output", "a-" + name});
        CAPTURE(evaluated.err);
        CHECK(evaluated.code == 0);
        CHECK_THAT(evaluated.out, Contains("reference solution: " + name + " at rtol 1e-12"));
        for (const char* kind : {"convergence", "energy", "iterations", "timing", "scaling"}) {
            check_refused(in, {"study", kind, "--integrator", name}, 2, "work-precision");
        }
    }
}

TEST_CASE("a model file with friction is compared with a finer run of a fixed-step integrator",
          "[studies][reference]")
{
    const Scratch in;
    REQUIRE(call(in, {"models", "rolling_ball", "--write", "ball.json"}).code == 0);
    const Ended ended = call(in, {"study", "compare", "--problem", "ball.json", "--integrator",
                                  "rA-half-1,rA-half-2", "--end", "0.1", "--no-plot"});
    CAPTURE(ended.err);
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("reference solution: rA-half-1-momentum at h = 0.0001 s"));
    CHECK_THAT(ended.err, Contains("hilda: warning: ball: the internal states") &&
                              Contains("--reference selects another"));
    // the reference of a scheme of fourth order, and one that is selected
    const Ended fourth = call(in, {"study", "compare", "--problem", "ball.json", "--integrator", "rA-rkmk-4",
                                   "--end", "0.1", "--no-plot", "--force"});
    CHECK_THAT(fourth.out, Contains("reference solution: rA-rkmk-4 at h = 0.0001 s"));
    const Ended selected = call(in, {"study", "compare", "--problem", "ball.json", "--end", "0.1",
                                     "--no-plot", "--force", "--reference", "rA-half-2"});
    CHECK_THAT(selected.out, Contains("reference solution: rA-half-2 at h = 0.0001 s"));
    CHECK(selected.err.empty());
}
