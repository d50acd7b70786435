// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of cases, recorded from the reader, with the force laws and the registered types.
#include "granular/case/case_schema.hpp"

#include "granular/case/boundary_keys.hpp"
#include "granular/case/case_file.hpp"
#include "granular/case/law_list.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/insertion/sizes.hpp"

namespace hilda::granular {

namespace {

/// Values that several keys have
constexpr const char* values = R"-({
  "vector": {
    "title": "Vector", "description": "Three components x, y, z in the global frame.",
    "type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3, "examples": [[0, 0, -9.81]]
  },
  "direction": {
    "title": "Direction", "description": "A vector that is not zero. Its length has no effect.",
    "allOf": [{"$ref": "#/$defs/vector"}, {"not": {"items": {"const": 0}}}], "examples": [[0, 0, 1]]
  },
  "formulas": {
    "title": "Formulas",
    "description": "Three components x, y, z in the global frame. Each is a number or an expression in the time t [s] as a string, such as \"1e-3*sin(2*pi*20*t)\". The syntax is that of the formulas of a model file.",
    "type": "array", "items": {"type": ["number", "string"]}, "minItems": 3, "maxItems": 3,
    "examples": [["1e-3*sin(2*pi*20*t)", 0, 0]]
  },
  "inertia": {
    "description": "Moments of inertia [kg m^2]: one, three principal ones, or a symmetric matrix.",
    "anyOf": [
      {"type": "number", "minimum": 0},
      {"$ref": "#/$defs/vector"},
      {"type": "array", "items": {"$ref": "#/$defs/vector"}, "minItems": 3, "maxItems": 3}
    ]
  },
  "note": {
    "description": "Free text for the reader of the file. It has no effect.", "type": "string", "examples": ["quick version"]
  }
})-";

/// Conditions of a boundary on several keys: a part has no motion of its own; the keys of a rigid body need a
/// mass; formulas of r and omega exclude other motions.
constexpr const char* of_boundaries = R"-([
  {"if": {"required": ["part_of"]}, "then": {"not": {"anyOf": [
    {"required": ["v"]}, {"required": ["omega"]}, {"required": ["mass"]}, {"required": ["inertia"]},
    {"required": ["free"]}, {"required": ["F"]}, {"required": ["T"]},
    {"required": ["r"], "properties": {"r": {"type": "array", "contains": {"type": "string"}}}}]}}},
  {"if": {"anyOf": [{"required": ["inertia"]}, {"required": ["free"]}, {"required": ["F"]}, {"required": ["T"]}]},
   "then": {"anyOf": [{"required": ["mass"]}, {"required": ["density"]}, {"required": ["from_parts"]}]}},
  {"not": {"required": ["r", "v"], "properties": {
    "r": {"type": "array", "contains": {"type": "string"}}, "v": {"not": {"items": {"const": 0}}}}}},
  {"not": {"required": ["inertia", "omega"], "properties": {
    "inertia": {"not": {"const": 0}}, "omega": {"type": "array", "contains": {"type": "string"}},
    "free": {"not": {"minItems": 6, "contains": {"const": false}}}}}}
])-";

constexpr const char* shown_case = R"({
  "hilda_case": 1, "name": "box_of_beads", "domain": {"low": [-0.004, -0.004, -0.004], "high": [0.034, 0.024, 0.06]},
  "step": 5e-6, "end": 0.2, "interval": 0.002, "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
  "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"}}],
  "boundaries": [{"name": "box", "type": "box", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], "open": ["+z"]}],
  "fill": [{"type": "lattice", "low": [0, 0, 0], "high": [0.03, 0.02, 0.028], "radius": 0.001, "jitter": 0.5}]
})";

/// Beginning of a case, and its materials
const std::string start = R"({"hilda_case": 1, "step": 5e-6, "end": 1, "orientation": true,
  "domain": {"low": [-0.1, -0.1, -0.01], "high": [0.1, 0.1, 0.2], "periodic": [true, true, false]}, )";
const std::string glass = R"("materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}], )";

