// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/law_list.hpp"

#include "granular/case/pair_keys.hpp"
#include "io/schema/type_schema.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

/// Description of a kind of laws, and an example of the name of a law
struct KindText {
    const char *kind, *description, *example;
};
constexpr std::array<KindText, 5> kind_texts = {
    {{"normal", "Normal force.", "scaled-hooke"},
     {"tangential", "Tangential (friction) force.", "mindlin-incremental"},
     {"rolling", "Rolling resistance.", "pseudo-force"},
     {"spin", "Resistance to relative rotation about the normal.", "torsional-spring"},
     {"cohesion",
      "Attractive force of touching bodies. It does not increase the bound of the friction force.", "sjkr"}}};

std::string definition_of(const std::string& kind, const std::string& law)
{
    std::string name = kind + '_' + law;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// Schema of the objects in which the value of a key has a schema. is_default: whether the default has it.
io::Json having(const std::string& key, const io::Json& value, bool is_default)
{
    io::Json all = {{"properties", {{key, value}}}};
    if (!is_default) all["required"] = io::Json::List{key};
    return all;
}

/// Members of the schema of a law and of the entry of `laws` that contains it
struct Recorded {
    io::Json own, pair;
};

/// Records the keys that a law reads if the normal law has the stiffness of the materials, or not.
template <class Law>
Recorded record(io::SchemaRecorder& recorder, const std::string& kind, bool of_materials)
{
    io::TypeSchema schema{.description = Law::description, .examples = {""}};
    if constexpr (requires { Law::example; }) schema.examples = {Law::example};
    io::SchemaRecorder of_pair;
    io::JsonSource source(R"({"restitution": 1, "mu": 1})", "entry of laws");
    source.schema = &of_pair;
    ObjectReader pair(source, source.root, "");
    pair.defines("law", "", "");
    PairLaw law;
    law.normal = of_materials ? NormalLaws(Hertz{}) : NormalLaws(Hooke{});
    const Material material;
    const auto read = [&](ObjectReader& own) {
        LawKeys keys(own, pair, material, material, law);
        Law::read(keys);
    };
    const std::string name = definition_of(kind, Law::name);
    recorder.definition(name)->examples = io::Json::array();
    io::record_examples<ObjectReader>(recorder, {title_of_kind(kind), "law", "Name of the law."}, name,
                                      Law::name, schema, read);
    return {recorder.definition(name)->members(), of_pair.definition("law")->members()};
}

/// The required keys of recorded members
io::Json required(const io::Json& members)
{
    const io::Json::Member* const all = members.member("required");
    return all != nullptr ? all->value : io::Json::array();
}

/// Adds the conditions for an entry of `laws` with a law. `has_law`: schema of such entries; `of_materials`:
/// of those whose normal law has the stiffness of the materials. `with` and `without`: what the law reads in
/// entries with such a normal law and in others.
void add_conditions(io::Json& conditions, const std::string& kind, const io::Json& has_law,
                    const io::Json& of_materials, const Recorded& with, const Recorded& without)
{
    if (required(without.pair).size() > 0)
        conditions.push_back({{"if", has_law}, {"then", {{"required", required(without.pair)}}}});
    if (io::written(with.own) == io::written(without.own)) return;
    io::Json refused = io::Json::array();
    for (const io::Json::Member& key : *without.own.member("properties")->value.members())
        if (with.own.member("properties")->value.member(key.key) == nullptr)
            refused.push_back({{"not", {{"required", io::Json::List{key.key}}}}});
    conditions.push_back(
        {{"if", {{"allOf", io::Json::List{has_law, of_materials}}}},
         {"then", {{"required", required(with.pair)}, {"properties", {{kind, {{"allOf", refused}}}}}}}});
    conditions.push_back({{"if", {{"allOf", io::Json::List{has_law, {{"not", of_materials}}}}}},
                          {"then", {{"properties", {{kind, {{"required", required(without.own)}}}}}}}});
}

}  // namespace

std::vector<std::string> law_names(const std::string& kind)
{
    std::vector<std::string> names;
    for_each_kind([&]<class Laws>(const char* of, const char*, Laws PairLaw::*) {
        if (of != kind) return;
        Laws::for_each([&](const auto& law) { names.emplace_back(law.name); });
    });
    return names;
}

io::Json record_laws(io::SchemaRecorder& recorder)
{
    io::Json material_laws = io::Json::array(), conditions = io::Json::array(), groups = io::Json::object();
    NormalLaws::for_each([&]<class Law>(const Law&) {
        if (has_material_stiffness<Law>) material_laws.push_back(Law::name);
    });
    const io::Json of_materials = having("normal", having("law", {{"enum", material_laws}}, true), true);
    for_each_kind([&]<class Laws>(const std::string& kind, const std::string& standard, Laws PairLaw::*) {
        const KindText& text = *std::find_if(kind_texts.begin(), kind_texts.end(),
                                             [&](const KindText& t) { return t.kind == kind; });
        io::Json variants = io::Json::array();
        Laws::for_each([&]<class Law>(const Law&) {
            io::SchemaRecorder with, without;
            const bool is_default = Law::name == standard;
            const io::Json is = having("law", {{"const", Law::name}}, is_default);
            variants.push_back(
                {{"if", is}, {"then", {{"$ref", "#/$defs/" + definition_of(kind, Law::name)}}}});
            add_conditions(conditions, kind, having(kind, is, is_default), of_materials,
                           record<Law>(with, kind, true), record<Law>(without, kind, false));
            record<Law>(recorder, kind, false), record<Law>(recorder, kind, true);
        });
        groups[kind + "_law"] = {{"title", title_of_kind(kind)},
                                 {"description", std::string(text.description) +
                                                     " Other names are accepted if a build adds them."},
                                 {"type", "object"},
                                 {"properties",
                                  {{"law",
                                    {{"description", "Name of the law."},
                                     {"type", "string"},
                                     {"default", standard},
                                     {"examples", io::Json::List{text.example}}}}}},
                                 {"allOf", variants}};
    });
    recorder.definition("law")->rest["allOf"] = conditions;
    return groups;
}

}  // namespace hilda::granular
