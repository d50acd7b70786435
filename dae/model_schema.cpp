// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files, recorded from the reader, with the registered types.
#include "dae/model_schema.hpp"

#include "dae/force.hpp"
#include "dae/model_file.hpp"
#include "dae/model_types.hpp"
#include "dae/outputs/output.hpp"
#include "io/schema/type_schema.hpp"

#include <set>

namespace hilda::dae {

namespace {

/// Values that several keys have
constexpr const char* values = R"-({
  "name": {
    "title": "Name", "description": "A string of 1 to 4096 bytes without control characters.",
    "type": "string", "minLength": 1, "maxLength": 4096, "pattern": "^[^\\u0000-\\u001f\\u007f]*$",
    "examples": ["crank"]
  },
  "note": {
    "description": "Free text for the reader of the file. It has no effect on the model.",
    "type": "string", "maxLength": 4096, "examples": ["Table 5.1"]
  },
  "id": {
    "description": "Number of the body. References can use it instead of the name. It must be unique.",
    "type": "integer", "minimum": -2147483647, "maximum": 2147483647, "examples": [1]
  },
  "reference": {
    "title": "Body reference",
    "description": "A body, given by its name or by its id. \"ground\" is the fixed body; its frame is the global frame.",
    "type": ["string", "integer"], "examples": ["crank", "ground", 1]
  },
  "references": {
    "title": "Body references", "description": "A list of different bodies.",
    "type": "array", "items": {"$ref": "#/$defs/reference"}, "minItems": 1, "uniqueItems": true,
    "examples": [["ball-1", "ball-2"]]
  },
  "vector": {
    "title": "Vector",
    "description": "Three components x, y, z. The description of the key states the frame: global, body or surface.",
    "type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3, "examples": [[0, 0, -9.81]]
  },
  "direction": {
    "title": "Direction",
    "description": "A vector that is not zero. Its length has no effect unless the key states otherwise.",
    "$ref": "#/$defs/vector", "contains": {"not": {"const": 0}}, "examples": [[0, 0, 1]]
  },
  "matrix": {
    "title": "Matrix", "description": "A 3x3 matrix as a list of its three rows.",
    "type": "array", "items": {"$ref": "#/$defs/vector"}, "minItems": 3, "maxItems": 3,
    "examples": [[[1, 0, 0], [0, 0, -1], [0, 1, 0]]]
  },
  "coefficients": {
    "title": "Coefficients", "description": "Three numbers that are not negative, one for each axis.",
    "type": "array", "items": {"type": "number", "minimum": 0}, "minItems": 3, "maxItems": 3,
    "examples": [[100, 100, 10]]
  },
  "dimensions": {
    "title": "Dimensions", "description": "Positive numbers.",
    "type": "array", "items": {"type": "number", "exclusiveMinimum": 0}, "examples": [[0.2, 0.1, 0.05]]
  },
  "formula": {
    "title": "Formula",
    "description": "A number, or an expression in the time t [s] as a string. Operators: + - * / ^ (or **). Constants: pi, e. Functions: sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, log, sqrt, abs, min(a,b), max(a,b), step(x) = 0 for x < 0 and 1 otherwise, if(c,a,b) = a for c > 0 and b otherwise. The exponent of ^ must be constant. Time derivatives are exact.",
    "type": "number", "minLength": 1, "maxLength": 4096, "examples": ["pi/4*cos(2*t)", 0.5]
  },
  "motion": {
    "title": "Prescribed motion",
    "description": "A formula, or samples of a function of time: the columns t [s] and `column` of a CSV file, or the lists t and f. The function is the quintic spline through the samples, with exact derivatives. It needs at least 6 samples, the first one at t = 0 or before, and the run must end at the last one.",
    "anyOf": [
      {"$ref": "#/$defs/formula"},
      {
        "type": "object", "required": ["file", "column"], "additionalProperties": false,
        "properties": {
          "file": {
            "description": "CSV file, relative to the folder of the model file.",
            "type": "string", "examples": ["motion.csv"]
          },
          "column": {"description": "Name of its column of values.", "type": "string", "examples": ["crank"]}
        }
      },
      {
        "type": "object", "required": ["t", "f"], "additionalProperties": false,
        "properties": {
          "t": {"description": "Times [s], ascending.", "type": "array", "items": {"type": "number"}, "minItems": 6},
          "f": {"description": "Values.", "type": "array", "items": {"type": "number"}, "minItems": 6}
        }
      }
    ],
    "examples": ["pi/4*cos(2*t)", {"file": "motion.csv", "column": "crank"}]
  }
})-";

