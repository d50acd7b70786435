// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries of triangles in a case file.
#include "granular/case/case_file.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace hilda;
using namespace hilda::tests;

namespace {

const std::filesystem::path folder = std::filesystem::temp_directory_path() / "hilda_mesh_keys_test";

/// Reads a case with a mesh of these members.
granular::Case read_mesh_case(const std::string& members,
                              const std::string& periodic = "[false, false, false]")
{
    const std::string text =
        R"({"hilda_case": 1, "domain": {"low": [-1, -1, -1], "high": [1, 1, 1], "periodic": )" + periodic +
        R"(}, "step": 1e-5, "end": 1e-3, "interval": 1e-4,
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}], "laws": [{"between": ["glass", "glass"], "restitution": 0.8}],
        "particles": [{"r": [0, 0, 0.9], "radius": 0.01}], "boundaries": [{"type": "mesh", )" +
        members + "}]}";
    granular::Environment environment;
    environment.folder = folder.string();
    return granular::read_case(text, "case.json", environment);
}

std::string error_of(const std::string& members)
{
    try {
        read_mesh_case(members);
    } catch (const std::exception& e) {
        return e.what();
    }
    return "";
}

std::size_t triangles(const std::string& members)
{
    return read_mesh_case(members).world->all_meshes().triangle.size();
}

}  // namespace

TEST_CASE("a case file describes meshes by files and shapes", "[granular][mesh][case]")
{
    CHECK(triangles(R"("box": {"low": [0, 0, 0], "high": [1, 1, 1]})") == 12);
    CHECK(triangles(R"("box": {"low": [0, 0, 0], "high": [1, 1, 1], "open": ["+z"], "edge": 0.5})") == 40);
    CHECK(triangles(R"("lathe": {"profile": [[0.1, 0], [0.2, 0.3]], "segments": 10})") == 20);
    CHECK(triangles(R"("extrude": {"outline": [[0, 0], [1, 0], [0, 1]], "length": 0.5})") == 8);
    CHECK(triangles(R"("plate": {"width_x": 1, "width_y": 0.5, "edge": 0.5})") == 4);
    CHECK(triangles(R"("sphere": {"radius": 0.1, "divisions": 1})") == 80);

    std::filesystem::create_directories(folder);
    std::ofstream(folder / "one.obj") << "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n";
    const granular::Case c =
        read_mesh_case("\"file\": \"" + (folder / "one.obj").string() +
                       R"(", "scale": 0.001, "r": [0, 0, 0.5], "rotation": [0, 0, 1], "omega": [0, 0, 2])");
    REQUIRE(c.world->all_meshes().vertex.size() == 3);
    CHECK(c.world->all_meshes().vertex[1].x == Approx(1));
    CHECK(c.world->all_boundaries()[0].p.e0 == Approx(std::cos(0.5)));
    CHECK(c.world->all_boundaries()[0].r.z == 0.5);
}

TEST_CASE("wrong meshes of a case file are refused with their place", "[granular][mesh][case]")
{
    const auto contains = [](const std::string& members, const std::string& part) {
        const std::string error = error_of(members);
        INFO(members << "\n" << error);
        CHECK(error.find(part) != std::string::npos);
    };
    contains(R"("name": "m")", "a mesh needs one of the keys file, box, lathe, extrude, plate, sphere");
    contains(R"("plate": {"width_x": 1, "width_y": 1}, "sphere": {"radius": 1})",
             "sphere must not be given together with plate");
    contains(R"("plate": {"width_x": -1, "width_y": 1})", "/boundaries/0/plate/width_x");
    contains(R"("plate": {"width_x": 1, "width_y": 1, "width_z": 1})", "width_z");
    contains(R"("box": {"low": [0, 0, 0], "high": [1, 0, 1]})", "/boundaries/0/box");
    contains(R"("lathe": {"profile": [[0.1, 0]]})", "profile must have at least 2 points, got 1");
    contains(R"("lathe": {"profile": [[0.1, 0], [0.1]]})",
             "/boundaries/0/lathe/profile/1 must be two numbers");
    contains(R"("lathe": {"profile": [[0.1, 0], [-0.1, 1]]})", "/boundaries/0/lathe");
    contains(R"("lathe": {"profile": [[0.1, 0], [0.1, 1]], "segments": 2})", "got 2");
    contains(R"("sphere": {"radius": 1, "divisions": 40})", "got 40");
    contains(R"("plate": {"width_x": 1, "width_y": 1, "edge": 1e-9})", "triangles");
    contains("\"file\": \"" + (folder / "missing.stl").string() + '"', "missing.stl");
    const std::vector<std::pair<std::string, std::string>> files = {
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 2\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", "triangle 2"},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "triangle 0 must have an area"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n",
         "must have the orientation of its neighbours"},
        {"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ":1: "},
        {"", "a mesh must have a triangle"},
    };
    for (const auto& [text, part] : files) {
        std::ofstream(folder / "wrong.obj") << text;
        contains("\"file\": \"" + (folder / "wrong.obj").string() + '"', part);
    }
}

