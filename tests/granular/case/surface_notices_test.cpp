// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries at periodic sides: which ones continue across them, and which give a notice.
#include "granular/case/surface_notices.hpp"
#include "granular/case/case_file.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;

namespace {

/// The notices of a case with one boundary of these members, in a cube with the corners ±1 m that is periodic
/// along x and y, with a particle of the radius 0.01 m
std::vector<std::string> notices(const std::string& members)
{
    const std::string text =
        R"({"hilda_case": 1, "domain": {"low": [-1, -1, -1], "high": [1, 1, 1], "periodic": [true, true, false]},
        "step": 1e-5, "end": 1e-3, "interval": 1e-4,
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}], "laws": [{"between": ["glass", "glass"], "restitution": 0.8}],
        "particles": [{"r": [0, 0, 0.9], "radius": 0.01}], "boundaries": [{)" +
        members + "}]}";
    return granular::read_case(text, "case.json", {}).notices;
}

}  // namespace

TEST_CASE("a boundary that reaches a periodic side and does not continue across it gives a notice",
          "[granular][case]")
{
    const auto [members, axes] = GENERATE(table<std::string, std::string>({
        {R"("type": "plane", "normal": [0, 0, 1], "r": [0, 0, -0.5])", ""},
        {R"("type": "plane", "normal": [0.1, 0, 1], "r": [0, 0, -0.5])", "x"},
        {R"("type": "plane", "normal": [1, 0, 0], "r": [-0.9, 0, 0])", ""},
        {R"("type": "plane", "normal": [1, 0, 0], "r": [-1, 0, 0])", "x"},
        {R"("type": "sphere", "radius": 0.5)", ""},
        {R"("type": "sphere", "radius": 0.5, "r": [0, 0.6, 0])", "y"},
        {R"("type": "sphere", "radius": 0.5, "r": [0, 0.485, 0])", ""},
        {R"("type": "sphere", "radius": 0.5, "r": [0, 0.495, 0])", "y"},
        {R"("type": "cylinder", "axis": [0, 1, 0], "radius": 0.5)", ""},
        {R"("type": "cylinder", "axis": [0, 1, 0.1], "radius": 0.5)", "y"},
        {R"("type": "cylinder", "axis": [0, 0, 1], "radius": 0.5)", ""},
        {R"("type": "cylinder", "axis": [0, 0, 1], "radius": 0.5, "r": [-0.6, 0.7, 0])", "xy"},
        {R"("type": "cylinder", "axis": [1, 0, 0], "radius": 0.5, "r": [-1.1, 0, 0], "length": 2.2)", ""},
        {R"("type": "cylinder", "axis": [1, 0, 0], "radius": 0.5, "r": [-1, 0, 0], "length": 2.2)", "x"},
        {R"("type": "cylinder", "axis": [1, 0, 0], "radius": 0.5, "r": [-0.5, 0, 0], "length": 1)", ""},
        {R"("type": "frustum", "axis": [1, 0, 0], "radii": [0.5, 0.4], "r": [-1.1, 0, 0], "length": 2.2)",
         "x"},
        {R"("type": "disk", "normal": [0, 0, 1], "radius": 0.5)", ""},
        {R"("type": "disk", "normal": [0, 0, 1], "radius": 1.5)", "xy"},
        {R"("type": "disk", "normal": [0, 1, 0], "radius": 1.5)", "x"},
        {R"("type": "torus", "axis": [0, 0, 1], "ring_radius": 0.6, "radius": 0.3)", ""},
        {R"("type": "torus", "axis": [0, 0, 1], "ring_radius": 0.6, "radius": 0.395)", "xy"},
        {R"("type": "torus", "axis": [0, 1, 0], "ring_radius": 0.6, "radius": 0.395)", "x"},
        {R"("type": "mesh", "plate": {"width_x": 3, "width_y": 3})", ""},
        {R"("type": "mesh", "plate": {"width_x": 2, "width_y": 3})", "x"},
        {R"("type": "mesh", "plate": {"width_x": 1, "width_y": 3})", ""},
        {R"("type": "mesh", "extrude": {"outline": [[0, 0], [0.2, 0], [0, 0.2]], "length": 0.5}, "r": [0.9, 0, 0])",
         "x"},
        {R"("type": "mesh", "box": {"low": [-1.1, -0.5, -0.5], "high": [1.1, 0.5, 0.5], "inside": false, "edge": 0.3})",
         ""},
        {R"("type": "mesh", "box": {"low": [-1, -0.5, -0.5], "high": [1.1, 0.5, 0.5], "inside": false})",
         "x"},
        {R"("type": "mesh", "lathe": {"profile": [[0.1, -1.2], [0.2, 0], [0.1, 1.2]]}, "rotation": [1.5707963267948966, 0, 0])",
         "y"},
    }));
    INFO(members);
    const std::vector<std::string> all = notices(members);
    INFO((all.empty() ? "no notice" : all[0]));
    REQUIRE(all.size() == axes.size());
    for (std::size_t k = 0; k < axes.size(); ++k)
        CHECK_THAT(all[k], Catch::Contains("/boundaries/0") &&
                               Catch::Contains(std::string(" reaches a periodic side along ") + axes[k] +
                                               ", across which it has no images"));
}

