// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/cylinder.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

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

namespace {

const bool registered = register_surface({.name = "cylinder",
                                          .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
                                              const double R = o.positive("radius");
                                              return std::make_shared<Cylinder>(R, o.flag("concave", false));
                                          },
                                          .z = "axis"});

}  // namespace

}  // namespace hilda::contact