TEST_CASE("density gives a mesh the mass, the centre and the inertia of its solid",
          "[granular][mesh][tool][case]")
{
    const std::string box = R"("box": {"low": [0, 0, 0], "high": [0.2, 0.4, 0.6], "inside": false})";
    const granular::Case c = read_mesh_case(box + R"(, "density": 1000, "r": ["0.1*t", 0.05, 0],
                                  "rotation": [0, 0, 1.5707963267948966])");
    const granular::Boundary& b = c.world->all_boundaries()[0];
    const double m = 48;
    CHECK(b.mass == Approx(m));
    CHECK(b.inertia.xx == Approx(m / 12 * (0.16 + 0.36)));
    CHECK(b.inertia.yy == Approx(m / 12 * (0.04 + 0.36)));
    CHECK(b.inertia.zz == Approx(m / 12 * (0.04 + 0.16)));
    CHECK(std::abs(b.inertia.xy) + std::abs(b.inertia.yz) + std::abs(b.inertia.zx) < 1e-15);
    // the corner is at r, the box turned by 90 degrees about z
    CHECK((b.r - granular::Vec3{-0.2, 0.15, 0.3}).norm() < 1e-15);
    CHECK((c.world->all_meshes().vertex[0].norm() == Approx(std::sqrt(0.01 + 0.04 + 0.09))));

    const granular::Case given =
        read_mesh_case(box + R"(, "mass": 2, "centre": [0.1, 0.1, 0.1], "inertia": [[2, 0.1, 0],
        [0.1, 3, 0.2], [0, 0.2, 2.5]], "free": [true, false, true, false, true, false], "omega": ["t", 0, 0])");
    const granular::Boundary& g = given.world->all_boundaries()[0];
    CHECK(g.inertia.xy == 0.1);
    CHECK(g.inertia.yz == 0.2);
    CHECK(g.inertia.zx == 0);
    CHECK(g.free == std::array{true, false, true, false, true, false});
    CHECK(g.r.z == 0.1);

    const auto contains = [&](const std::string& members, const std::string& part) {
        const std::string error = error_of(members);
        INFO(members << "\n" << error);
        CHECK(error.find(part) != std::string::npos);
    };
    contains(box + R"(, "density": 1000, "mass": 1)", "density must not be given together with mass");
    contains(R"("box": {"low": [0, 0, 0], "high": [1, 1, 1]}, "density": 1000)",
             "density needs a mesh with normals out of a solid, got one that encloses -1 m^3");
    contains(R"("plate": {"width_x": 1, "width_y": 1}, "density": 1000)",
             "density needs a closed mesh, got one with 4 open edges");
    contains(box + R"(, "centre": [0, 0, 0.1])", "unknown key \"centre\"");
    contains(box + R"(, "density": 1000, "inertia": [1, 1, 3])",
             "(/boundaries/0/inertia): the principal moments of inertia must be positive");
    contains(box + R"(, "density": 1000, "free": [true, true])", "free must be a list of 3 or 6 values");
    contains(box + R"(, "density": 1000, "omega": [0, "t", 0])",
             "omega must be three numbers if the boundary rotates freely about all axes");
}

