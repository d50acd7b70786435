// SPDX-License-Identifier: GPL-3.0-or-later
/// Mass properties of homogeneous bodies, against the integrals over triangulated surfaces.
#include <catch2/catch.hpp>

#include "dae/model_file.hpp"

#include <numbers>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

struct Moments {
    double volume = 0;
    Vec3 first = Vec3::Zero();   ///< ∫ x dV
    Mat3 second = Mat3::Zero();  ///< ∫ x xᵀ dV

    /// Adds the tetrahedron of the origin and a triangle, by the divergence theorem; exact for a polyhedron
    void add(const Vec3& a, const Vec3& b, const Vec3& c)
    {
        const double V = a.dot(b.cross(c)) / 6;
        const Vec3 sum = a + b + c;
        volume += V;
        first += V * sum / 4;
        second +=
            V / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    Mat3 inertia() const { return second.trace() * Mat3::Identity() - second; }
};

/// Point of the surface, for u from 0 to 1 from end to end and the angle v
Vec3 point(const dae::BodyShape& s, double u, double v)
{
    const std::vector<double>& d = s.dimensions;
    Vec3 x;
    if (s.type == "sphere" || s.type == "ellipsoid") {
        const double w = std::numbers::pi * u;
        x = Vec3(std::sin(w) * std::cos(v), std::sin(w) * std::sin(v), -std::cos(w));
        return s.type == "sphere" ? Vec3(d[0] * x) : Vec3(x.cwiseProduct(Vec3(d[0], d[1], d[2])));
    }
    if (s.type == "capsule") {  // a half sphere, the side, another half sphere
        const double w = std::numbers::pi / 2 *
                         (std::clamp(3 * u - 1, -1., 0.) + std::clamp(3 * u - 2, 0., 1.)),
                     side = std::clamp(3 * u - 1, 0., 1.);
        const Vec3 local(d[0] * std::cos(w) * std::cos(v), d[0] * std::cos(w) * std::sin(v),
                         (side - 0.5) * d[1] + d[0] * std::sin(w));
        for (int k = 0; k < 3; ++k) x[(s.axis + 1 + k) % 3] = local[k];
        return x;
    }
    // a disk for u < 1/3, the side, and for a cylinder another disk
    const bool cone = s.type == "cone";
    const double low = cone ? -d[1] / 4 : -d[1] / 2, high = low + d[1];
    const double side = std::clamp(3 * u - 1, 0., 1.);
    const double r = u < 1. / 3   ? 3 * u * d[0]
                     : cone       ? (1 - side) * d[0]
                     : u < 2. / 3 ? d[0]
                                  : (3 - 3 * u) * d[0];
    const Vec3 local(r * std::cos(v), r * std::sin(v), low + side * (high - low));
    for (int k = 0; k < 3; ++k) x[(s.axis + 1 + k) % 3] = local[k];
    return x;
}

Moments integrated(const dae::BodyShape& s, int n)
{
    Moments m;
    if (s.type == "box") {
        const Vec3 h = 0.5 * Vec3(s.dimensions[0], s.dimensions[1], s.dimensions[2]);
        for (int k = 0; k < 3; ++k)
            for (const double sign : {-1., 1.}) {
                const Vec3 n_k = sign * h[k] * Vec3::Unit(k), p = h[(k + 1) % 3] * Vec3::Unit((k + 1) % 3),
                           q = sign * h[(k + 2) % 3] * Vec3::Unit((k + 2) % 3);
                m.add(n_k - p - q, n_k + p - q, n_k + p + q);
                m.add(n_k - p - q, n_k + p + q, n_k - p + q);
            }
        return m;
    }
    for (int i = 0; i < 3 * n; ++i)
        for (int j = 0; j < n; ++j) {
            const auto at = [&](int k, int l) {
                return point(s, k / (3. * n), 2 * std::numbers::pi * (l % n) / n);
            };
            m.add(at(i, j), at(i + 1, j), at(i + 1, j + 1)), m.add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    if (m.volume < 0) m.volume = -m.volume, m.first = -m.first, m.second = -m.second;
    return m;
}

dae::Description model_of_body(const std::string& keys)
{
    return dae::read_model(
        R"({"hilda_model": 1, "name": "m", "bodies": [{"name": "b", )" + keys + R"(, "r": [0, 0, 0]}]})",
        "m.json");
}

std::string refusal_of_body(const std::string& keys)
{
    try {
        model_of_body(keys);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("volume, centre of mass and inertia of a shape are the integrals over its tessellation",
          "[dae][shape]")
{
    const dae::BodyShape shape =
        GENERATE(dae::BodyShape{"box", {0.3, 0.2, 0.7}}, dae::BodyShape{"sphere", {0.4}},
                 dae::BodyShape{"ellipsoid", {0.5, 0.3, 0.2}}, dae::BodyShape{"cylinder", {0.2, 0.9}, 0},
                 dae::BodyShape{"cylinder", {0.2, 0.9}, 1}, dae::BodyShape{"cylinder", {0.5, 0.1}, 2},
                 dae::BodyShape{"capsule", {0.2, 0.9}, 0}, dae::BodyShape{"capsule", {0.3, 0.1}, 1},
                 dae::BodyShape{"capsule", {0.3, 0.4}, 2}, dae::BodyShape{"cone", {0.3, 0.8}, 0},
                 dae::BodyShape{"cone", {0.3, 0.8}, 2});
    INFO(shape.type << " along " << shape.axis);
    // The error of a tessellation with n sides is O(1/n²): extrapolated, it is O(1/n⁴).
    const Moments coarse = integrated(shape, 60), fine = integrated(shape, 120);
    const auto limit = [](const auto& c, const auto& f) { return (4 * f - c) / 3; };
    const double volume = limit(coarse.volume, fine.volume);
    const Vec3 first = limit(coarse.first, fine.first);
    const Mat3 J = limit(coarse.inertia(), fine.inertia());
    CHECK(shape.volume() == Approx(volume).epsilon(1e-5));
    CHECK(first.norm() < 1e-6 * volume);
    const double mass = 3;
    CHECK((shape.inertia(mass) - mass / volume * J).norm() < 2e-5 * shape.inertia(mass).norm());
}

TEST_CASE("a capsule without a length is a sphere, and a thin one is a rod", "[dae][shape]")
{
    const dae::BodyShape sphere{"sphere", {0.3}}, ball{"capsule", {0.3, 1e-15}};
    CHECK(ball.volume() == Approx(sphere.volume()).epsilon(1e-14));
    CHECK((ball.inertia(2) - sphere.inertia(2)).norm() < 1e-14 * sphere.inertia(2).norm());
    const dae::BodyShape rod{"cylinder", {1e-9, 2}, 1}, needle{"capsule", {1e-9, 2}, 1};
    CHECK(needle.volume() == Approx(rod.volume()).epsilon(1e-8));
    CHECK((needle.inertia(2) - rod.inertia(2)).norm() < 1e-8 * rod.inertia(2).norm());
}

TEST_CASE("a body of a shape has the mass of its density and the inertia of its mass", "[dae][shape]")
{
    const dae::Description d = model_of_body(R"("density": 1000, "shape": {"box": [0.2, 0.1, 0.3]})");
    const dae::Body& b = d.model->all_bodies()[0];
    CHECK(b.m == Approx(6).epsilon(1e-15));
    CHECK((b.J_bar.diagonal() - Vec3(0.05, 0.065, 0.025)).norm() < 1e-16);
    REQUIRE(b.shape);
    CHECK(b.shape->type == "box");
    CHECK(b.shape->dimensions == std::vector<double>{0.2, 0.1, 0.3});
    const dae::Body same =
        model_of_body(R"("mass": 6, "shape": {"box": [0.2, 0.1, 0.3]})").model->all_bodies()[0];
    CHECK((same.J_bar - b.J_bar).norm() < 1e-16);

    // The canonical form has explicit mass and inertia, and is read as the same body.
    CHECK_THAT(d.text, Catch::Contains("\"mass\": 6") && Catch::Contains("\"inertia\": [0.05") &&
                           Catch::Contains("\"box\"") && !Catch::Contains("density"));
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(again.model->all_bodies()[0].J_bar == b.J_bar);

    // With an explicit inertia the shape is for pictures only.
    const dae::Description drawn = model_of_body(
        R"("mass": 2, "inertia": [1, 1, 1], "shape": {"cylinder": [0.1, "4/10"], "axis": "y"})");
    CHECK(drawn.model->all_bodies()[0].J_bar == Mat3::Identity());
    CHECK(drawn.model->all_bodies()[0].shape->axis == 1);
    CHECK(drawn.model->all_bodies()[0].shape->dimensions[1] == 0.4);
    CHECK_FALSE(model_of_body(R"("mass": 2, "inertia": [1, 1, 1])").model->all_bodies()[0].shape);
}

TEST_CASE("wrong shapes and densities are refused", "[dae][shape]")
{
    const std::string ball = R"("shape": {"sphere": 0.1})";
    CHECK(refusal_of_body(R"("density": 1, "mass": 1, )" + ball) ==
          "m.json:1:69 (/bodies/0/density): give one of mass and density, not both");
    CHECK_THAT(refusal_of_body(R"("density": 1, "inertia": [1, 1, 1], )" + ball),
               Catch::Contains("give one of inertia and density, not both"));
    CHECK_THAT(refusal_of_body(R"("density": 1)"),
               Catch::Contains("(/bodies/0/density): density needs a shape"));
    CHECK_THAT(refusal_of_body(R"("density": 0, )" + ball),
               Catch::Contains("density must be positive, got 0"));
    CHECK_THAT(refusal_of_body(R"("density": 1e308, "shape": {"sphere": 100})"),
               Catch::Contains("density times volume, must be positive and finite, got inf"));
    CHECK_THAT(refusal_of_body(R"("density": 1e-300, "shape": {"sphere": 1e-9})"),
               Catch::Contains("finite, got 0"));
    CHECK_THAT(refusal_of_body(R"("mass": 1)"), Catch::Contains("missing key 'inertia'"));
    CHECK_THAT(refusal_of_body(ball), Catch::Contains("missing key 'mass'"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": "box")"),
               Catch::Contains("must be an object, got \"box\""));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {})"),
               Catch::Contains("(/bodies/0/shape): a shape must have one of the keys box, sphere, ellipsoid, "
                               "cylinder, capsule, cone and convex"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"cilinder": [1, 2]})"),
               Catch::Contains("did you mean 'cylinder'?"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"box": [1, 2, 3], "cone": [1, 2]})"),
               Catch::Contains("(/bodies/0/shape/cone): give one of box and cone, not both"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"box": [1, 2]})"),
               Catch::Contains("box must be a list of 3 numbers"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"box": [1, 0, 3]})"),
               Catch::Contains("box must have positive dimensions, got 0"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"capsule": [0.1, -0.2]})"),
               Catch::Contains("capsule must have positive dimensions, got -0.2"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"sphere": [1]})"),
               Catch::Contains("sphere must be a number, got [1]"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"sphere": 1, "axis": "x"})"),
               Catch::Contains("axis is for a cylinder, a capsule or a cone, got a sphere"));
    CHECK_THAT(refusal_of_body(R"("mass": 1, "shape": {"cone": [1, 2], "axis": "w"})"),
               Catch::Contains("unknown axis \"w\""));
}
