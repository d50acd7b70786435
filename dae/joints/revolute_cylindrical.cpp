// SPDX-License-Identifier: GPL-3.0-or-later
/// Revolute-cylindrical joint.
#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks revolute_cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                            const Vec3& axis_bar_j)
{
    Blocks blocks;
    add<DP1>(blocks, i, unit(axis_bar_i), j, unit(axis_bar_j));
    on_axis(blocks, j, s_bar_j, axis_bar_j, i, s_bar_i);
    return blocks;
}

namespace {

const TypeSchema schema_revolute_cylindrical = {
    .description =
        "Revolute-cylindrical joint, 3 rows: point P slides along the axis of body j, which stays "
        "perpendicular to the axis of body i.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [0, 1, 0])"}};

const bool registered_revolute_cylindrical = io::Registry<ConstraintType>::add(
    {.name = "revolute-cylindrical",
     .schema = schema_revolute_cylindrical,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return revolute_cylindrical(i, s.i, axis.i, j, s.j, axis.j);
     }});

}  // namespace

}  // namespace hilda::dae
