// SPDX-License-Identifier: GPL-3.0-or-later
/// Output type expression: a formula in the columns of the run.
#include "dae/outputs/expression.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_expression = {
    .description =
        "A formula in t, the parameters of the model and the columns of the run: those of trajectory.csv "
        "(BODY.rx, energy), forces.csv (SPRING.force), contacts.csv (CONTACT.F_N) and of the preceding "
        "outputs. A column whose name has other characters than letters, digits, _ and . is written in "
        "braces: {ball-floor.F_N}. The column has the name of the output.",
    .examples = {R"("name": "height", "value": "bar.rz + 0.5")"}};

const bool registered_expression = io::Registry<OutputType>::add(
    {.name = "expression",
     .schema = schema_expression,
     .read = [](ObjectReader& o, const BodyFinder&, const State&, const std::vector<std::string>& columns) {
         std::string value = o.formula_of_names(
             "value", columns,
             {"The formula. Operators and functions as in other formulas.", R"("2*bar.vx^2")"});
         std::string unit = o.text("unit", {"Unit, for the documentation of the column.", R"("J")"}, "");
         auto output = std::make_unique<ExpressionOutput>(std::move(value), std::move(unit));
         output->place = o.place("value");
         return std::unique_ptr<Output>(std::move(output));
     }});

}  // namespace

}  // namespace hilda::dae
