// SPDX-License-Identifier: GPL-3.0-or-later
/// Type DP2 of the model file.
#include "dae/constraints/dp2.hpp"

#include "dae/model_types.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_dp2 = {
    .description =
        "Second dot-product constraint, one row: a_i . d_ij = f(t) (Fang 2022, Eq. 2.5b). d_ij is "
        "the vector from point P to point Q.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "a_bar_i": [0, 0, 1], )"
                 R"("s_bar_p_i": [0, 0.1, 0])"}};

const bool registered_dp2 = io::Registry<ConstraintType>::add(
    {.name = "DP2",
     .schema = schema_dp2,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Vec3 a_bar_i = o.direction(
             "a_bar_i", {"Vector a_i [-], in the frame of body i. It is not normalised.", "[0, 0, 1]"});
         const Points s(o);
         return single_row(
             DP2(i, a_bar_i, s.i, j, s.j,
                 read_value(o, {"Prescribed value f(t) [m], times the length of a_i.", R"-("0.1*sin(t)")-"},
                            "0")));
     }});

}  // namespace

}  // namespace hilda::dae
