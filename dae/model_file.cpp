// SPDX-License-Identifier: GPL-3.0-or-later
/// ModelReader: builds a model from the JSON tree, and writes the canonical form of what it reads.
#include "dae/model_file.hpp"

#include "dae/body_reader.hpp"
#include "dae/model_types.hpp"
#include "dae/outputs/turn_counter.hpp"
#include "dae/parameters.hpp"
#include "io/expression.hpp"
#include "io/nearest.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace hilda::dae {

namespace {

std::string lower_case(std::string word)
{
    word[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(word[0])));
    return word;
}

class ModelReader final : public BodyFinder {
public:
    ModelReader(const JsonSource& source, const std::string& normal_rows, Description& out)
        : source(source), normal_rows(normal_rows), out(out), model(*out.model)
    {}

    void read()
    {
        ObjectReader o(source, source.root, "");
        o.defines(
            "model", "Model",
            "HILDA model file, version 1: rigid bodies, constraints, forces and contacts. Quantities are in "
            "SI units and angles in radians. Keys with _bar are components in a body frame. A number can "
            "be given as an expression in a string, such as \"pi/4\", see parameters. Symbols follow Fang "
            "(2022), Sec. 2.1. The program checks further rules that this schema does not express: names "
            "and ids are unique, JSON numbers are finite and keys are not repeated, strings have at most "
            "4096 bytes, orientations are rotations to within 1e-6, principal moments of inertia satisfy "
            "the triangle inequality, and the initial state satisfies the constraints to within 1e-9 "
            "(hilda run --fix-initial projects it onto them).");
        o.allow_schema(
            {"Path or address of the JSON schema of model files, for editors. It has no effect on the "
             "model.",
             R"("../dae/model.schema.json")"});
        version(o);
        out.name =
            o.name("name", {"Name of the model. It appears in results and messages.", R"("pendulum")"});
        parameters(o);
        model.gravity =
            o.vec3("gravity", {"Acceleration of gravity [m/s^2], in the global frame.", "[0, 0, -1.62]"},
                   model.gravity);
        out.end = o.positive("end", {"End time of a run [s]. The option --end replaces it.", "10"}, out.end);
        if (o.given("redundant")) {
            const About about = {
                "What happens to redundant constraint rows. drop: the rows that are redundant in the initial "
                "state are removed from the equations. keep: all rows are kept, and the saddle matrix is "
                "regularised. Mechanisms that pass through singular configurations, or whose redundant rows "
                "change during the motion, need keep.",
                R"("keep")", R"("default": "drop")"};
            model.keep_redundant = o.one_of("redundant", {"drop", "keep"}, about) == "keep";
        }
        bodies(o);
        optional_list(
            o, "constraints", "any_constraint",
            {"Joints, drivers and basic constraints. Redundant rows are detected at the start, reported "
             "and removed, unless the model has redundant = keep.",
             R"([{"type": "spherical", "body_i": "ground", "body_j": "ball"}])"},
            [this](const Json& v, const std::string& at) { return constraint(v, at); });
        optional_list(o, "forces", "any_force",
                      {"Forces and torques other than gravity, constraint forces and contact forces.",
                       R"([{"type": "force", "body": "ball", "frame": "global", "components": [1, 0, 0]}])"},
                      [this](const Json& v, const std::string& at) { return load(v, at); });
        contacts(o);
        if (o.given("outputs"))
            optional_list(o, "outputs", "any_output",
                          {"Quantities for the table outputs.csv of a run.",
                           R"([{"name": "tip", "type": "point", "body": "bar", "point_bar": [0.5, 0, 0]}])"},
                          [this](const Json& v, const std::string& at) { return output(v, at); });
        if (o.given("events"))
            optional_list(
                o, "events", "event",
                {"Instants at which a formula is zero: they are rows of events.csv, or end the run. Used "
                 "by hilda run.",
                 R"([{"name": "lowest", "value": "bar.vz", "direction": "rising"}])"},
                [this](const Json& v, const std::string& at) { return event(v, at); });
        out.text = canonical_text(o.finish());
        if (ignored > 0)
            out.warnings.push_back(ignored_place +
                                   ": f_dot and f_ddot are ignored, f is differentiated exactly; in " +
                                   std::to_string(ignored) + (ignored == 1 ? " constraint" : " constraints"));
    }

private:
    void parameters(ObjectReader& o)
    {
        o.find("parameters");  // read by Parameters
        o.note("parameters",
               R"("type": "object", "maxProperties": 1000, "propertyNames": {"pattern": )"
               R"("^[A-Za-z_][A-Za-z0-9_]*$"}, "additionalProperties": {"type": "number", "minLength": 1, )"
               R"("maxLength": 4096}, "properties": {"note": {"$ref": "#/$defs/note"}}, "default": {})",
               {"Named numbers of the model, without a unit of their own: each a number, or an expression of "
                "other parameters in a string. Every number of the model can be an expression of them, such "
                "as \"2*l\" or \"pi/4\"; in an expression of the time or of other variables they can be used "
                "as well. A name consists of letters, digits and underscores and must not be t, pi, e or the "
                "name of a function. The order does not matter, and cycles are errors.",
                R"({"l": 0.5, "m": "3*l"})"});
    }