/// Further members of cases, with entries without registered types
const std::vector<std::string> examples = {
    glass + R"("laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"},
      "rolling": {"law": "epsd", "mu_r": 0.05, "eta_r": 0.3}}])",
    R"("materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24},
      {"name": "steel", "density": 7800, "E": 2e8, "nu": 0.3}],
      "laws": [{"between": ["glass", "steel"], "mu": 0.1, "normal": {"law": "hooke", "k_n": 1e4, "gamma_n": 10},
        "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3}}])",
    glass + R"("clumps": [{"name": "pair", "spheres": [{"r": [5e-4, 0, 0], "radius": 1e-3},
        {"r": [-5e-4, 0, 0], "radius": 1e-3}]}],
      "particles": [{"r": [0, 0, 0.01], "radius": 0.001, "v": [0, 0, -1]}, {"clump": "pair", "r": [0, 0, 0.02]}])",
    glass + R"("insert": [{"name": "feed", "rate": 2000, "to": 0.5, "radius": 0.001, "v": [0, 0, -1],
        "region": {"type": "box", "low": [0, 0, 0.09], "high": [0.03, 0.02, 0.1]}},
      {"name": "drop", "count": 500, "radius": 0.001,
        "region": {"type": "cylinder", "r": [0, 0, 0.1], "axis": [0, 0, 1], "radius": 0.04, "length": 0.02}},
      {"name": "rain", "mass_rate": 0.05, "radius": 0.001,
        "region": {"type": "disk", "r": [0, 0, 0.1], "normal": [0, 0, 1], "radius": 0.04}}])",
    glass +
        R"("boundaries": [{"type": "plane", "normal": [0, 0, 1]}], "loads": {"interval": 0.01, "samples": 50},
      "contacts": {"interval": 0.05, "times": [0.12], "network": true},
      "fields": [{"name": "profile", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], "cells": [1, 1, 60],
        "width": 0.001, "interval": 0.01, "samples": 20},
      {"name": "slice", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], "cells": [30, 1, 60], "width": 0.001,
        "kernel": "lucy", "interval": 0.05}])",
    glass + R"("stages": [
      {"name": "settle", "duration": 0.5, "until": {"share": 1e-4, "from": 0.02}, "on_timeout": "fail"},
      {"name": "level", "remove": [{"type": "half_space", "r": [0, 0, 0.03], "normal": [0, 0, 1]},
        {"type": "box", "low": [0, 0, 0.03], "high": [0.03, 0.02, 0.1]},
        {"type": "cylinder", "r": [0, 0, 0], "axis": [0, 0, 1], "radius": 0.01, "length": 0.1}]}])"};

/// Reads a case for the schema.
void record(io::SchemaRecorder& recorder, const std::string& text)
{
    io::JsonSource source(text, "example of a case", text.size() + 1);
    source.schema = &recorder;
    read_case(source, {.with_particles = false});
}

/// Records the examples of the registered types, each in a case in which it is between two texts.
template <class Type>
void record_types(io::SchemaRecorder& recorder, const std::string& prefix, const std::string& before,
                  const std::string& after)
{
    for (const Type& type : io::Registry<Type>::all()) {
        recorder.shown = {prefix + type.name};
        for (const std::string& example : type.schema.examples)
            record(recorder, start + glass + before + io::example_text("type", type.name, example) + after);
    }
}

/// Adds the definitions that select one of several types.
void add_choices(io::Json& definitions)
{
    io::add_choice(
        definitions, "boundary", "Boundary",
        "A surface that interacts with the particles, selected by its type. run.csv lists for each boundary "
        "the total contact force [N] and the torque about its r [N m], in the global frame.",
        io::Registry<BoundaryType>::names());
    definitions["boundary"]["allOf"] = io::parsed_schema(of_boundaries, "boundary");
    io::add_choice(
        definitions, "fill", "Fill",
        "A set of particles: a regular or random arrangement in a box, or the rows of a CSV table.",
        io::Registry<FillType>::names());
    io::add_choice(definitions, "sizes", "Size distribution",
                   "Distribution of the radii of particles, by number or by mass.",
                   io::Registry<SizeType>::names(), "sizes_");
    io::add_choice(definitions, "region", "Region", "Region of an insertion: a box, a cylinder or a disk.",
                   {"box", "cylinder", "disk"}, "region_");
    io::add_choice(definitions, "cut", "Cut",
                   "Region that selects particles: those whose centres are in it, and the clumps whose "
                   "centres of mass are in it.",
                   {"box", "cylinder", "half_space"}, "cut_");
}

}  // namespace

io::Json case_schema()
{
    io::SchemaRecorder recorder;
    recorder.kinds["name"] = {{"type", "string"}, {"minLength", 1}};
    recorder.shown = {"case"};
    record(recorder, shown_case);
    recorder.shown = {"stage",      "cut_box",         "cut_cylinder", "cut_half_space", "rest_condition",
                      "domain",     "material",        "field",        "contact_output", "load_output",
                      "law",        "clump",           "clump_sphere", "particle",       "insertion",
                      "region_box", "region_cylinder", "region_disk"};
    for (const std::string& example : examples) record(recorder, start + example + '}');
    record_types<BoundaryType>(recorder, "", R"("boundaries": [)", "]}");
    record_types<FillType>(recorder, "", R"("fill": [)", "]}");
    record_types<SizeType>(
        recorder, "sizes_",
        R"("fill": [{"type": "lattice", "low": [0, 0, 0], "high": [0.03, 0.02, 0.03], "sizes": )", "}]}");
    const io::Json laws = record_laws(recorder);
    io::Json schema = recorder.schema("case");
    io::Json& definitions = schema["$defs"];
    definitions.update(laws);
    add_choices(definitions);
    definitions.update(io::parsed_schema(values, "values"));
    return schema;
}

}  // namespace hilda::granular
