// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/disk.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"
#include "contact/tessellation.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::contact {

Disk::Disk(double R) : R(positive("contact::Disk", "the radius of a disk", R)) {}

double Disk::value(const Vec3& a) const { return (a.head<2>().squaredNorm() - R * R) / (2 * R); }

Vec3 Disk::project(const Vec3& a) const
{
    const double distance = a.head<2>().norm();
    if (!(distance > 0))
        throw lie::NumericalFailure("contact_not_converged",
                                    "a point on the axis of a disk has no unique closest point of the rim");
    return R / distance * Vec3(a.x(), a.y(), 0);
}

double Disk::arc(double chord) const { return 2 * R * std::asin(std::min(chord / (2 * R), 1.0)); }

PolygonMesh Disk::drawing(const DrawingExtent&) const
{
    constexpr double pi = std::numbers::pi;
    PolygonMesh mesh;
    mesh.point.push_back(Vec3::Zero());
    for (int c = 0; c < around; ++c) {
        mesh.point.push_back(R * Vec3(std::cos(2 * pi * c / around), std::sin(2 * pi * c / around), 0));
        mesh.polygon.push_back({0, 1 + c, 1 + (c + 1) % around});
    }
    return mesh;
}

namespace {

const bool registered_disk = io::Registry<SurfaceType>::add(
    {.name = "disk",
     .schema = {.description = "Thin disk that touches with its rim: the circle about z in the plane z = 0 "
                               "of the surface frame. The other surface must be a plane.",
                .examples = {R"("radius": 0.25, "axis": [1, 0, 0])"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         return std::make_shared<Disk>(o.positive("radius", {"Radius [m].", "0.1"}));
     },
     .z = "axis"});

}  // namespace

}  // namespace hilda::contact
