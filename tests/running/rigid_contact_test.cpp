// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of models with rigid contacts: default integrator, outputs, warnings, resumption.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

const std::string box_on_slope = R"json({"hilda_model": 1, "name": "box", "end": 0.1,
 "gravity": ["9.81*sin(pi/9)", 0, "-9.81*cos(pi/9)"],
 "bodies": [{"name": "box", "mass": 2, "shape": {"box": [0.2, 0.2, 0.1]}, "r": [0, 0, 0.05], "r_dot": [1.5, 0, 0]}],
 "contacts": [{"name": "box-floor", "body_i": "box", "body_j": "ground",
   "surface_i": {"type": "box", "lengths": [0.2, 0.2, 0.1]}, "surface_j": {"type": "plane"},
   "normal": {"type": "dvi"}, "friction": {"law": "coulomb", "mu_s": 0.5}}]})json";

/// Nine boxes that fall on each other and on the floor with random attitudes
std::string pile()
{
    std::string bodies;
    for (int k = 0; k < 9; ++k) {
        const int row = k / 3;
        bodies += std::string(k > 0 ? ", " : "") + R"({"name": "b)" + std::to_string(k) +
                  R"(", "mass": 1, "shape": {"box": [0.1, 0.1, 0.1]}, "r": [)" +
                  std::to_string(0.18 * (k % 3)) + ", " + std::to_string(0.18 * row) + ", " +
                  std::to_string(0.1 + 0.02 * (k % 4)) + R"(], "axis_angle": [0.6, 0, 0.8, )" +
                  std::to_string(0.3 * k) + R"(], "omega": [1, )" + std::to_string(k - 4) + ", 0.5]}";
    }
    const std::string law =
        R"("normal": {"type": "dvi", "restitution": 0.2}, "friction": {"law": "coulomb", )"
        R"("mu_s": 0.5, "mu_k": 0.4}})";
    const std::string box = R"({"type": "box", "lengths": [0.1, 0.1, 0.1]})";
    return R"({"hilda_model": 1, "name": "pile", "end": 0.3, "bodies": [)" + bodies +
           R"(], "contacts": [{"name": "boxes", "bodies": "all", "surface": )" + box + ", " + law +
           R"(, {"name": "floor", "body_i": "all", "body_j": "ground", "surface_i": )" + box +
           R"(, "surface_j": {"type": "plane"}, )" + law + "]}";
}

}  // namespace

