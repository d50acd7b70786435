// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/cylinder.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"
#include "contact/tessellation.hpp"

#include <numbers>

namespace hilda::contact {

Cylinder::Cylinder(double R, bool concave)
    : R(positive("contact::Cylinder", "the radius of a cylinder", R)), concave(concave)
{}

double Cylinder::value(const Vec3& a) const { return (a.head<2>().squaredNorm() - R * R) / (2 * R); }

Vec3 Cylinder::project(const Vec3& a) const
{
    const double distance = a.head<2>().norm();
    if (!(distance > 0))
        throw lie::NumericalFailure("contact_not_converged",
                                    "a point on the axis of a cylinder has no unique closest point");
    return {R / distance * a.x(), R / distance * a.y(), a.z()};
}

PolygonMesh Cylinder::drawing(const DrawingExtent& extent) const
{
    constexpr double pi = std::numbers::pi;
    const bool known = !extent.box.isEmpty();
    const double middle = known ? extent.box.center().z() : 0;
    const double half = std::max(R, known ? DrawingExtent::margin * 0.5 * extent.box.sizes().z() : 0);
    return grid(around, across + 1, true, false, [&](int r, int c) {
        return Vec3(R * std::cos(2 * pi * r / around), R * std::sin(2 * pi * r / around),
                    middle + half * (2. * c / across - 1));
    });
}

namespace {

const bool registered_cylinder =
    io::Registry<SurfaceType>::add({.name = "cylinder",
                                    .schema = {.description = "Infinite circular cylinder about z.",
                                               .examples = {R"("radius": 0.1, "axis": [0, 1, 0])"}},
                                    .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
                                        const double R = o.positive("radius", {"Radius [m].", "0.1"});
                                        return std::make_shared<Cylinder>(R, read_concave(o));
                                    },
                                    .z = "axis"});

}  // namespace

}  // namespace hilda::contact
