// SPDX-License-Identifier: GPL-3.0-or-later
/// Surfaces in model files: reading, errors with their positions, and the canonical text.

#include "contact/surface_types.hpp"
#include "contact/derivative_check.hpp"
#include "contact/surfaces/cone.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/paraboloid.hpp"
#include "contact/surfaces/polytope.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "contact/surfaces/torus.hpp"
#include "lie/check.hpp"
#include "tests/support/icosphere.hpp"

#include <catch2/catch.hpp>

#include <map>

using namespace hilda;
using namespace hilda::contact;

namespace {

struct Read {
    Shape shape;
    std::string canonical;
};

/// The shape of a text, read as the value of the key "on_i"
Read read(const std::string& shape)
{
    const std::string text = "{\"on_i\": " + shape + "}";
    const dae::JsonSource source(text, "model.json");
    dae::ObjectReader o(source, source.root, "");
    Read r{read_shape(o, "on_i"), {}};
    r.canonical = dae::written(o.finish().member("on_i")->value);
    return r;
}

std::string refusal_of_shape(const std::string& shape)
{
    try {
        read(shape);
    } catch (const dae::PlacedError& e) {
        return e.what();
    }
    return "accepted";
}

/// A sphere of 162 vertices, the coarsest icosphere that is accepted as smooth
std::string mesh_example()
{
    const tests::Triangles sphere = tests::icosphere(2);
    std::string vertices, triangles;
    const auto row = [](const auto& x) {
        return "[" + dae::shortest(x[0]) + ", " + dae::shortest(x[1]) + ", " + dae::shortest(x[2]) + "]";
    };
    for (const Vec3& v : sphere.vertices) vertices += (vertices.empty() ? "" : ", ") + row(v);
    for (const Triangle& t : sphere.triangles) triangles += (triangles.empty() ? "" : ", ") + row(t);
    return "{\"type\": \"mesh\", \"vertices\": [" + vertices + "], \"triangles\": [" + triangles + "]}";
}

/// An example of each surface type. Add new types here.
const std::map<std::string, std::string> examples = {
    {"box", R"({"type": "box", "lengths": [0.3, 0.2, 0.1], "radius": 0.02, "axis_angle": [0, 0, 1, 0.5]})"},
    {"capsule", R"({"type": "capsule", "length": 0.3, "radius": 0.1, "axis": [1, 0, 0]})"},
    {"cone", R"({"type": "cone", "half_angle": 0.5, "axis": [0, 1, 0]})"},
    {"convex", R"({"type": "convex", "vertices": [[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]]})"},
    {"cylinder", R"({"type": "cylinder", "radius": 0.5, "axis": [1, 0, 0]})"},
    {"disk", R"({"type": "disk", "radius": 0.5})"},
    {"ellipsoid", R"({"type": "ellipsoid", "semi_axes": [0.3, 0.2, 0.1], "concave": true})"},
    {"foot", R"({"type": "foot", "position": [0, 0, -0.5], "normal": [0, 0, -1]})"},
    {"height-map",
     R"({"type": "height-map", "heights": [[0, 0.5, 0, 0, 1], [0, 1, 0.25, 0, 0], [0, 0, 0, 0, 0],
                      [1, 2, 3, 4, 5]], "spacing": [0.5, 0.25], "corner": [-1, 2]})"},
    {"mesh", mesh_example()},
    {"paraboloid", R"({"type": "paraboloid", "radii": [0.5, 2], "concave": true, "axis": [0, 0, 2]})"},
    {"plane", R"({"type": "plane", "normal": [0, 3, 4]})"},
    {"polygon", R"({"type": "polygon", "vertices": [[0, 0], [0.3, 0], [0, 0.2]], "normal": [0, 3, 4]})"},
    {"quadric",
     R"({"type": "quadric", "Q": [[1, 0.5, 0], [0.5, 1, 0], [0, 0, -1]], "b": [0, 0, 0.25], "c": -4})"},
    {"sphere", R"({"type": "sphere", "radius": 0.2, "position": [1, 2, 3], "axis_angle": [0, 0, 1, 0.5]})"},
    {"superquadric", R"({"type": "superquadric", "semi_axes": [0.3, 0.2, 0.1], "exponent": 4})"},
    {"torus", R"({"type": "torus", "ring_radius": 0.5, "tube_radius": 0.1, "p": [1, 0, 0, 0]})"},
};

}  // namespace

TEST_CASE("all surface types are read and have a stable canonical text", "[contact][surface_types]")
{
    REQUIRE(io::Registry<SurfaceType>::all().size() >= examples.size());
    for (const SurfaceType& type : io::Registry<SurfaceType>::all()) {
        INFO(type.name);
        const auto example = examples.find(type.name);
        REQUIRE(example != examples.end());
        const Read once = read(example->second), twice = read(once.canonical);
        CHECK(once.shape.surface->name() == type.name);
        CHECK(twice.canonical == once.canonical);
        CHECK(twice.shape.surface->name() == type.name);
        CHECK(twice.shape.surface->size() == once.shape.surface->size());
        CHECK(twice.shape.surface->sigma() == once.shape.surface->sigma());
        CHECK(twice.shape.position == once.shape.position);
        CHECK(twice.shape.orientation == once.shape.orientation);
        CHECK(lie::orthogonality_error(once.shape.orientation) < 1e-15);
    }
}