/// Two examples; the first one is that of the model
const std::vector<std::string> models = {
    R"({"hilda_model": 1, "name": "pendulum", "end": 2, "bodies": [{"name": "bar", "mass": 1, )"
    R"("inertia": [0.0833, 0.0833, 0.001], "r": [0, 0.5, 0]}], "constraints": [{"name": "pivot", )"
    R"("type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, -0.5, 0], )"
    R"("axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}]})",
    R"({"name": "bodies", "bodies": [{"name": "crank", "id": 1, "mass": 1.5, "inertia": [0.02, 0.02, 0.001], )"
    R"("r": [0, 0.1, 0], "axis_angle": [1, 0, 0, 0.5], "omega": [2, 0, 0]}, {"name": "roller", )"
    R"("density": 7850, "shape": {"cylinder": [0.05, 0.2], "axis": "x"}, "r": [0, 0, 0.05], )"
    R"("euler_angles": {"sequence": "zxz", "angles": [0.5, 1.2, 0]}}, {"name": "base", "id": 0}, )"
    R"({"name": "brick", "mass": 2, "shape": {"box": [0.2, 0.1, 0.05]}, "r": [1, 0, 0]}, )"
    R"({"name": "stone", "density": 2600, "shape": {"convex": {"vertices": [[0.1, 0.1, 0.1], )"
    R"([0.1, -0.1, -0.1], [-0.1, 0.1, -0.1], [-0.1, -0.1, 0.1]]}}, "r": [2, 0, 0]}], )"
    R"("events": [{"name": "lowest", "value": "bar.vz", "direction": "rising"}]})"};

/// A model with the example of a type in this list, and with the bodies that the example names
std::string model_with(const std::string& list, const std::string& type, const std::string& example)
{
    const Json entry = io::parsed_schema(io::example_text("type", type, example), "example of " + type);
    std::set<std::string> names = {"body"};
    for (const Json::Member& m : *entry.members())
        if (const std::string* const name = m.value.string();
            name != nullptr && *name != "ground" && (m.key.starts_with("body") || m.key == "observer"))
            names.insert(*name);
    Json bodies = Json::array();
    for (const std::string& name : names)
        bodies.push_back({{"name", name},
                          {"mass", 1.},
                          {"inertia", {1., 1., 1.}},
                          {"r", {0.3 * static_cast<double>(bodies.size()), 1., 0.}}});
    return written({{"name", "example"}, {"bodies", bodies}, {list, Json::List{entry}}});
}

/// Records the examples of the registered types, which are elements of the list.
template <class Type>
void record_types(io::SchemaRecorder& recorder, const std::string& list)
{
    for (const Type& type : io::Registry<Type>::all()) {
        if (type.schema.examples.empty())
            throw io::InvalidInput("type " + type.name + ": the schema needs an example of it");
        for (const std::string& example : type.schema.examples)
            record_model(model_with(list, type.name, example), "example of type " + type.name, recorder);
        Json& examples = recorder.definition(type.name)->examples;
        examples = Json::array();
        for (const std::string& example : type.schema.examples)
            examples.push_back(io::parsed_schema(io::example_text("type", type.name, example), type.name));
    }
}

template <class Type>
void add_group(Json& definitions, const std::string& kind, const std::string& title,
               const std::string& description)
{
    io::add_choice(definitions, "any_" + kind, title, description, io::Registry<Type>::names());
}

/// Allows an expression in a string wherever a number is allowed.
void allow_expressions(io::Json& node)
{
    if (auto* list = std::get_if<io::Json::List>(&node.value))
        for (io::Json& element : *list) allow_expressions(element);
    auto* members = std::get_if<io::Json::Object>(&node.value);
    if (members == nullptr) return;
    for (io::Json::Member& m : *members) {
        const std::string* word = m.value.string();
        if (m.key == "type" && word != nullptr && *word == "number")
            m.value = io::Json::List{"number", "string"};
        else if (m.key != "examples" && m.key != "default" && m.key != "const")
            allow_expressions(m.value);
    }
}

}  // namespace

io::Json model_schema()
{
    io::SchemaRecorder recorder;
    recorder.definition("model");
    recorder.shown = {"model", "body", "shape", "convex_shape", "ground_body", "euler_angles", "event"};
    for (const std::string& model : models) {
        record_model(model, "example of a model", recorder);
        recorder.shown.erase("model");
    }
    recorder.shown = {"contact", "constraint", "dvi", "rolling", "implicit", "coulomb"};
    for (const SchemaPart& part : io::Registry<SchemaPart>::all()) {
        for (const std::string& model : part.models) record_model(model, "example of " + part.name, recorder);
        part.record(recorder);
    }
    recorder.shown.clear();
    record_types<ConstraintType>(recorder, "constraints");
    record_types<ForceType>(recorder, "forces");
    record_types<OutputType>(recorder, "outputs");
    Json schema = recorder.schema("model");
    Json& definitions = schema["$defs"];
    add_group<ConstraintType>(
        definitions, "constraint", "Constraint",
        "A joint, a driver or one of the four basic constraints of Fang (2022), Eq. 2.5.");
    add_group<ForceType>(definitions, "force", "Force", "A force or torque, selected by its type.");
    add_group<OutputType>(definitions, "output", "Output",
                          "Quantities for the table outputs.csv of a run, selected by their type.");
    for (const SchemaPart& part : io::Registry<SchemaPart>::all()) part.add(definitions);
    definitions.update(io::parsed_schema(values, "values"));
    allow_expressions(schema);
    return schema;
}

}  // namespace hilda::dae
