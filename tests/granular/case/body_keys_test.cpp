// SPDX-License-Identifier: GPL-3.0-or-later
// Finite boundaries, parts of bodies and densities in a case file.
#include "granular/case/case_file.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/mesh/solid_body.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Inertia;

namespace {

granular::Case read_bodies(const std::string& boundaries,
                           const std::string& particles = R"([{"r": [0, 0, 0.9], "radius": 0.01}])")
{
    return granular::read_case(
        R"({"hilda_case": 1, "domain": {"low": [-1, -1, -1], "high": [1, 1, 1]}, "step": 1e-5, "end": 1e-3,
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
        "laws": [{"between": ["glass", "glass"], "restitution": 0.8}], "particles": )" +
            particles + R"(, "boundaries": [)" + boundaries + "]}",
        "case.json");
}

void check_error(const std::string& boundaries, const std::string& expected)
{
    std::string what;
    try {
        read_bodies(boundaries);
    } catch (const std::exception& e) {
        what = e.what();
    }
    INFO(boundaries);
    CHECK_THAT(what, Catch::Contains(expected));
}

double difference(const Inertia& a, const Inertia& b)
{
    return std::max({std::abs(a.xx - b.xx), std::abs(a.yy - b.yy), std::abs(a.zz - b.zz),
                     std::abs(a.xy - b.xy), std::abs(a.yz - b.yz), std::abs(a.zx - b.zx)});
}

}  // namespace

TEST_CASE("the mass properties of solids are those of fine meshes", "[granular][case][tool]")
{
    constexpr int n = 256;
    const auto compare = [&](const granular::SolidBody& solid, const granular::TriangleMesh& mesh) {
        const granular::MassProperties p = granular::mass_properties(mesh);
        CHECK(solid.mass == Approx(p.volume).epsilon(1e-3));
        CHECK((solid.centre - p.centre).norm() < 1e-5);
        CHECK(difference(solid.inertia, Inertia(p.J)) < 2e-3 * solid.inertia.xx);
    };
    const Vec3 z{0, 0, 1};
    compare(granular::solid_ball(1, 0.3), granular::sphere_mesh(0.3, 6));
    compare(granular::solid_frustum(1, z, 0.5, 0.3, 0.1),
            granular::lathe_mesh({{0, 0.5}, {0.1, 0.5}, {0.3, 0}, {0, 0}}, n));
    compare(granular::solid_frustum(1, z, 0.5, 0, 0.4),
            granular::lathe_mesh({{0, 0.5}, {0.4, 0.5}, {0, 0}}, n));
    std::vector<std::array<double, 2>> tube;
    for (int k = 0; k <= n; ++k) {
        const double angle = -2 * std::numbers::pi * (k % n) / n;
        tube.push_back({0.4 + 0.1 * std::cos(angle), 0.1 * std::sin(angle)});
    }
    compare(granular::solid_torus(1, z, 0.1, 0.4), granular::lathe_mesh(tube, n));
}

TEST_CASE("a frustum cut in two has the mass properties of the whole", "[granular][case][tool]")
{
    const Vec3 axis = (1 / 3.) * Vec3{1, 2, 2};
    const granular::SolidBody whole = granular::solid_frustum(2, axis, 1, 0.3, 0.6),
                              low = granular::solid_frustum(2, axis, 0.4, 0.3, 0.42),
                              high = granular::solid_frustum(2, axis, 0.6, 0.42, 0.6);
    const granular::SolidBody sum =
        granular::sum({{low, low.centre, {1, {0, 0, 0}}}, {high, 0.4 * axis + high.centre, {1, {0, 0, 0}}}});
    CHECK(sum.mass == Approx(whole.mass).epsilon(1e-14));
    CHECK((sum.centre - whole.centre).norm() < 1e-15);
    CHECK(difference(sum.inertia, whole.inertia) < 1e-14);

    const auto p = granular::turned({1, {0, 0, 0}}, {0.3, -0.2, 0.5});
    const granular::SolidBody turned = granular::sum({{whole, {1, 2, 3}, p}});
    const Vec3 u{0.2, -0.7, 0.4};
    CHECK((turned.inertia * granular::rotated(p, u) - granular::rotated(p, whole.inertia * u)).norm() <
          1e-14);
}

