// SPDX-License-Identifier: GPL-3.0-or-later
/// Translational (prismatic) joint.
#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks translational(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                     const Vec3& axis_bar_j, const State& x)
{
    Blocks blocks = cylindrical(i, s_bar_i, axis_bar_i, j, s_bar_j, axis_bar_j);
    const Perpendicular p(axis_bar_i);
    add<DP1>(blocks, i, p.first, j, motion(x, j).A.transpose() * (motion(x, i).A * p.second));
    return blocks;
}

namespace {

const TypeSchema schema_translational = {
    .description =
        "Translational (prismatic) joint, 5 rows: the axis through P and the axis through Q are "
        "collinear, and the relative orientation keeps its initial value.",
    .examples = {R"("body_i": "ground", "body_j": "slider", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0])"}};

const bool registered_translational = io::Registry<ConstraintType>::add(
    {.name = "translational",
     .schema = schema_translational,
     .read = [](ObjectReader& o, int i, int j, const State& x) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return translational(i, s.i, axis.i, j, s.j, axis.j, x);
     }});

}  // namespace

}  // namespace hilda::dae
