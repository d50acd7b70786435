// SPDX-License-Identifier: GPL-3.0-or-later
/// Spherical joint.
#include "dae/joints.hpp"

#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks spherical(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    return blocks;
}

namespace {

const TypeSchema schema_spherical = {
    .description = "Spherical joint, 3 rows: points P and Q coincide.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "s_bar_p_i": [0, 0.1, 0], )"
                 R"("s_bar_q_j": [0, -0.2, 0])"}};

const bool registered_spherical = io::Registry<ConstraintType>::add(
    {.name = "spherical",
     .schema = schema_spherical,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         return spherical(i, s.i, j, s.j);
     }});

}  // namespace

}  // namespace hilda::dae
