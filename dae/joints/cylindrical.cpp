// SPDX-License-Identifier: GPL-3.0-or-later
/// Cylindrical joint.
#include "dae/joints.hpp"

#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                   const Vec3& axis_bar_j)
{
    Blocks blocks;
    parallel(blocks, i, axis_bar_i, j, axis_bar_j);
    on_axis(blocks, i, s_bar_i, axis_bar_i, j, s_bar_j);
    return blocks;
}

namespace {

const TypeSchema schema_cylindrical = {
    .description =
        "Cylindrical joint, 4 rows: the axis through P and the axis through Q are collinear. Body j "
        "can slide along the common axis and rotate about it.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0])"}};

const bool registered_cylindrical = io::Registry<ConstraintType>::add(
    {.name = "cylindrical",
     .schema = schema_cylindrical,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return cylindrical(i, s.i, axis.i, j, s.j, axis.j);
     }});

}  // namespace

}  // namespace hilda::dae
