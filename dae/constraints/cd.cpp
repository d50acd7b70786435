// SPDX-License-Identifier: GPL-3.0-or-later
/// Type CD of the model file.
#include "dae/constraints/cd.hpp"

#include "dae/model_types.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_cd = {
    .description =
        "Coordinate-difference constraint, one row: c . d_ij = f(t) (Fang 2022, Eq. 2.5d). d_ij is "
        "the vector from point P to point Q. It prescribes one coordinate of Q relative to P.",
    .examples = {R"("body_i": "ground", "body_j": "slider", "c": [1, 0, 0], "f": "0.2*t")"}};

const bool registered_cd = io::Registry<ConstraintType>::add(
    {.name = "CD",
     .schema = schema_cd,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Vec3 c =
             o.direction("c", {"Direction c [-], in the global frame. It is not normalised.", "[1, 0, 0]"});
         const Points s(o);
         return single_row(
             CD(c, i, s.i, j, s.j,
                read_value(o, {"Prescribed value f(t) [m], times the length of c.", R"("0.2*t")"}, "0")));
     }});

}  // namespace

}  // namespace hilda::dae