    void bodies(ObjectReader& o)
    {
        o.note("bodies",
               R"("type": "array", "minItems": 1, "items": {"anyOf": [{"$ref": "#/$defs/body"}, {"$ref": )"
               R"("#/$defs/ground_body"}]}, "contains": {"$ref": "#/$defs/body"})",
               {"Bodies of the model, at least one of them with mass. Their order is the order of the "
                "columns in the results.",
                R"([{"name": "ball", "mass": 1, "inertia": [0.004, 0.004, 0.004], "r": [0, 0, 0.1]}])"});
        record_list(o, "bodies", o.list("bodies", true),
                    [this](const Json& v, const std::string& at) { return read_body(v, at); });
        if (model.all_bodies().empty())
            o.fail("bodies", "a model must have at least one body with mass, got none");
    }

    void version(ObjectReader& o)
    {
        o.note("hilda_model", R"("const": 1)",
               {"Version of the format. A file without this key is read as version 1, with a warning.", "1"});
        if (!o.has("hilda_model")) {
            o.refuse_other_kinds("hilda_model");
            // The published model files of the dissertation have no version.
            o.find("hilda_model");
            out.warnings.push_back(o.place() +
                                   ": the key 'hilda_model' is missing; the file is read as version 1");
            o.record("hilda_model", 1.0);
        } else {
            o.version("hilda_model");
        }
    }

    /// The same for a list that may be missing, whose elements have this definition in the schema
    template <class Read>
    void optional_list(ObjectReader& o, std::string_view key, const std::string& definition,
                       const About& about, Read read)
    {
        o.note(key, R"("type": "array", "default": [], "items": {"$ref": "#/$defs/)" + definition + R"("})",
               about);
        record_list(o, key, o.list(key, false), read);
    }

    /// Reads the elements of a list and records the text of their canonical forms. Elements with a null
    /// result are omitted. Only the text is kept: the tree of the elements needs many times its memory.
    template <class Read>
    void record_list(ObjectReader& o, std::string_view key, const Json::List& list, Read read)
    {
        const std::string pointer = o.pointer(key);
        std::string text = "[";
        for (size_t k = 0; k < list.size(); ++k) {
            const Json element = read(list[k], pointer_to(pointer, std::to_string(k)));
            if (element.members() == nullptr) continue;
            text += text.size() > 1 ? ",\n    " : "\n    ";
            append_deeper(text, written(element), "    ");
        }
        text += text.size() > 1 ? "\n  ]" : "]";
        list_text[std::string(key)] = std::move(text);
        o.record(key, {});  // its place among the keys
    }

    /// Appends a canonical text whose lines after the first are indented further.
    static void append_deeper(std::string& to, std::string_view text, std::string_view indent)
    {
        for (size_t end = 0; (end = text.find('\n')) != std::string_view::npos; text.remove_prefix(end + 1))
            to.append(text.substr(0, end + 1)) += indent;
        to += text;
    }

    /// The text of written() for the recorded members of the model and its lists
    std::string canonical_text(const Json& recorded) const
    {
        std::string text = "{";
        size_t size = 4096;  // of the other members
        for (const auto& list : list_text) size += list.second.size();
        text.reserve(size);
        for (const Json::Member& m : *recorded.members()) {
            text += text.size() > 1 ? ",\n  \"" : "\n  \"";
            (text += m.key) += "\": ";
            if (const auto list = list_text.find(m.key); list != list_text.end())
                text += list->second;
            else
                append_deeper(text, written(m.value), "  ");
        }
        text += "\n}\n";
        return text;
    }

