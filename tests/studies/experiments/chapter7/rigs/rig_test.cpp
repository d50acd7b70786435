// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter7/rigs/rig.hpp"

#include "studies/framework/study_context.hpp"
#include "studies/framework/study_options.hpp"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace hilda;
using namespace hilda::studies;

namespace {

constexpr double g = 9.81, m = 0.5, radius = 0.03;

/// A ball that falls on the bed, and its boundary
io::Json ball_on(double height)
{
    io::Json ball = {{"name", "ball"},
                     {"mass", m},
                     {"inertia", {2e-4, 2e-4, 2e-4}},
                     {"r", {0.05, 0.05, height + radius + 2e-3}}};
    return {{"hilda_model", 1},
            {"name", "ball"},
            {"gravity", {0, 0, -g}},
            {"end", 1},
            {"bodies", io::Json::List{ball}}};
}

}  // namespace

TEST_CASE("a ball comes to rest on the bed of a rig: its load is its weight, and its work that of the grains",
          "[studies][rig]")
{
    const std::string folder = std::filesystem::temp_directory_path() / "hilda-rig-test";
    Study study;
    study.name = "rig";
    StudyOptions options;
    options.output = folder, options.force = options.quiet = true;
    std::filesystem::create_directories(folder);
    const StudyContext context(study, options);
    const RigBed bed{.length = 0.1, .width = 0.1, .depth = 0.06, .R = 6e-3, .k = 1e6, .h = 4e-5};
    Rigs rigs(context);
    const double top = rigs.settle(bed);
    CHECK(top > 0.03);
    CHECK(top < 0.06);
    const io::Json sphere = {
        {"name", "ball"}, {"type", "sphere"}, {"radius", radius}, {"r", {0.05, 0.05, top + radius + 2e-3}}};
    io::Json pair;
    pair["body"] = "ball";
    const RigRun run = rigs.run("ball at rest", bed, ball_on(top), io::Json::List{sphere}, pair, 2, 1.2);
    CHECK(run.mean("ball.Fz", 0.8) == Approx(m * g).epsilon(2e-3));
    // It has lost the potential energy of its fall to the grains.
    const double fall = top + radius + 2e-3 - run.last("ball.z");
    CHECK(-run.last("ball.work") == Approx(m * g * fall).epsilon(5e-3));
    // The energy balance of the grains takes the mean of the velocities before and after the loads of a step.
    CHECK(run.work_on_grains ==
          Approx(-(run.last("ball.work") - run.last("ball.energy_error"))).epsilon(0.01));
    CHECK(run.x.size() == run.speed.size());
    CHECK(std::filesystem::exists(folder + "/runs/ball-at-rest/cosim.json"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("rows of a matrix are added to a table after the cells of a key", "[studies][rig]")
{
    Table table({{"name"}, {"a"}, {"b"}});
    add_rows(table, {"x"}, {1, 2, 3, 4}, 2);
    CHECK(table.csv() == "name,a,b\nx,1,2\nx,3,4\n");
}