TEST_CASE("cylinders and cones with a length are frusta", "[granular][case][shapes]")
{
    const granular::Case c = read_bodies(R"(
        {"name": "rod", "type": "cylinder", "axis": [0, 0, 2], "radius": 0.1, "length": 0.5, "density": 1000, "r": [0, 0, -0.5]},
        {"name": "cone", "type": "cone", "axis": [1, 0, 0], "half_angle": 0.5, "length": 0.3, "mass": 2, "centre": 0.1},
        {"name": "silo", "type": "frustum", "axis": [0, 0, 1], "radii": [0.2, 0.4], "length": 0.3, "inside": true, "open": ["+"],
         "omega": [0, 0, 1]},
        {"name": "can", "type": "cylinder", "axis": [0, 0, 1], "radius": 0.5, "length": 0.9, "inside": true},
        {"type": "disk", "normal": [0, 0, 1], "radius": 0.3, "two_sided": true},
        {"type": "torus", "axis": [0, 1, 0], "radius": 0.02, "ring_radius": 0.1, "density": 1200})");
    const auto& b = c.world->all_boundaries();
    CHECK(c.boundaries == std::vector<std::string>{"rod", "cone", "silo", "silo-", "can", "can-", "can+",
                                                   "boundary 7", "boundary 8"});
    CHECK(b[0].mass == Approx(1000 * std::numbers::pi * 0.01 * 0.5));
    CHECK(b[0].r.z == Approx(-0.25));
    CHECK(b[0].from == Approx(-0.25));
    CHECK(nearest(b[0], {0, 0, 0.1}).distance == Approx(0.1));
    CHECK(b[1].r.x == Approx(0.1));
    CHECK(b[1].second_radius == Approx(0.3 * std::tan(0.5)));
    CHECK(b[3].body == 2);
    CHECK(b[3].axis.z == 1);
    CHECK(b[3].omega.z == 1);
    CHECK(b[6].axis.z == -1);
    CHECK(b[6].r.z == Approx(0.9));
    CHECK(b[8].inertia.yy > b[8].inertia.xx);
    CHECK(c.moving == std::vector<int>{0, 1, 2, 3, 8});
}

TEST_CASE("the order of a body and its parts in the case does not matter", "[granular][case][tool]")
{
    const std::string
        left =
            R"({"name": "left", "type": "sphere", "radius": 0.1, "r": [-0.2, 0, 0], "density": 1000, "part_of": "bell"})",
        right =
            R"({"name": "right", "type": "sphere", "radius": 0.1, "r": [0.2, 0, 0.1], "density": 3000, "part_of": "bell"})",
        bar = R"({"name": "bar", "type": "mesh", "density": 2000, "r": [0, 0, 0.3], "rotation": [0, 0.3, 0],
                                "box": {"low": [-0.1, -0.02, -0.02], "high": [0.1, 0.02, 0.02], "inside": false}, "part_of": "bell"})",
        bell = R"({"name": "bell", "type": "body", "from_parts": true, "v": [0.1, 0, 0]})";
    const granular::Case a = read_bodies(left + ", " + right + ", " + bar + ", " + bell),
                         b = read_bodies(bell + ", " + left + ", " + right + ", " + bar);
    const Boundary &first = a.world->all_boundaries()[3], &second = b.world->all_boundaries()[0];
    const double m = 4. / 3 * std::numbers::pi * 1e-3, of_bar = 2000 * 0.2 * 0.04 * 0.04;
    CHECK(first.mass == Approx(4000 * m + of_bar).epsilon(1e-12));
    CHECK((first.r - (1 / first.mass) * Vec3{2000 * m * 0.2, 0, 3000 * m * 0.1 + of_bar * 0.3}).norm() <
          1e-14);
    CHECK((first.r - second.r).norm() < 1e-15);
    CHECK(difference(first.inertia, second.inertia) < 1e-13);
    CHECK(a.world->all_boundaries()[0].v == first.v);
    CHECK(a.moving == std::vector<int>{0, 1, 2, 3});
    CHECK(a.world->all_boundaries()[1].mass == first.mass);
}

