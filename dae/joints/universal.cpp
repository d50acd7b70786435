// SPDX-License-Identifier: GPL-3.0-or-later
/// Universal (Cardan) joint.
#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks universal(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                 const Vec3& axis_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    add<DP1>(blocks, i, unit(axis_bar_i), j, unit(axis_bar_j));
    return blocks;
}

namespace {

const TypeSchema schema_universal = {
    .description =
        "Universal (Cardan) joint, 4 rows: points P and Q coincide and the axes stay perpendicular.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [0, 1, 0])"}};

const bool registered_universal = io::Registry<ConstraintType>::add(
    {.name = "universal",
     .schema = schema_universal,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return universal(i, s.i, axis.i, j, s.j, axis.j);
     }});

}  // namespace

}  // namespace hilda::dae