TEST_CASE("the functions of all surface types agree with differences", "[contact][surface_types]")
{
    for (const auto& [type, example] : examples) {
        INFO(type);
        DerivativeFindings out;
        const Shape shape = read(example).shape;
        // A polytope has kinks at the planes between its parts; tests/contact/detection compares its
        // distance.
        if (dynamic_cast<const Polytope*>(shape.surface.get()) != nullptr) continue;
        check_surfaces(shape, Shape{.surface = std::make_shared<Sphere>(1)}, "contact", out);
        CHECK(out.lines == std::vector<std::string>());
    }
}

TEST_CASE("a surface has the parameters of the model file", "[contact][surface_types]")
{
    const Shape ball = read(examples.at("sphere")).shape;
    CHECK(dynamic_cast<const Sphere&>(*ball.surface).R == 0.2);
    CHECK_FALSE(dynamic_cast<const Sphere&>(*ball.surface).concave);
    CHECK(ball.position == Vec3(1, 2, 3));
    CHECK((ball.orientation - lie::exp({0, 0, 0.5})).norm() < 1e-15);

    const Shape hollow = read(examples.at("ellipsoid")).shape;
    CHECK(dynamic_cast<const Ellipsoid&>(*hollow.surface).semi_axes == Vec3(0.3, 0.2, 0.1));
    CHECK(hollow.surface->sigma() == -1);
    CHECK(hollow.orientation == Mat3::Identity());

    CHECK((read(examples.at("plane")).shape.orientation.col(2) - Vec3(0, 0.6, 0.8)).norm() < 1e-15);
    CHECK(dynamic_cast<const Superquadric&>(*read(examples.at("superquadric")).shape.surface).q == 4);
    CHECK(dynamic_cast<const Torus&>(*read(examples.at("torus")).shape.surface).r == 0.1);
    CHECK(dynamic_cast<const Cone&>(*read(examples.at("cone")).shape.surface).half_angle == 0.5);
    CHECK(dynamic_cast<const Paraboloid&>(*read(examples.at("paraboloid")).shape.surface).R_y == 2);
    const Shape hyperboloid = read(examples.at("quadric")).shape;
    CHECK(std::abs(hyperboloid.surface->value({2, 0, 0.5})) < 1e-15);  // 4 - 0.25 + 0.25 - 4
    const Shape terrain = read(examples.at("height-map")).shape;
    CHECK(std::abs(terrain.surface->value({-0.5, 2.25, 1})) < 1e-15);
    CHECK(std::abs(terrain.surface->value({0.5, 3, 5})) < 1e-14);
    CHECK(read(R"({"type": "plane"})").canonical ==
          "{\n  \"type\": \"plane\",\n  \"position\": [0, 0, 0],\n"
          "  \"A\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n}");
}

TEST_CASE("an invalid surface is rejected with its position and value", "[contact][surface_types]")
{
    const auto says = [](const std::string& shape, const std::string& what) {
        INFO(shape);
        const std::string said = refusal_of_shape(shape);
        CHECK(said.starts_with("model.json:1:"));
        CHECK_THAT(said, Catch::EndsWith(what));
    };
    says("3", "(/on_i): must be an object, got 3");
    says("{}", "(/on_i): missing key 'type'");
    says(R"({"type": "spere"})", "(/on_i/type): unknown type \"spere\"; did you mean 'sphere'?");
    says(R"({"type": "sphere"})", "(/on_i): missing key 'radius'");
    says(R"({"type": "sphere", "radius": -0.2})", "(/on_i/radius): radius must be positive, got -0.2");
    says(R"({"type": "sphere", "radius": 1, "concave": 1})",
         "(/on_i/concave): concave must be true or false, got 1");
    says(R"({"type": "sphere", "radius": 1, "xyzzy": 1})",
         "(/on_i/xyzzy): unknown key \"xyzzy\"; allowed: type, radius, concave, position, A, p, axis_angle, "
         "euler_angles, note");
    says(R"({"type": "ellipsoid", "semi_axes": [1, 0, 2]})",
         "(/on_i/semi_axes): semi_axes must be positive, got [1, 0, 2]");
    says(R"({"type": "torus", "ring_radius": 1, "tube_radius": 1})",
         "(/on_i/tube_radius): tube_radius must be less than ring_radius, got 1");
    says(R"({"type": "superquadric", "semi_axes": [1, 1, 1], "exponent": 1.5})",
         "(/on_i/exponent): exponent must be between 2 and 100, got 1.5");
    says(R"({"type": "superquadric", "semi_axes": [1, 1, 1], "exponent": 4, "exponent_z": 1000})",
         "(/on_i/exponent_z): exponent_z must be between 2 and 100, got 1000");
    says(R"({"type": "cone", "half_angle": 1.6})",
         "(/on_i/half_angle): half_angle must be between 0 and pi/2, got 1.6");
    says(R"({"type": "paraboloid", "radii": [1, 0]})", "(/on_i/radii): radii must be positive, got [1, 0]");
    says(R"({"type": "paraboloid", "radii": 1})", "(/on_i/radii): radii must be a list of 2 numbers, got 1");
    says(R"({"type": "quadric", "Q": [[1, 1, 0], [0, 1, 0], [0, 0, 1]], "c": -1})",
         "(/on_i/Q): Q must be symmetric");
    says(R"({"type": "quadric", "Q": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "c": 1})",
         "(/on_i/Q): G = 0 must have points; G does not change its sign");
    says(R"({"type": "plane", "normal": [0, 0, 0]})",
         "(/on_i/normal): normal must have a direction, got [0, 0, 0] of length 0");
    says(R"({"type": "plane", "normal": [0, 0, 1], "axis_angle": [0, 0, 1, 2]})",
         "(/on_i/axis_angle): the orientation must be given once, got normal and axis_angle");
    says(
        R"({"type": "disk", "radius": 1, "A": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "axis_angle": [0, 0, 1, 2]})",
        "(/on_i): the orientation must be given once, as one of A, p, axis_angle and euler_angles; got 2");
    says(R"({"type": "disk", "radius": 1, "A": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]})",
         "(/on_i/A): A must be a rotation matrix, got a reflection (det A = -1)");
    says(R"({"type": "disk", "radius": 1, "axis_angle": [0, 0, 2, 2]})",
         "(/on_i/axis_angle): the axis of axis_angle must have length 1, got 2; deviations up to 1e-06 are "
         "corrected");
    says(R"({"type": "disk", "radius": 1, "position": [0, 0]})",
         "(/on_i/position): position must be a list of 3 numbers, got [0, 0]");
}