TEST_CASE("a mesh that reaches a periodic side gives a warning", "[granular][mesh][case]")
{
    const std::string plate = R"("plate": {"width_x": 2, "width_y": 2})";
    const auto notices = [&](const std::string& periodic) { return read_mesh_case(plate, periodic).notices; };
    CHECK(notices("[false, false, false]").empty());
    REQUIRE(notices("[false, true, false]").size() == 1);
    CHECK(notices("[false, true, false]")[0].find("reaches a periodic side along y") != std::string::npos);
}

TEST_CASE("a mesh in other units than the case gives a warning", "[granular][mesh][case]")
{
    CHECK(read_mesh_case(R"("sphere": {"radius": 0.1})").notices.empty());
    const auto notice = [](const std::string& radius) {
        const auto all = read_mesh_case("\"sphere\": {\"radius\": " + radius + "}").notices;
        return all.size() == 1 ? all[0] : "";
    };
    CHECK(notice("1000").find("m long, the domain 3.46") != std::string::npos);
    CHECK(notice("1e-4").find("m long, the diameter of a particle 0.02 m") != std::string::npos);
}

TEST_CASE("particles outside of a closed mesh that faces inwards are noticed", "[granular][mesh][case]")
{
    const auto notices = [](const std::string& members) { return read_mesh_case(members).notices; };
    // The particle is at (0, 0, 0.9).
    const std::vector<std::string> below =
        notices(R"("box": {"low": [-0.5, -0.5, -0.5], "high": [0.5, 0.5, 0.5]})");
    REQUIRE(below.size() == 1);
    CHECK_THAT(below[0],
               Catch::Contains("the mesh is closed and its normals point inwards, but 1 of 1 particles "
                               "are outside of it"));
    CHECK(notices(R"("box": {"low": [-0.5, -0.5, -0.5], "high": [0.5, 0.5, 0.95]})").empty());
    CHECK(notices(R"("box": {"low": [-0.5, -0.5, -0.5], "high": [0.5, 0.5, 0.5], "inside": false})").empty());
    CHECK(notices(R"("box": {"low": [-0.5, -0.5, -0.5], "high": [0.5, 0.5, 0.5], "open": ["+z"]})").empty());
    CHECK(
        notices(R"("box": {"low": [-0.5, -0.5, -0.5], "high": [0.5, 0.5, 0.5]}, "two_sided": true)").empty());
}

TEST_CASE("meshes are repaired on request, and two-sided ones may have three triangles at an edge",
          "[granular][mesh][case]")
{
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / "repair.obj";
    const auto notices = [&](const std::string& faces, const std::string& members) {
        std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 -1\n" << faces;
        return read_mesh_case("\"file\": \"" + file.string() + "\", " + members).notices;
    };
    const std::string flipped = "f 1 2 3\nf 1 2 4\n", three = "f 1 2 3\nf 2 1 4\nf 1 2 5\n";
    CHECK_THROWS_WITH(notices(flipped, R"("repair": false)"),
                      Catch::Contains("orientation of its neighbours"));
    const std::vector<std::string> turned = notices(flipped, R"("repair": true)");
    REQUIRE(turned.size() == 1);
    CHECK_THAT(turned[0], Catch::Contains("1 triangles are turned to the orientation of their neighbours"));
    CHECK(notices(flipped, R"("two_sided": true)").empty());
    CHECK_THROWS_WITH(notices(three, R"("repair": true)"),
                      Catch::Contains("or the mesh be two_sided, got 3"));
    CHECK(notices(three, R"("two_sided": true)").empty());
    const std::vector<std::string> copies = notices(three + "f 2 1 3\n", R"("two_sided": true)");
    REQUIRE(copies.size() == 1);
    CHECK_THAT(copies[0], Catch::Contains("1 triangles with the vertices of another one are removed"));
    std::filesystem::remove(file);
}
