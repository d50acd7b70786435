// SPDX-License-Identifier: GPL-3.0-or-later
/// Fixed joint.
#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"

namespace hilda::dae {

Blocks fixed(int i, int j, const State& x)
{
    const Mat3 A_ij = motion(x, i).A.transpose() * motion(x, j).A;
    Blocks blocks;
    coincide(blocks, i, motion(x, i).A.transpose() * (motion(x, j).r - motion(x, i).r), j, Vec3::Zero());
    for (int k = 0; k < 3; ++k)
        add<DP1>(blocks, i, Vec3::Unit(k), j, A_ij.transpose() * Vec3::Unit((k + 1) % 3));
    return blocks;
}

namespace {

const TypeSchema schema_fixed = {
    .description = "Fixed joint, 6 rows: the relative position and orientation keep their initial values.",
    .examples = {R"("body_i": "crank", "body_j": "rod")"}};

const bool registered_fixed = io::Registry<ConstraintType>::add(
    {.name = "fixed",
     .schema = schema_fixed,
     .read = [](ObjectReader&, int i, int j, const State& x) -> ConstraintType::Constraints {
         return fixed(i, j, x);
     }});

}  // namespace

}  // namespace hilda::dae
