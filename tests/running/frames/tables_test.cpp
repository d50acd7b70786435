// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/tables.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "io/json_source.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace hilda;
using lie::Vec3;
using run::Snapshots;

namespace {

/// A sphere of 0.5 m on the plane z = 0 that moves along x with 2 m/s, at 0, 0.1, ... 0.5 s
Snapshots rolling_sphere()
{
    Snapshots snapshots;
    snapshots.add_surface(0, {.surface = std::make_shared<contact::Sphere>(0.5)});
    snapshots.add_surface(-1, {.surface = std::make_shared<contact::Plane>()});
    snapshots.add_joint(0, {0, 0, 0.25});
    snapshots.add_line({0, -1, {0.5, 0, 0}, {3, 0, 1}}, Snapshots::spring);
    for (int k = 0; k <= 5; ++k) {
        lie::Motion ball;
        const double t = 0.1 * k;
        ball.r = {2 * t, 0, 0.5};
        ball.rdot = {2, 0, 0};
        ball.A = lie::exp(Vec3(0, 4 * t, 0));
        snapshots.add(t, {ball},
                      {{.contact = 0,
                        .i = 0,
                        .C = {2 * t, 0, 0},
                        .N = {0, 0, 10},
                        .F = {-1, 0, 0},
                        .slipping = false,
                        .rolling = false,
                        .u = {1, 0, 0}}});
    }
    return snapshots;
}

std::vector<std::vector<std::string>> rows_of(const std::string& csv)
{
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(csv);
    for (std::string line; std::getline(in, line);) {
        rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

}  // namespace

TEST_CASE(
    "the tables of snapshots have the poses and contacts of all frames and mark the nearest to the times",
    "[run][vtk]")
{
    const auto run = run::snapshot_tables(rolling_sphere(), "a, b", {"ball"}, {"ball-floor"}, {0, 0.32});
    const auto files = run::snapshot_files("x-", {run, {}});
    REQUIRE(files.size() == 3);
    CHECK(files[0].first == "x-poses.csv");
    const auto poses = rows_of(run.poses);
    REQUIRE(poses.size() == 6);
    const auto header = rows_of(files[0].second)[0];
    REQUIRE(poses[3].size() == header.size() + 1);  // the name contains a comma, in quotes
    const auto number = [&](size_t row, const std::string& column) {
        const auto at = std::find(header.begin(), header.end(), column);
        REQUIRE(at != header.end());
        return std::stod(poses[row][static_cast<size_t>(at - header.begin()) + 1]);
    };
    for (size_t k = 0; k < poses.size(); ++k) {
        const double t = 0.1 * static_cast<double>(k);
        CHECK(number(k, "t") == Approx(t).margin(1e-15));
        CHECK(number(k, "shown") == (k == 0 || k == 3 ? 1 : 0));
        CHECK(number(k, "rx") == Approx(2 * t).margin(1e-15));
        CHECK(number(k, "A13") == Approx(std::sin(4 * t)).margin(1e-14));  // a rotation about y
        CHECK(number(k, "A31") == Approx(-std::sin(4 * t)).margin(1e-14));
        CHECK(number(k, "vx") == 2);
    }
    CHECK(rows_of(run.contacts)[1] == std::vector<std::string>{"\"a", " b\"", "ball-floor", "0.1", "0", "0.2",
                                                               "0", "0", "1", "0", "0", "0", "0", "10", "-1",
                                                               "0", "0"});
    CHECK(run::snapshot_files("", {{}, {}}).empty());
}

TEST_CASE("the shapes of snapshots are the meshes of the frames, in the body frames", "[run][vtk]")
{
    const auto files =
        run::snapshot_files("", {run::snapshot_tables(rolling_sphere(), "r", {"ball"}, {"c"}, {})});
    const io::JsonSource shapes(files.at(2).second, "shapes.json");
    const io::Json& run = shapes.root.at(0);
    CHECK(*run.member("run")->value.string() == "r");
    const io::Json &meshes = run.member("meshes")->value, &line = run.member("lines")->value.at(0);
    REQUIRE(meshes.size() == 2);
    const auto number = [](const io::Json& list, size_t k) { return *list.at(k).number(); };
    for (const io::Json& mesh : *meshes.list()) {
        const bool is_plane = *mesh.member("unbounded")->value.boolean();
        CHECK(*mesh.member("body")->value.number() == (is_plane ? -1 : 0));
        const io::Json& points = mesh.member("points")->value;
        double left = 0, right = 0;
        for (const io::Json& p : *points.list()) {
            const Vec3 a(number(p, 0), number(p, 1), number(p, 2));
            if (is_plane)
                CHECK(a.z() == 0);
            else
                CHECK(a.norm() == Approx(0.5));
            left = std::min(left, a.x()), right = std::max(right, a.x());
        }
        CHECK(left <= -0.499);
        CHECK(right >= (is_plane ? 1.5 : 0.499));  // the plane reaches to the end of the path
        for (const io::Json& polygon : *mesh.member("polygons")->value.list())
            for (const io::Json& k : *polygon.list()) CHECK(*k.number() < static_cast<double>(points.size()));
    }
    CHECK(number(run.member("joints")->value.at(0).member("point")->value, 2) == 0.25);
    CHECK(*line.member("kind")->value.string() == "spring");
    CHECK(*line.member("body_j")->value.number() == -1);
    CHECK(number(line.member("point_j")->value, 0) == 3);
}
