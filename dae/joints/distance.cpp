// SPDX-License-Identifier: GPL-3.0-or-later
/// Distance joint.
#include "dae/joints.hpp"

#include "dae/constraints/d.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

namespace hilda::dae {

Blocks distance(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, double length)
{
    if (!(length > 0) || !std::isfinite(length))
        lie::reject("distance joint", "the length must be positive [m]", length);
    Blocks blocks;
    add<D>(blocks, i, s_bar_i, j, s_bar_j, Driver(length * length));
    return blocks;
}

namespace {

const TypeSchema schema_distance = {
    .description =
        "Distance joint, one row: points P and Q stay at a constant distance. It models a rigid link "
        "without mass.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "length": 0.5)"}};

const bool registered_distance = io::Registry<ConstraintType>::add(
    {.name = "distance",
     .schema = schema_distance,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         return distance(i, s.i, j, s.j, o.positive("length", {"Distance of P and Q [m].", "0.5"}));
     }});

}  // namespace

}  // namespace hilda::dae
