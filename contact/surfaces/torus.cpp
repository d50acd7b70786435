// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/torus.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"
#include "contact/tessellation.hpp"

#include <numbers>

namespace hilda::contact {

Torus::Torus(double R, double r, bool concave)
    : R(positive("contact::Torus", "the radius of the ring of a torus", R)),
      r(positive("contact::Torus", "the radius of the tube of a torus", r)), concave(concave)
{
    if (!(r < R))
        lie::reject("contact::Torus", "the radius of the tube of a torus must be less than that of its ring",
                    r);
}

double Torus::value(const Vec3& a) const
{
    const double across = a.head<2>().norm() - R;
    return (across * across + a.z() * a.z() - r * r) / (2 * r);
}

Vec3 Torus::gradient(const Vec3& a) const
{
    const double part = 1 - R / a.head<2>().norm();
    return Vec3(part * a.x(), part * a.y(), a.z()) / r;
}

Mat3 Torus::hessian(const Vec3& a) const
{
    const double rho = a.head<2>().norm();
    const Vec3 radial(a.x() / rho, a.y() / rho, 0);
    Mat3 H = radial * radial.transpose();
    H *= R / rho;
    H.diagonal() += Vec3(1 - R / rho, 1 - R / rho, 1);
    return H / r;
}

std::optional<Vec3> Torus::support(const Vec3& u) const
{
    const double across = u.head<2>().norm();
    if (!(across > 1e-12))
        throw lie::NumericalFailure("contact_not_converged",
                                    "a torus lies flat on a plane: the contact is a circle");
    return Vec3(R / across * Vec3(u.x(), u.y(), 0) + r * u);
}

Vec3 Torus::project(const Vec3& a) const
{
    const double rho = a.head<2>().norm();
    const Vec3 ring = R / rho * Vec3(a.x(), a.y(), 0), out = a - ring;
    const double distance = out.norm();
    if (!(rho > 0 && distance > 0))
        throw lie::NumericalFailure(
            "contact_not_converged",
            "a point on the axis or on the centre line of a torus has no unique closest point");
    return ring + r / distance * out;
}

PolygonMesh Torus::drawing(const DrawingExtent&) const
{
    constexpr double pi = std::numbers::pi;
    return grid(around, down, true, true, [&](int k, int c) {
        const double phi = 2 * pi * k / around, theta = 2 * pi * c / down, rho = R + r * std::cos(theta);
        return Vec3(rho * std::cos(phi), rho * std::sin(phi), r * std::sin(theta));
    });
}

namespace {

const bool registered_torus = io::Registry<SurfaceType>::add(
    {.name = "torus",
     .schema = {.description = "Torus about z: a tube along a circle in the plane z = 0 of the surface "
                               "frame. The tube must be thinner than the ring.",
                .examples = {R"("ring_radius": 0.3, "tube_radius": 0.05)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const double R = o.positive("ring_radius", {"Radius of the circle of tube centres [m].", "0.3"}),
                      r = o.positive("tube_radius",
                                     {"Radius of the tube [m]. It must be less than ring_radius.", "0.05"});
         if (!(r < R))
             o.fail("tube_radius", "tube_radius must be less than ring_radius, got " + dae::shortest(r));
         return std::make_shared<Torus>(R, r, read_concave(o));
     },
     .z = "axis"});

}  // namespace

}  // namespace hilda::contact
