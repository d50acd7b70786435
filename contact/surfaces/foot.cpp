// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/foot.hpp"

#include "contact/surface_types.hpp"
#include "contact/tessellation.hpp"

namespace hilda::contact {

PolygonMesh Foot::drawing(const DrawingExtent& extent) const
{
    constexpr double half = 0.05;  // half side, relative to the size of the scene
    return square(Vec3::Zero(), extent.scene_size > 0 ? half * extent.scene_size : 1,
                  [](const Vec3& a) { return a; });
}

namespace {

const bool registered_foot = io::Registry<SurfaceType>::add(
    {.name = "foot",
     .schema =
         {.description =
              "Flat face that touches at the origin of the surface frame only; the whole load acts there. It "
              "models the base of a body that slides without tipping. The other surface must be a plane.",
          .examples = {R"("position": [0, 0, -0.05], "normal": [0, 0, -1])"}},
     .read = [](dae::ObjectReader&) -> std::shared_ptr<const Surface> { return std::make_shared<Foot>(); },
     .z = "normal"});

}  // namespace

}  // namespace hilda::contact