    Json read_body(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        if (o.peek("id") != nullptr && !o.has("r") && !o.has("mass") && !o.has("inertia") && !o.has("shape"))
            return ground_body(o);
        o.defines("body", "Body", "A rigid body with its mass properties and its initial state.",
                  R"("anyOf": [{"required": ["mass", "inertia"]}, {"required": ["mass", "shape"]}, )"
                  R"({"required": ["density", "shape"]}])");
        const std::string name =
            o.name("name", {"Name of the body. It must be unique and must not be \"ground\".", R"("crank")",
                            R"("not": {"const": "ground"})"});
        if (name == "ground")
            o.fail("name", "the name 'ground' is reserved for the fixed body, got \"ground\"");
        register_body(o, name, model.bodies());
        Body b;
        b.name = name;
        read_mass(o, b);

        const Motion m = read_motion(o);
        Json recorded = o.finish();
        std::erase_if(std::get<Json::Object>(recorded.value), [](const Json::Member& k) {
            return k.key == "p" || k.key == "axis_angle" || k.key == "euler_angles" || k.key == "density";
        });
        try {
            model.add(std::move(b));
        } catch (const lie::InvalidInput& e) {
            o.fail("inertia", e.what());
        }
        out.x.body.push_back(m);
        return recorded;
    }

    /// The published files list the ground as a body without r. The canonical form omits it.
    Json ground_body(ObjectReader& o)
    {
        o.defines(
            "ground_body", "Ground entry",
            "An entry for the ground in the list of bodies. It is optional: the ground always exists under "
            "the name \"ground\". The entry gives it a second name and an id, as in the published files of "
            "the dissertation. At most one such entry is allowed.",
            R"("required": ["name", "id"])");
        const std::string name = o.name("name", {"Second name of the ground.", R"("base")"});
        if (ground_listed)
            o.fail("only one body without r and mass, the ground, is allowed; got a second one, '" + name +
                   "'");
        ground_listed = true;
        register_body(o, name, ground);
        o.finish();
        return {};
    }

