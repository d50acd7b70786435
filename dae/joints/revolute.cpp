// SPDX-License-Identifier: GPL-3.0-or-later
/// Revolute joint.
#include "dae/joints.hpp"

#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks revolute(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                const Vec3& axis_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    parallel(blocks, i, axis_bar_i, j, axis_bar_j);
    return blocks;
}

namespace {

const TypeSchema schema_revolute = {
    .description = "Revolute joint, 5 rows: points P and Q coincide and the axes are parallel.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "s_bar_p_i": [0, 0.1, 0], )"
                 R"("s_bar_q_j": [0, -0.2, 0], "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0])"}};

const bool registered_revolute = io::Registry<ConstraintType>::add(
    {.name = "revolute",
     .schema = schema_revolute,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return revolute(i, s.i, axis.i, j, s.j, axis.j);
     }});

}  // namespace

}  // namespace hilda::dae