TEST_CASE("an invalid height map is rejected with its position and value", "[contact][surface_types]")
{
    const auto says = [](const std::string& heights, const std::string& rest, const std::string& what) {
        CHECK_THAT(refusal_of_shape("{\"type\": \"height-map\", \"heights\": " + heights + rest + "}"),
                   Catch::StartsWith("model.json:1:") && Catch::EndsWith(what));
    };
    const std::string row = "[0, 1, 0, 1]", four = "[" + row + ", " + row + ", " + row + ", " + row + "]";
    says("[]", "", "(/on_i/heights): heights must not be empty");
    says("[1, 2]", "", "(/on_i/heights): heights[0] must be a list of 1 numbers, got 1");
    says("[" + row + ", [0, 1]]", "", "(/on_i/heights): heights[1] must be a list of 4 numbers, got [0, 1]");
    says("[" + row + ", [0, 1, 2, \"x\"]]", "",
         "(/on_i/heights/1/3): heights[1][3] must be a number, got \"x\"");
    says("[" + row + ", " + row + "]", "",
         "(/on_i/heights): heights must have at least 4 rows of at least 4 numbers, got 2 of 4");
    says(four, "", "(/on_i): missing key 'spacing'");
    says(four, R"(, "spacing": [1, 0])", "(/on_i/spacing): spacing must be positive, got [1, 0]");
    says(four, R"(, "spacing": [1, 1], "corner": [0])",
         "(/on_i/corner): corner must be a list of 2 numbers, got [0]");
}

TEST_CASE("an invalid mesh is rejected with its position", "[contact][surface_types]")
{
    const auto says = [](const std::string& vertices, const std::string& triangles, const std::string& what) {
        CHECK_THAT(refusal_of_shape("{\"type\": \"mesh\", \"vertices\": [" + vertices +
                                    "], \"triangles\": [" + triangles + "]}"),
                   Catch::StartsWith("model.json:1:") && Catch::EndsWith(what));
    };
    const std::string corners = "[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]";
    const std::string three = "[0, 2, 1], [0, 1, 3], [0, 3, 2]";
    says("[0, 0]", three, "(/on_i/vertices): vertices[0] must be a list of 3 numbers, got [0, 0]");
    says(corners, "[0, 1, 4]",
         "(/on_i/triangles): triangles[0][2] must be the number of a vertex, from 0 to 3, got 4");
    says(corners, "[0, 1, 0.5]",
         "(/on_i/triangles): triangles[0][2] must be the number of a vertex, from 0 to 3, got 0.5");
    says(corners, three,
         "(/on_i/triangles): the edge of the vertices 1 and 2 is open: it belongs to triangle 0 only");
    says(corners, three + ", [1, 2, 3]",
         "(/on_i/vertices): the mesh is too coarse for a smooth surface: the 4 vertices near vertex 0 do not "
         "determine a "
         "cubic");
}

TEST_CASE("a second surface type with the same name is rejected", "[contact][surface_types]")
{
    CHECK_THROWS_AS(io::Registry<SurfaceType>::add(SurfaceType{.name = "sphere", .read = nullptr}),
                    std::logic_error);
}
