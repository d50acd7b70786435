// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/frame_files.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "run/frames/vtk.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using Catch::Matchers::EndsWith;
using run::Drawing;
using run::FrameFiles;
using run::Snapshots;
using tests::call;
using tests::Ended;
using tests::Scratch;

namespace {

/// A ball that moves along a plane, whose drawn part grows with each frame
struct Ball {
    Snapshots all;
    std::vector<Drawing::Frame> frames;

    explicit Ball(int count, bool on_plane = true)
    {
        all.add_surface(0, {.surface = std::make_shared<contact::Sphere>(0.2)});
        if (on_plane) all.add_surface(-1, {.surface = std::make_shared<contact::Plane>()});
        for (int k = 0; k < count; ++k) {
            lie::Motion ball;
            ball.r = {0.1 * k, 0.03 * k, 0.2};
            frames.push_back({.t = 0.1 * k, .body = {ball}, .contacts = {}});
            if (k % 2 == 1)
                frames.back().contacts.push_back(
                    {1, 0, {0.1 * k, 0.03 * k, 0}, {0, 0, 9}, {-1, 0, 0}, true, false});
            all.add(frames[k].t, frames[k].body, frames[k].contacts);
        }
    }
};

std::map<std::string, std::string> files(const Scratch& in, const std::string& directory)
{
    return tests::results(in / directory);
}

size_t entries(const std::string& list)
{
    size_t count = 0;
    for (size_t at = 0; (at = list.find("<DataSet", at)) != std::string::npos; ++at) ++count;
    return count;
}

}  // namespace

TEST_CASE("frames that are written one after the other are those that are written at the end", "[run][vtk]")
{
    const Scratch in;
    for (const bool on_plane : {true, false}) {
        const Ball ball(7, on_plane);
        const std::string name = on_plane ? "plane" : "free", at_end = name + "-end";
        tests::fs::create_directory(in / name), tests::fs::create_directory(in / at_end);
        ball.all.write((in / at_end).string(), "run");
        FrameFiles files_of(ball.all, (in / name).string(), "run");
        files_of.open();
        for (size_t k = 0; k < ball.frames.size(); ++k) {
            CHECK(entries(tests::read(in / (name + "/run.pvd"))) == k);
            files_of.add(ball.frames[k]);
            CHECK(tests::fs::exists(in / name / run::frame_file("run", k)));
            CHECK_THAT(tests::read(in / (name + "/run.pvd")), EndsWith("</Collection>\n</VTKFile>\n"));
        }
        const std::string list = tests::read(in / (name + "/run.pvd"));
        files_of.close();
        CHECK(tests::read(in / (name + "/run.pvd")) == list);
        CHECK(files(in, name) == files(in, at_end));
        CHECK(tests::fs::exists(in / (name + "/checkpoint.run")) == on_plane);
        FrameFiles::remove((in / name).string(), "run");
        CHECK(files(in, name).empty());
        CHECK_FALSE(tests::fs::exists(in / (name + "/checkpoint.run")));
    }
}

TEST_CASE("frames continue from a checkpoint, without those after it", "[run][vtk][resume]")
{
    const Scratch in;
    const Ball longer(9), shorter(6);
    std::string saved;
    tests::fs::create_directory(in / "parts"), tests::fs::create_directory(in / "whole");
    const std::string parts = (in / "parts").string();
    {
        FrameFiles first(longer.all, parts, "run");
        first.open();
        for (size_t k = 0; k < 8; ++k) {
            if (k == 4) {
                first.sync();
                io::Archive a;
                first.transfer(a);
                saved = a.bytes();
            }
            first.add(longer.frames[k]);
        }
    }  // killed
    FrameFiles resumed(longer.all, parts, "run");
    io::Archive a(saved, "checkpoint");
    resumed.transfer(a);
    a.end();
    CHECK(entries(tests::read(in / "parts/run.pvd")) == 4);
    for (size_t k = 4; k < 6; ++k) resumed.add(longer.frames[k]);
    resumed.close();
    shorter.all.write((in / "whole").string(), "run");
    CHECK(files(in, "parts") == files(in, "whole"));

    tests::fs::resize_file(in / "parts/checkpoint.run", 100);
    io::Archive again(saved, "checkpoint");
    FrameFiles damaged(longer.all, parts, "run");
    CHECK_THROWS_AS(damaged.transfer(again), io::IoError);
}

TEST_CASE("a killed run has written its frames and their list", "[run][vtk][run]")
{
    const Scratch in;
    // The ball moves on a plane; the crank has no unbounded surface.
    for (const std::string model : {"rolling_ball", "slider_crank"}) {
        const std::vector<std::string> run = {"run", model, "--end", "0.2", "--vtk", "0.02", "--quiet"};
        const Ended ended =
            call(in, tests::with(run, {"--output", model}),
                 {.end_at = {.signal = SIGKILL, .write = 1, .file = "vtk/run-000005.vtp.tmp"}});
        CAPTURE(model, ended.err);
        REQUIRE(ended.code == 128 + SIGKILL);
        CHECK(entries(tests::read(in / (model + "/run.pvd"))) == 5);
    }
}

TEST_CASE("a run with frames is extended to the files of a run to the later end", "[run][vtk][resume]")
{
    const Scratch in;
    // 0.13 s is no multiple of the time between the frames: the first run has a frame at its end.
    const std::vector<std::string> run = {"run",   "rolling_ball", "--interval", "0.01",
                                          "--vtk", "0.02",         "--quiet"};
    REQUIRE(call(in, tests::with(run, {"--end", "0.13", "--output", "parts"})).code == 0);
    REQUIRE(call(in, tests::with(run, {"--end", "0.3", "--output", "parts", "--resume"})).code == 0);
    REQUIRE(call(in, tests::with(run, {"--end", "0.3", "--output", "whole"})).code == 0);
    tests::check_same_results(in / "parts", in / "whole");
}
