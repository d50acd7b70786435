// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball slides in a bowl given by samples: the normal force must converge with the number of samples.

#include "contact/evolving/contact.hpp"
#include "contact/mesh/height_map.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/icosphere.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using contact::EvolvingContact;
using contact::Shape;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Positions and normal forces at all nodes; the largest |λ_N| and |λ_t| relative to F_N, which should vanish
struct Slide {
    std::vector<Vec3> r;
    std::vector<double> F_N;
    double spurious = 0;
};

Slide slide(const std::shared_ptr<const contact::Surface>& bowl, double R, const Vec3& r, double end,
            double h)
{
    dae::Model model;
    model.add({"ball", 1, 0.4 * R * R * Mat3::Identity()});
    model.constrain("contact", std::make_unique<EvolvingContact>(
                                   0, Shape{std::make_shared<contact::Sphere>(R)}, dae::ground, Shape{bowl}));
    lie::State x;
    x.body.resize(1);
    x.body[0].r = r;
    dae::start(model, x, {.fix_initial = true});
    const auto& c = static_cast<const EvolvingContact&>(*model.general_constraints()[0]);
    const auto step = lie::scheme("rA-half-1-momentum").make(model, {.tolerance = 1e-13});
    Slide out;
    for (const lie::State& s : lie::march(x, *step, lie::TimeGrid::over(end, h)).row) {
        const EvolvingContact::Multipliers m = c.multipliers(model.arguments(c, s), s.lambda);
        out.r.push_back(s.body[0].r);
        out.F_N.push_back(m.F_N);
        out.spurious = std::max({out.spurious, m.N.norm() / m.F_N, m.tangential.norm() / m.F_N});
    }
    return out;
}

struct Error {
    double r = 0, rms = 0, largest = 0;  ///< [m, N, N]
};

Error error(const Slide& of, const Slide& exact)
{
    Error e;
    for (size_t n = 0; n < exact.r.size(); ++n) {
        const double F = std::abs(of.F_N[n] - exact.F_N[n]);
        e.r = std::max(e.r, (of.r[n] - exact.r[n]).norm());
        e.rms += F * F;
        e.largest = std::max(e.largest, F);
    }
    e.rms = std::sqrt(e.rms / static_cast<double>(exact.r.size()));
    return e;
}

}  // namespace

TEST_CASE("the normal force on a height map converges with second order in the spacing (long)",
          "[contact][evolving]")
{
    const Vec3 axes(4, 3, 2), from(0, 1.3203946979732251, -1.2654225449401855);
    const auto depth = [&](double x, double y) {
        return -axes.z() * std::sqrt(1 - x * x / (axes.x() * axes.x()) - y * y / (axes.y() * axes.y()));
    };
    const Slide exact = slide(std::make_shared<contact::Ellipsoid>(axes, true), 0.5, from, 2, 1e-3);
    std::vector<Error> of;
    for (const double spacing : {0.2, 0.1, 0.05}) {
        const auto map = std::make_shared<contact::HeightMap>(contact::HeightMap::sampled(
            depth, {-0.8, -2}, {0.8, 2}, static_cast<int>(std::lround(1.6 / spacing)) + 1,
            static_cast<int>(std::lround(4 / spacing)) + 1));
        const Slide sampled = slide(map, 0.5, from, 2, 1e-3);
        CHECK(sampled.spurious < 1e-12);
        of.push_back(error(sampled, exact));
    }
    INFO("position " << of[0].r << ' ' << of[1].r << ' ' << of[2].r << " m, F_N rms " << of[0].rms << ' '
                     << of[1].rms << ' ' << of[2].rms << " N, largest " << of[0].largest << ' '
                     << of[1].largest << ' ' << of[2].largest);
    CHECK(of[0].r < 3.7e-5);
    CHECK(of[2].r < 2.5e-7);
    CHECK(of[0].largest < 2e-3);
    CHECK(std::log2(of[0].rms / of[2].rms) / 2 > 1.8);
}

TEST_CASE("the normal force on a triangle mesh converges faster than the edge length (long)",
          "[contact][evolving]")
{
    const Vec3 axes(2.5, 2.7, 2.3), from(0.3, 1.2, -1.2);
    const Slide exact = slide(std::make_shared<contact::Ellipsoid>(axes, true), 0.5, from, 1, 2e-3);
    std::vector<Error> of;
    double highest = 0;
    for (const double F : exact.F_N) highest = std::max(highest, F);
    for (const int levels : {2, 3}) {
        tests::Triangles mesh = tests::icosphere(levels);
        for (Vec3& v : mesh.vertices) v = axes.cwiseProduct(v);
        const Slide meshed = slide(std::make_shared<contact::MeshSurface>(
                                       contact::TriangleMesh(mesh.vertices, mesh.triangles), true),
                                   0.5, from, 1, 2e-3);
        CHECK(meshed.spurious < 1e-11);
        of.push_back(error(meshed, exact));
        for (const double F : meshed.F_N) CHECK(F < 2 * highest);
    }
    INFO("position " << of[0].r << ' ' << of[1].r << " m, F_N rms " << of[0].rms << ' ' << of[1].rms
                     << " N, largest " << of[0].largest << ' ' << of[1].largest << " of " << highest);
    CHECK(of[0].r / of[1].r > 4);
    CHECK(std::log2(of[0].rms / of[1].rms) > 1.5);
    CHECK(of[1].largest < 0.05 * highest);
}