    /// Registers the name of a body, and its id if it has one.
    void register_body(ObjectReader& o, const std::string& name, int number)
    {
        if (name != "ground" && !by_name.emplace(name, number).second)
            o.fail("name", "two bodies have the same name, got " + described(name));
        o.note("id", R"("$ref": "#/$defs/id")", {});
        if (o.find("id") != nullptr)
            if (const int id = o.integer("id"); !by_id.emplace(id, number).second)
                o.fail("id", "two bodies have the same id, got " + std::to_string(id));
    }

    std::optional<int> named(const std::string& name) const override
    {
        if (name == "ground") return ground;
        const auto found = by_name.find(name);
        return found != by_name.end() ? std::optional(found->second) : std::nullopt;
    }

    /// Number of the body whose name or id is given by a key
    int body(ObjectReader& o, std::string_view key, const About& about) const override
    {
        o.note(key, R"("$ref": "#/$defs/reference")", about);
        const Json* v = o.peek(key);
        if (v != nullptr && v->number() != nullptr) {
            const int id = o.integer(key);
            const auto found = by_id.find(id);
            if (found == by_id.end()) o.fail(key, "no body has this id, got " + std::to_string(id));
            o.record(key, model.body_name(found->second));
            return found->second;
        }
        if (v != nullptr && v->string() == nullptr)
            o.fail(key, std::string(key) + " must be the name or the id of a body, got " + described(*v));
        const std::string name = o.text(key);
        const std::optional<int> number = named(name);
        if (!number) o.fail(key, no_such_body(name));
        o.record(key, model.body_name(*number));
        return *number;
    }

    int body_of_list(ObjectReader& o, std::string_view key, size_t element) const override
    {
        const Json& v = o.list(key, true).at(element);
        if (const double* id = v.number(); id != nullptr) {
            const auto found = std::find_if(by_id.begin(), by_id.end(),
                                            [&](const auto& known) { return known.first == *id; });
            if (found == by_id.end()) o.fail(key, element, "no body has this id, got " + shortest(*id));
            return found->second;
        }
        if (v.string() == nullptr)
            o.fail(key, element,
                   "an element of " + std::string(key) + " must be the name or the id of a body, got " +
                       described(v));
        const std::optional<int> number = named(*v.string());
        if (!number) o.fail(key, element, no_such_body(*v.string()));
        return *number;
    }

    std::string no_such_body(const std::string& name) const
    {
        std::vector<std::string> known = {"ground"};
        for (const auto& entry : by_name) known.push_back(entry.first);
        return "no body has this name, got " + described(name) + io::did_you_mean(name, known);
    }

    /// body_i and body_j, which must differ
    std::pair<int, int> pair(ObjectReader& o) const override
    {
        const int i = body(o, "body_i", {"Body i.", R"("ground")"});
        const int j = body(o, "body_j", {"Body j; it must differ from body i.", R"("crank")"});
        if (i == j)
            o.fail("body_j",
                   "body_i and body_j must be two different bodies, got '" + model.body_name(i) + "' twice");
        return {i, j};
    }

    /// Name and type of a constraint or force. The default name consists of the type and the number in the
    /// list.
    template <class Type>
    std::pair<std::string, const Type*> heading(ObjectReader& o, const char* title,
                                                std::set<std::string>& used_names)
    {
        o.record("name", {});  // so that the name precedes the type
        if (const Json* v = o.find("type"); v != nullptr && v->string() != nullptr)
            if (const std::string meant = type_with_other_name(*v->string());
                io::Registry<Type>::find(*v->string()) == nullptr &&
                io::Registry<Type>::find(meant) != nullptr)
                o.fail("type", "unknown type " + described(*v) + "; did you mean '" + meant + "'?");
        const Type& type = *io::Registry<Type>::find(o.one_of("type", io::Registry<Type>::names()));
        io::defines_type(o, {title, "type", "Type of the " + lower_case(title) + '.'}, type.name, type.name,
                         type.schema);
        return {unique_name(o, type.name, used_names), &type};
    }

    Json constraint(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<ConstraintType>(o, "Constraint", constraint_names);
        const auto [i, j] = pair(o);
        ConstraintType::Constraints constraint =
            o.located([&, type = type, i = i, j = j] { return type->read(o, i, j, out.x); });
        Json recorded = o.finish();
        note_derivatives(o);
        if (auto* rows = std::get_if<Blocks>(&constraint)) {
            model.constrain(name, std::move(*rows));
            out.constraint_place.push_back(o.place());
        } else {
            model.constrain(name, std::get<std::unique_ptr<Constraint>>(std::move(constraint)));
            out.general_place.push_back(o.place());
        }
        return recorded;
    }

    /// The published files give f_dot and f_ddot, which follow from f here.
    void note_derivatives(const ObjectReader& o)
    {
        const bool given = o.has("f_dot") || o.has("f_ddot");
        if (given && ++ignored == 1) ignored_place = o.place(o.has("f_dot") ? "f_dot" : "f_ddot");
    }

    Json load(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<ForceType>(o, "Force", force_names);
        std::unique_ptr<Force> force = o.located([&, type = type] { return type->read(o, *this, out.x); });
        force->name = name;
        if (force->may_be_implicit() && o.given("implicit"))
            force->implicit =
                o.flag("implicit", {"Whether the spring and damper are evaluated implicitly by the "
                                    "integrators that can: rA-half-1, rA-half-1-kick and rA-half-1-momentum. "
                                    "The stiffness and the damping along its line then do not limit their "
                                    "step. Other integrators evaluate the force as without this key.",
                                    "true", R"("default": false)"});
        Json recorded = o.finish();
        model.load(std::move(force));
        out.force_place.push_back(o.place());
        return recorded;
    }

    Json output(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<OutputType>(o, "Output", output_names);
        std::unique_ptr<Output> output =
            o.located([&, type = type] { return type->read(o, *this, out.x, columns_of_outputs()); });
        output->name = name;
        if (output->place.empty()) output->place = o.place();
        output->name_place = o.place("name");
        Json recorded = o.finish();
        if (std::shared_ptr<TurnCounter> angle = output->turns()) model.count(std::move(angle));
        out.outputs.push_back(std::move(output));
        return recorded;
    }

    /// Columns with names that a parameter may have
    std::vector<std::string> columns_of_outputs() const
    {
        std::vector<std::string> columns = {"t", "energy"};
        for (const auto& preceding : out.outputs) columns.push_back(preceding->name);
        return columns;
    }

    Json event(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        o.defines(
            "event", "Event",
            "The instants at which a formula is zero. They are located between the nodes of a run to the "
            "last digits of t. Two zeros between two nodes are not seen.");
        const std::string name =
            unique_name(o, "event", event_names,
                        {.text = "Name of the event. It must be unique among the events. The default "
                                 "consists of \"event\" and the number in the list.",
                         .example = R"("lowest")",
                         .computed = true});
        Event event = read_event(o, columns_of_outputs());
        event.value->name = name;
        event.value->name_place = o.place("name");
        Json recorded = o.finish();
        out.events.push_back(std::move(event));
        return recorded;
    }

    void contacts(ObjectReader& o)
    {
        if (const ReadContacts read = contact_reader(); read != nullptr)
            return read(o, {.source = source, .bodies = *this, .out = out, .normal_rows = normal_rows});
        if (const Json::List& list = o.list("contacts", false); !list.empty())
            o.fail("contacts", "this program is built without contacts; the list must be empty, got " +
                                   std::to_string(list.size()));
    }

    const JsonSource& source;
    const std::string& normal_rows;
    Description& out;
    Model& model;
    std::map<std::string, int> by_name;
    std::map<int, int> by_id;
    std::map<std::string, std::string> list_text;  ///< canonical texts of the lists of the model, by key
    std::set<std::string> constraint_names, force_names, output_names, event_names;
    bool ground_listed = false;
    int ignored = 0;  // number of constraints with f_dot or f_ddot
    std::string ignored_place;
};

}  // namespace

Description read_model(std::string_view text, const std::string& file, std::span<const std::string> set,
                       const std::string& normal_rows, const std::string& folder, const std::string& within)
{
    JsonSource source{std::string(text), file};
    source.base = folder, source.within = within;
    for (const std::string& change : set) source.set(change);
    const Parameters parameters(source);
    source.parameters = &parameters;
    Description description;
    description.model = std::make_unique<Model>();
    description.changes.assign(set.begin(), set.end());
    ModelReader(source, normal_rows, description).read();
    parameters.check_added();
    const std::vector<std::string> warnings = parameters.warnings();
    description.warnings.insert(description.warnings.end(), warnings.begin(), warnings.end());
    description.parameters = parameters.all();
    description.files = source.files;
    return description;
}

void record_model(const std::string& example, const std::string& name, io::SchemaRecorder& recorder)
{
    JsonSource source(example, name, example.size() + 1);
    source.schema = &recorder;
    Description description;
    description.model = std::make_unique<Model>();
    ModelReader(source, {}, description).read();
}

Description load_model(const std::string& path, std::span<const std::string> set,
                       const std::string& normal_rows, bool allow_paths)
{
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw lie::InvalidInput(path + ": the file does not exist");
    if (!fs::is_regular_file(status)) throw lie::InvalidInput(path + ": a model file must be a regular file");
    const auto size = fs::file_size(path, error);
    if (!error && size > JsonSource::max_bytes)
        throw lie::InvalidInput(path + ": the file has " + std::to_string(size) + " bytes; at most " +
                                std::to_string(JsonSource::max_bytes) + " are allowed");
    std::ifstream in(path, std::ios::binary);
    std::string text(error ? 0 : size, '\0');
    if (error || !in.read(text.data(), static_cast<std::streamsize>(size)))
        throw lie::InvalidInput(
            path + ": the file cannot be read: " + (error ? error.message() : std::strerror(errno)));
    const std::string folder = fs::path(path).parent_path().string();
    const std::string within = allow_paths ? "" : fs::absolute(path).parent_path().string();
    Description description = read_model(text, path, set, normal_rows, folder, within);
    description.files.insert(description.files.begin(), path);
    return description;
}

std::string text_at(const Description& description, const State& x)
{
    JsonSource source(description.text, description.name);
    Json::List& bodies = std::get<Json::List>(source.root["bodies"].value);
    for (size_t b = 0; b < bodies.size(); ++b) {
        const Motion& m = x.body.at(b);
        bodies[b]["r"] = json(m.r);
        bodies[b]["A"] = json(m.A);
        bodies[b]["r_dot"] = json(m.rdot);
        bodies[b]["omega"] = json(m.omega_bar);
    }
    return written(source.root) + "\n";
}

StartReport start(Description& description, const StartOptions& options)
{
    try {
        StartReport report = start(*description.model, description.x, options);
        description.warnings.insert(description.warnings.end(), report.warnings.begin(),
                                    report.warnings.end());
        return report;
    } catch (const ConstraintError& e) {
        const std::vector<std::string>& place =
            e.general ? description.general_place : description.constraint_place;
        const auto k = static_cast<size_t>(e.constraint);
        if (k >= place.size()) throw;  // a constraint that is not from the file
        throw ConstraintError(place[k] + ": " + e.what(), e.constraint, e.general);
    } catch (const ForceError& e) {
        const auto k = static_cast<size_t>(e.force);
        if (k >= description.force_place.size()) throw;  // a force that is not from the file
        throw ForceError(description.force_place[k] + ": " + e.what(), e.force);
    }
}

}  // namespace hilda::dae
