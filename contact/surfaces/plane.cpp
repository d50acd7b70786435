// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/plane.hpp"

#include "contact/surface_types.hpp"
#include "contact/tessellation.hpp"

namespace hilda::contact {

PolygonMesh Plane::drawing(const DrawingExtent& extent) const
{
    return square(extent, [](const Vec3& a) { return a; });
}

namespace {

const bool registered_plane = io::Registry<SurfaceType>::add(
    {.name = "plane",
     .schema = {.description = "Plane through the origin of the surface frame with the outward normal z.",
                .examples = {R"("normal": [0, 0, 1])"}},
     .read = [](dae::ObjectReader&) -> std::shared_ptr<const Surface> { return std::make_shared<Plane>(); },
     .z = "normal"});

}  // namespace

}  // namespace hilda::contact
