// SPDX-License-Identifier: GPL-3.0-or-later
/// Planar joint.
#include "dae/constraints/dp2.hpp"
#include "dae/joints.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks planar(int i, const Vec3& s_bar_i, const Vec3& normal_bar_i, int j, const Vec3& s_bar_j,
              const Vec3& normal_bar_j)
{
    Blocks blocks;
    parallel(blocks, i, normal_bar_i, j, normal_bar_j);
    add<DP2>(blocks, i, unit(normal_bar_i), s_bar_i, j, s_bar_j);
    return blocks;
}

namespace {

const TypeSchema schema_planar = {
    .description =
        "Planar joint, 3 rows: point Q stays in the plane through P that is perpendicular to the axis of "
        "body i, and the axes stay parallel. Body j can slide in the plane and rotate about its normal.",
    .examples = {
        R"("body_i": "ground", "body_j": "disk", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1])"}};

const bool registered_planar = io::Registry<ConstraintType>::add(
    {.name = "planar",
     .schema = schema_planar,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return planar(i, s.i, axis.i, j, s.j, axis.j);
     }});

}  // namespace

}  // namespace hilda::dae
