// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/columns_help.hpp"

#include "dae/model_file.hpp"
#include "run/columns/output_columns.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

/// A model with an entity of each kind that has columns
constexpr const char* example = R"({"hilda_model": 1, "name": "example",
 "bodies": [{"name": "BODY", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 1]}],
 "forces": [
  {"name": "SPRING", "type": "spring-damper", "body_i": "ground", "body_j": "BODY", "stiffness": 1, "free_length": 1},
  {"name": "LIMIT", "type": "distance-limit", "body_i": "ground", "body_j": "BODY", "maximum": 2, "stiffness": 1},
  {"name": "TORSION_SPRING", "type": "torsion-spring", "body_i": "ground", "body_j": "BODY", "axis_bar_i": [0, 0, 1],
   "axis_bar_j": [0, 0, 1], "stiffness": 1, "free_angle": 0},
  {"name": "BUSHING", "type": "bushing", "body_i": "ground", "body_j": "BODY", "stiffness": [1, 1, 1],
   "rotational_stiffness": [1, 1, 1]}],
 "contacts": [{"name": "CONTACT", "body_i": "BODY", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 1},
  "surface_j": {"type": "plane"}, "normal": {"type": "hooke", "stiffness": 1}}],
 "outputs": [
  {"name": "POINT", "type": "point", "body": "BODY"},
  {"name": "ANGLE", "type": "angle", "body_i": "ground", "body_j": "BODY", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
  {"name": "LENGTH", "type": "length", "body_i": "ground", "body_j": "BODY"}]})";

/// One line for successive columns with the same unit and meaning: "BODY.rx, ry, rz   m   position ..."
void append_columns(std::string& text, const run::ColumnGroup& group)
{
    const std::vector<dae::Quantity>& all = group.columns;
    for (size_t k = 0; k < all.size();) {
        std::string names = all[k].name;
        size_t next = k + 1;
        for (; next < all.size() && all[next].unit == all[k].unit && all[next].meaning == all[k].meaning;
             ++next)
            names += ", " + all[next].name.substr(all[next].name.rfind('.') + 1);
        text += fmt::format("  {}\n      [{}] {}\n", names, all[k].unit, all[k].meaning);
        k = next;
    }
}

}  // namespace

std::string columns_help()
{
    const dae::Description d = dae::read_model(example, "example");
    std::string text =
        "Columns of the tables of a run. Names in capitals stand for those of the model. SI units, radians.\n"
        "Every table begins with the column t, the time [s]. With --format hdf5 the tables are groups of "
        "run.h5.\n";
    text += "\ntrajectory.csv\n";
    append_columns(text, *run::body_columns(*d.model));
    text +=
        "  energy\n      [J] kinetic energy plus potential energy of gravity, springs and contacts\n"
        "  constraint_norm\n      [m or rad] largest scaled residual of the position constraints\n"
        "  With --reactions: loads of the constraints, see docs/guide/outputs.md.\n";
    text += "\nforces.csv (--forces)\n";
    append_columns(text, *run::force_columns(*d.model));
    text += "\ncontacts.csv (--contacts)\n";
    append_columns(text, *run::contact_columns(*d.model));
    text += "\noutputs.csv (\"outputs\" in the model file)\n";
    append_columns(text, run::OutputColumns(*d.model, d.outputs));
    text += "  NAME\n      an output of type \"expression\": a formula in t and any of these columns\n";
    return text;
}

}  // namespace hilda::studies