TEST_CASE("errors of finite boundaries and parts name the key", "[granular][case][tool]")
{
    const std::string frustum = R"({"type": "frustum", "axis": [0, 0, 1], )";
    check_error(frustum + R"("radii": [0.1, 0.2], "length": -1})", "length must be positive");
    check_error(frustum + R"("radii": [0, 0], "length": 1})", "one of the radii must be positive");
    check_error(frustum + R"("radii": [-0.1, 0.1], "length": 1})", "radii must not be negative, got -0.1");
    check_error(frustum + R"("radii": [0.1], "length": 1})", "radii");
    check_error(frustum + R"("radii": [0.1, 0.1], "length": 1, "open": ["up"]})",
                "open must list some of -, +");
    check_error(frustum + R"("radii": [0.1, 0.1], "length": 1, "two_sided": true})",
                "two_sided needs both ends in open");
    check_error(frustum + R"("radii": [0.1, 0.1], "length": 1, "open": ["+"], "density": 1})",
                "density needs closed ends");
    check_error(frustum + R"("radii": [0.1, 0.1], "length": 1, "inside": true, "density": 1})",
                "got inside true");
    check_error(frustum + R"("radii": [0.1, 0.1], "length": 1, "density": 1, "mass": 1})",
                "together with mass");
    check_error(R"({"type": "cylinder", "axis": [0, 0, 1], "radius": 0.1, "open": ["+"]})",
                "open is only for a cylinder with a length");
    check_error(R"({"type": "torus", "axis": [0, 0, 1], "radius": 0.1, "ring_radius": 0.1})",
                "ring_radius must be above radius, 0.1, got 0.1");

    const std::string body = R"({"name": "b", "type": "sphere", "radius": 0.1, "mass": 1}, )",
                      part = R"({"name": "p", "type": "sphere", "radius": 0.1, "part_of": "b")";
    check_error(body + part + R"(, "mass": 1})", "mass must not be given for a part, which moves with \"b\"");
    check_error(body + part + R"(, "v": [0, 0, 1]})", "v must not be given for a part");
    check_error(body + part + R"(, "omega": [0, 0, 1]})", "omega must not be given for a part");
    check_error(body + part + R"(, "r": [0, 0, "t"]})", "r must be three numbers for a part");
    check_error(body + part + R"(, "density": 1})", "density of a part needs a body with from_parts true");
    check_error(part + "}", "part_of must name a boundary, got \"b\"");
    check_error(
        body + part + R"(}, {"name": "q", "type": "sphere", "radius": 0.1, "part_of": "p"})",
        "part_of must name a boundary that is not a part itself, got \"p\", which is a part of \"b\"");
    check_error(R"({"name": "p", "type": "sphere", "radius": 0.1, "part_of": "p"})", "is a part");
    const std::string sum = R"({"name": "b", "type": "body", "from_parts": true)";
    check_error(sum + R"(, "mass": 1})", "mass must not be given together with from_parts");
    check_error(sum + R"(, "r": [0, 0, 0]})", "r must not be given together with from_parts");
    check_error(sum + "}", "from_parts needs parts with part_of");
    check_error(sum + "}, " + part + "}", "needs a density of its solid");
}

TEST_CASE("a tool that nothing holds above a plane gives a warning at the start", "[granular][case][tool]")
{
    const std::string all = R"({"name": "floor", "type": "plane", "normal": [0, 0, 1]},
                               {"name": "ball", "type": "sphere", "radius": 0.05, "r": [0, 0, 0.5], "mass": 1)";
    const auto notices = [](const granular::Case& c) { return c.notices; };
    const std::string on_floor = R"([{"r": [0.02, 0, 0.01], "radius": 0.01}])",
                      beside = R"([{"r": [0.3, 0, 0.01], "radius": 0.01}])";
    const auto alone = notices(read_bodies(all + "}", beside));
    REQUIRE(alone.size() == 1);
    CHECK_THAT(alone[0], Catch::Contains("(/boundaries/1): nothing holds boundary 'ball' above 'floor'"));
    CHECK(notices(read_bodies(all + "}", on_floor)).empty());
    CHECK(notices(read_bodies(all + R"(, "free": [true, true, false]})", beside)).empty());
    CHECK(notices(read_bodies(all + R"(, "F": [0, 0, 10]})", beside)).empty());
}
