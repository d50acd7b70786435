// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/sphere.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

#include <algorithm>

namespace hilda::contact {

Sphere::Sphere(double R, bool concave)
    : R(positive("contact::Sphere", "the radius of a sphere", R)), concave(concave)
{}

Vec3 Sphere::project(const Vec3& a) const
{
    const double distance = a.norm();
    if (!(distance > 0))
        throw lie::NumericalFailure("contact_not_converged",
                                    "the centre of a sphere has no unique closest point");
    return R / distance * a;
}

double Sphere::arc(double chord) const { return 2 * R * std::asin(std::min(chord / (2 * R), 1.0)); }

namespace {

const bool registered_sphere = io::Registry<SurfaceType>::add(
    {.name = "sphere",
     .schema = {.description = "Sphere with its centre at the origin of the surface frame.",
                .examples = {R"("radius": 0.1)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const double R = o.positive("radius", {"Radius [m].", "0.1"});
         return std::make_shared<Sphere>(R, read_concave(o));
     }});

}  // namespace

}  // namespace hilda::contact
