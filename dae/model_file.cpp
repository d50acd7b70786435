// SPDX-License-Identifier: GPL-3.0-or-later
/// ModelReader: builds a model from the JSON tree, and writes the canonical form of what it reads.
#include "dae/model_file.hpp"

#include "dae/body_reader.hpp"
#include "dae/contact_pairs.hpp"
#include "dae/model_types.hpp"
#include "dae/parameters.hpp"
#include "io/expression.hpp"
#include "io/nearest.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace hilda::dae {

namespace {

class ModelReader final : public BodyFinder {
public:
    ModelReader(const JsonSource& source, const std::string& normal_rows, Description& out)
        : source(source), normal_rows(normal_rows), out(out), model(*out.model)
    {}

    void read()
    {
        ObjectReader o(source, source.root, "");
        version(o);
        out.name = o.name("name");
        model.gravity = o.vec3("gravity", model.gravity);
        out.end = o.positive("end", out.end);
        if (o.has("redundant")) model.keep_redundant = o.one_of("redundant", {"drop", "keep"}) == "keep";
        o.record("bodies", each(o, "bodies", true,
                                [this](const Json& v, const std::string& at) { return read_body(v, at); }));
        if (model.all_bodies().empty())
            o.fail("bodies", "a model must have at least one body with mass, got none");
        o.record("constraints", each(o, "constraints", false, [this](const Json& v, const std::string& at) {
                     return constraint(v, at);
                 }));
        o.record("forces", each(o, "forces", false,
                                [this](const Json& v, const std::string& at) { return load(v, at); }));
        contacts(o);
        if (o.has("outputs"))
            o.record("outputs", each(o, "outputs", false,
                                     [this](const Json& v, const std::string& at) { return output(v, at); }));
        if (o.has("events"))
            o.record("events", each(o, "events", false,
                                    [this](const Json& v, const std::string& at) { return event(v, at); }));
        o.find("parameters");  // read by Parameters
        o.allow_schema();
        out.text = written(o.finish()) + "\n";
        if (ignored > 0)
            out.warnings.push_back(ignored_place +
                                   ": f_dot and f_ddot are ignored, f is differentiated exactly; in " +
                                   std::to_string(ignored) + (ignored == 1 ? " constraint" : " constraints"));
    }

private:
    void version(ObjectReader& o)
    {
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

    /// Reads the elements of a list and returns their canonical forms. Elements with a null result are
    /// omitted.
    template <class Read>
    Json each(ObjectReader& o, std::string_view key, bool required, Read read)
    {
        Json::List recorded;
        const Json::List& list = o.list(key, required);
        for (size_t k = 0; k < list.size(); ++k) {
            Json element = read(list[k], pointer_to(o.pointer(key), std::to_string(k)));
            if (element.members() != nullptr) recorded.push_back(std::move(element));
        }
        return recorded;
    }

    Json read_body(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const std::string name = o.name("name");
        if (o.has("id") && !o.has("r") && !o.has("mass") && !o.has("inertia") && !o.has("shape"))
            return ground_body(o, name);
        if (name == "ground")
            o.fail("name", "the name 'ground' is reserved for the fixed body, got \"ground\"");
        register_body(o, name, model.bodies());
        Body b;
        b.name = name;
        read_mass(o, b);

        Motion m;
        m.r = o.vec3("r");
        m.A = read_orientation(o);
        o.record("A", json(m.A));
        m.rdot = o.vec3("r_dot", Vec3::Zero());
        m.omega_bar = o.vec3("omega", Vec3::Zero());
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
    Json ground_body(ObjectReader& o, const std::string& name)
    {
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
    int body(ObjectReader& o, std::string_view key) const override
    {
        const Json* v = o.find(key);
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
        const int i = body(o, "body_i"), j = body(o, "body_j");
        if (i == j)
            o.fail("body_j",
                   "body_i and body_j must be two different bodies, got '" + model.body_name(i) + "' twice");
        return {i, j};
    }

    /// Name and type of a constraint or force. The default name consists of the type and the number in the
    /// list.
    template <class Type>
    std::pair<std::string, const Type*> heading(ObjectReader& o, std::set<std::string>& used_names)
    {
        o.record("name", {});  // so that the name precedes the type
        if (const Json* v = o.find("type"); v != nullptr && v->string() != nullptr)
            if (const std::string meant = type_with_other_name(*v->string());
                io::Registry<Type>::find(*v->string()) == nullptr &&
                io::Registry<Type>::find(meant) != nullptr)
                o.fail("type", "unknown type " + described(*v) + "; did you mean '" + meant + "'?");
        const std::string type = o.one_of("type", io::Registry<Type>::names());
        return {unique_name(o, type, used_names), io::Registry<Type>::find(type)};
    }

    /// A name that is not used yet. The default consists of the kind and the number in the list.
    static std::string unique_name(ObjectReader& o, const std::string& kind,
                                   std::set<std::string>& used_names)
    {
        std::string name = o.name("name", kind + "-" + std::to_string(used_names.size() + 1));
        if (!used_names.insert(name).second)
            o.fail("name", "this name is already used, got " + described(name));
        return name;
    }

    Json constraint(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<ConstraintType>(o, constraint_names);
        const auto [i, j] = pair(o);
        ConstraintType::Constraints constraint =
            o.located([&, type = type, i = i, j = j] { return type->read(o, i, j, out.x); });
        if (std::count(type->schema.parts.begin(), type->schema.parts.end(), "derivatives") > 0)
            ignore_derivatives(o);
        Json recorded = o.finish();
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
    void ignore_derivatives(ObjectReader& o)
    {
        const bool given = o.has("f_dot") || o.has("f_ddot");
        if (given && ++ignored == 1) ignored_place = o.place(o.has("f_dot") ? "f_dot" : "f_ddot");
        o.find("f_dot");
        o.find("f_ddot");
    }

    Json load(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<ForceType>(o, force_names);
        std::unique_ptr<Force> force = o.located([&, type = type] { return type->read(o, *this, out.x); });
        force->name = name;
        if (force->may_be_implicit() && o.has("implicit")) force->implicit = o.flag("implicit");
        Json recorded = o.finish();
        model.load(std::move(force));
        out.force_place.push_back(o.place());
        return recorded;
    }

    Json output(const Json& v, const std::string& at)
    {
        ObjectReader o(source, v, at);
        const auto [name, type] = heading<OutputType>(o, output_names);
        std::unique_ptr<Output> output =
            o.located([&, type = type] { return type->read(o, *this, out.x, columns_of_outputs()); });
        output->name = name;
        if (output->place.empty()) output->place = o.place();
        output->name_place = o.place("name");
        Json recorded = o.finish();
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
        const std::string name = unique_name(o, "event", event_names);
        Event event = read_event(o, columns_of_outputs());
        event.value->name = name;
        event.value->name_place = o.place("name");
        Json recorded = o.finish();
        out.events.push_back(std::move(event));
        return recorded;
    }

    /// The canonical form has the key only if there are contacts. It has one element for each pair of a
    /// group.
    void contacts(ObjectReader& o)
    {
        const Json::List& list = o.list("contacts", false);
        if (list.empty()) return;
        const ReadContact read = contact_reader();
        if (read == nullptr)
            o.fail("contacts", "this program is built without contacts; the list must be empty, got " +
                                   std::to_string(list.size()));
        Json::List recorded;
        for (size_t k = 0; k < list.size(); ++k)
            contact(read, list[k], pointer_to("/contacts", std::to_string(k)), recorded);
        o.record("contacts", std::move(recorded));
    }

    void contact(ReadContact read, const Json& v, const std::string& at, Json::List& recorded)
    {
        std::shared_ptr<const void> shared;
        ObjectReader entry(source, v, at);
        const std::string entry_name = unique_name(entry, "contact", contact_names);
        const ContactPairs all = read_contact_pairs(entry, *this, model.bodies());
        for (const auto& [i, j] : all.pairs) {
            ObjectReader o(source, v, at);
            const std::string name = all.is_group ? pair_name(entry_name, i, j) : entry_name;
            o.record("name", name);
            for (const auto& [key, number] : {std::pair("body_i", i), std::pair("body_j", j)})
                o.find(key), o.record(key, model.body_name(number));
            for (const char* key : {"name", "bodies"}) o.find(key);
            const auto read_pair = [&, i = i, j = j] {
                read(o, {.name = name,
                         .i = i,
                         .j = j,
                         .model = model,
                         .start = out.x,
                         .normal_rows = normal_rows,
                         .changes = out.changes,
                         .surface_i = all.surface_i,
                         .surface_j = all.surface_j,
                         .shared = shared});
            };
            o.located([&] {
                try {
                    read_pair();
                } catch (const io::PlacedError&) {
                    throw;
                } catch (const lie::InvalidInput& e) {
                    if (!all.is_group) throw;
                    throw lie::InvalidInput("contact '" + name + "': " + e.what());
                }
            });
            out.force_place.resize(model.forces().size(), o.place());
            out.general_place.resize(model.general_constraints().size(), o.place());
            recorded.push_back(o.finish());
        }
    }

    std::string pair_name(const std::string& group, int i, int j) const
    {
        return group + ": " + model.body_name(i) + '-' + model.body_name(j);
    }

    const JsonSource& source;
    const std::string& normal_rows;
    Description& out;
    Model& model;
    std::map<std::string, int> by_name;
    std::map<int, int> by_id;
    std::set<std::string> constraint_names, force_names, contact_names, output_names, event_names;
    bool ground_listed = false;
    int ignored = 0;  // number of constraints with f_dot or f_ddot
    std::string ignored_place;
};

}  // namespace

Description read_model(std::string_view text, const std::string& file, std::span<const std::string> set,
                       const std::string& normal_rows, const std::string& folder)
{
    JsonSource source{std::string(text), file};
    source.base = folder;
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

Description load_model(const std::string& path, std::span<const std::string> set,
                       const std::string& normal_rows)
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
    Description description = read_model(text, path, set, normal_rows, fs::path(path).parent_path().string());
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
        return start(*description.model, description.x, options);
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