TEST_CASE("a box on a floor runs without an option, and its contact points are written", "[run][rigid]")
{
    const Scratch in;
    write(in / "box.json", box_on_slope);
    const Ended ended = call(in, {"run", "box.json", "--contacts", "--output", "a"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK(ended.err.empty());
    CHECK_THAT(ended.out, Contains("rA-moreau-1, step 1e-3 s") && Contains("contact law"));
    const auto of = summary(in / "a");
    CHECK(of["integrator"]["name"] == "rA-moreau-1");
    CHECK(of["rigid_contacts"]["friction_relaxed"] == 0);
    CHECK(of["rigid_contacts"]["restitution_reduced"] == 0);
    CHECK(of["rigid_contacts"]["law_residual"] < 1e-9);
    CHECK(of["rigid_contacts"]["overlap"] < 1e-9);
    const auto resultants = csv(in / "a/contacts.csv"), points = csv(in / "a/contact-points.csv");
    REQUIRE(!resultants.empty());
    const double weight = 2 * 9.81 * std::cos(std::acos(-1.) / 9);
    CHECK(number(resultants.back(), "box-floor.F_N") == Approx(weight));
    CHECK(number(resultants.back(), "box-floor.Ff_x") == Approx(-0.5 * weight));
    CHECK(number(resultants.back(), "box-floor.slipping") == 1);
    REQUIRE(points.size() % 4 == 0);
    REQUIRE(points.size() >= 4);
    double N = 0;
    for (size_t k = points.size() - 4; k < points.size(); ++k) {
        CHECK(points[k].at("contact") == "box-floor");
        CHECK(number(points[k], "t") == Approx(0.1));
        CHECK(number(points[k], "nz") == Approx(1));
        CHECK(number(points[k], "slipping") == 1);
        N += number(points[k], "N");
    }
    CHECK(N == Approx(weight));

    check_refused(in, {"run", "box.json", "--integrator", "rA-half-2", "--output", "b"}, 3,
                  "does not support rigid contacts");
}

TEST_CASE("an interrupted and killed run of a pile gives the result of an uninterrupted one", "[run][rigid]")
{
    const Scratch in;
    write(in / "pile.json", pile());
    check_resumed(in, {"run", "pile.json", "--contacts", "--interval", "1e-3"},
                  {{SIGINT, 50}, {SIGKILL, 60}, {SIGTERM, 80}});
    const auto of = summary(in / "whole");
    CHECK(of["rigid_contacts"]["iterations"] > 100);
    CHECK(of["rigid_contacts"]["overlap"] < 1e-6);
}

TEST_CASE("a step in which thin bodies can pass through each other is a finding", "[run][rigid]")
{
    const Scratch in;
    write(in / "plates.json",
          R"({"hilda_model": 1, "name": "plates", "end": 0.01, "gravity": [0, 0, 0], "bodies": [
        {"name": "a", "mass": 1, "shape": {"box": [0.2, 0.2, 0.01]}, "r": [0, 0, 0]},
        {"name": "b", "mass": 1, "shape": {"box": [0.2, 0.2, 0.01]}, "r": [0, 0, 1], "r_dot": [0, 0, -15]}],
        "contacts": [{"name": "plates", "bodies": "all", "surface": {"type": "box", "lengths": [0.2, 0.2, 0.01]},
            "normal": {"type": "dvi"}}]})");
    const Ended ended = call(in, {"run", "plates.json", "--output", "a"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, Contains("body 'b' moves by 1.5 times the width of the thinnest body in one step"));
    const Ended strict = call(in, {"run", "plates.json", "--strict", "--output", "b"});
    CHECK(strict.code == 4);
    CHECK(summary(in / "b")["status"] == "large_motion");
}

TEST_CASE("a convex body is read from a file, and one that is not is refused", "[run][rigid]")
{
    // a box of 200 mm, 200 mm and 100 mm
    std::string corners;
    for (int k = 0; k < 8; ++k)
        corners += std::string("v ") + (k & 1 ? "100" : "-100") + (k & 2 ? " 100" : " -100") +
                   (k & 4 ? " 50\n" : " -50\n");
    const std::string faces = "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
    const Scratch in;
    write(in / "box.obj", corners + faces);
    write(in / "dent.obj", corners + "v 0 0 40\n" + faces);
    write(in / "plate.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n");
    const auto with_file = [](const std::string& file) {
        std::string model = box_on_slope;
        const std::string box = R"({"type": "box", "lengths": [0.2, 0.2, 0.1]})";
        return model.replace(model.find(box), box.size(),
                             R"({"type": "convex", "file": ")" + file + R"(", "scale": 1e-3})");
    };
    write(in / "box.json", with_file("box.obj"));
    const Ended checked = call(in, {"check", "box.json"});
    CAPTURE(checked.err);
    CHECK(checked.code == 0);
    CHECK_THAT(checked.out, Contains("box-floor") && Contains("4 contact points"));
    REQUIRE(call(in, {"run", "box.json", "--quiet", "--output", "a"}).code == 0);
    // model.json has the corners and repeats the run without the file
    fs::remove(in / "box.obj");
    CHECK(call(in, {"run", "a/model.json", "--quiet", "--output", "b"}).code == 0);
    CHECK(read(in / "a/trajectory.csv") == read(in / "b/trajectory.csv"));

    write(in / "dent.json", with_file("dent.obj"));
    check_refused(in, {"check", "dent.json"}, 3, "vertex 8, which lies 0.0100");
    write(in / "plate.json", with_file("plate.obj"));
    check_refused(in, {"check", "plate.json"}, 3, "must not lie in a plane");
}

TEST_CASE("references and kinematic analysis do not ignore rigid contacts", "[run][rigid]")
{
    const Scratch in;
    write(in / "box.json", box_on_slope);
    const Ended study = call(in, {"study", "convergence", "--problem", "box.json", "--integrator",
                                  "rA-moreau-1", "--steps", "2e-3,1e-3,5e-4", "--output", "a"});
    CAPTURE(study.err, study.out);
    CHECK(study.code == 0);
    CHECK_THAT(study.err, Contains("its rigid contacts exclude a reference solution with adaptive steps; the "
                                   "reference is rA-moreau-1 at h = "));
    CHECK(study.out.find("findings") == std::string::npos);
    const auto rows = csv(in / "a/study.csv");
    REQUIRE(rows.size() >= 3);
    CHECK(number(rows.back(), "order_r") == Approx(1).margin(0.15));
    CHECK(number(rows.back(), "r") < 1e-2);

    for (const char* command : {"kinematics", "inverse"})
        check_refused(in, {command, "box.json", "--output", "b"}, 3, "is for models without rigid contacts");
}