TEST_CASE("a fixed particle in a case with a tool gives a notice", "[granular][case]")
{
    const auto of = [](const std::string& mass, const std::string& fixed) {
        const std::string text =
            R"({"hilda_case": 1, "domain": {"low": [-1, -1, -1], "high": [1, 1, 1]}, "step": 1e-5, "end": 1e-3, "interval": 1e-4,
            "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}], "laws": [{"between": ["glass", "glass"], "restitution": 0.8}],
            "particles": [{"r": [0, 0, -0.5], "radius": 0.01)" +
            fixed + R"(}, {"r": [0, 0, 0.5], "radius": 0.01)" + fixed +
            R"(}], "boundaries": [{"type": "sphere", "radius": 0.1, "r": [0, 0, 0])" + mass + "}]}";
        return granular::read_case(text, "case.json", {}).notices;
    };
    const std::string mass = R"(, "mass": 1)", fixed = R"(, "fixed": true)";
    CHECK(of("", fixed).empty());
    CHECK(of(mass, "").empty());
    REQUIRE(of(mass, fixed).size() == 1);
    CHECK_THAT(of(mass, fixed)[0],
               Catch::Contains("(/particles/0/fixed): a fixed particle does not touch boundaries") &&
                   Catch::Contains("/boundaries/0"));
}

TEST_CASE("the boundaries of a case have the box in which their surfaces are", "[granular][case]")
{
    granular::NamedBoundary b;
    b.boundary = granular::frustum({0, 0, 1}, {0, 0.6, 0.8}, 2, 0.5, 1);
    const granular::BoundingBox box = granular::bounds(b);
    // points of the two edges
    double low[] = {1, 1, 1}, high[] = {-1, -1, -1};
    for (int k = 0; k < 10000; ++k) {
        const double angle = 2 * M_PI * k / 10000;
        for (const auto& [centre, radius] : {std::pair{Vec3{0, 0, 1}, 0.5}, {Vec3{0, 1.2, 2.6}, 1.}}) {
            const Vec3 p =
                centre + radius * (std::cos(angle) * Vec3{1, 0, 0} + std::sin(angle) * Vec3{0, -0.8, 0.6});
            const double x[] = {p.x, p.y, p.z};
            for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
        }
    }
    const double from[] = {box.low.x, box.low.y, box.low.z}, to[] = {box.high.x, box.high.y, box.high.z};
    for (int a = 0; a < 3; ++a) {
        CHECK(from[a] == Approx(low[a]).margin(1e-6));
        CHECK(to[a] == Approx(high[a]).margin(1e-6));
    }
}
