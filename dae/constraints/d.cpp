// SPDX-License-Identifier: GPL-3.0-or-later
/// Type D of the model file.
#include "dae/constraints/d.hpp"

#include "dae/model_types.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_d = {
    .description =
        "Distance constraint, one row: d_ij . d_ij = f(t) (Fang 2022, Eq. 2.5c). d_ij is the vector "
        "from point P to point Q.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "s_bar_p_i": [0, 0.1, 0], )"
                 R"("f": 0.25)"}};

const bool registered_d = io::Registry<ConstraintType>::add(
    {.name = "D",
     .schema = schema_d,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Points s(o);
         return single_row(D(i, s.i, j, s.j,
                             read_value(o, {"Square of the distance, f(t) [m^2]. It must be positive.",
                                            R"(0.25, "(0.5 + 0.1*sin(t))^2")", R"("exclusiveMinimum": 0)"})));
     }});

}  // namespace

}  // namespace hilda::dae
