// SPDX-License-Identifier: GPL-3.0-or-later
/// Type DP1 of the model file.
#include "dae/constraints/dp1.hpp"

#include "dae/model_types.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_dp1 = {
    .description =
        "First dot-product constraint, one row: a_i . a_j = f(t) (Fang 2022, Eq. 2.5a). It "
        "prescribes the angle between a vector of body i and a vector of body j. It loses rank if "
        "the vectors become parallel.",
    .examples = {R"("body_i": "crank", "body_j": "rod", "a_bar_i": [1, 0, 0], )"
                 R"-("a_bar_j": [0, 1, 0], "f": "sin(0.1*t)")-"}};

const bool registered_dp1 = io::Registry<ConstraintType>::add(
    {.name = "DP1",
     .schema = schema_dp1,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         return single_row(
             DP1{i,
                 o.direction("a_bar_i",
                             {"Vector a_i [-], in the frame of body i. It is not normalised.", "[1, 0, 0]"}),
                 j,
                 o.direction("a_bar_j",
                             {"Vector a_j [-], in the frame of body j. It is not normalised.", "[0, 1, 0]"}),
                 read_value(o,
                            {"Prescribed value f(t) [-]. At the start |f| must be less than |a_i| |a_j|.",
                             R"-("cos(pi/2 + 0.1*t)")-"},
                            "0")});
     }});

}  // namespace

}  // namespace hilda::dae
