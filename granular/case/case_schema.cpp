// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of cases, with the force laws and the registered types of boundaries and fills.
#include "granular/case/case_schema.hpp"

#include "granular/case/boundary_keys.hpp"
#include "granular/case/pair_keys.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/insertion/sizes.hpp"
#include "io/schema/schema_recorder.hpp"

#include <algorithm>
#include <cctype>

namespace hilda::granular {

extern const char case_schema_text[];  // made of case.schema.json by CMake

namespace {

/// Records the keys that a law reads, for the schema.
class LawSchema {
public:
    template <class Law>
    explicit LawSchema(const Law&)
    {
        schema.description = Law::description;
        if constexpr (requires { Law::example; }) schema.example = Law::example;
        Law::read(*this);
    }

    float positive(const char* key, const char* text, double example)
    {
        add(key, text, R"("$ref": "#/$defs/positive")", io::shortest(example));
        if (of_material)
            required_otherwise.push_back(key);
        else
            schema.keys.back().required = true;
        return 1;
    }
    float not_negative(const char* key, double default_value, const char* text, double example)
    {
        add(key, text, R"("$ref": "#/$defs/not_negative", "default": )" + io::shortest(default_value),
            io::shortest(example));
        return 1;
    }
    float at_least(const char* key, float, const char*, const char* text, double example)
    {
        add(key, text, R"("$ref": "#/$defs/positive")", io::shortest(example));
        return 1;
    }
    int flag(const char* key, const char* text)
    {
        add(key, text, R"("type": "boolean", "default": false)", "true");
        return 1;
    }
    double restitution()
    {
        of_pair = io::Json::List{"restitution"};
        return 1;
    }
    float static_friction() { return kinetic_friction(); }
    float kinetic_friction()
    {
        of_pair = io::Json::List{"mu"};
        return 1;
    }
    bool material_normal()
    {
        of_material = true;
        return false;
    }

    const Material i, j;
    io::KeyedSchema schema;
    io::Json of_pair = io::Json::array();  ///< required keys of the entry of `laws`
    /// Whether the normal law can replace the keys of this law, which are then not allowed
    bool of_material = false;
    io::Json required_otherwise = io::Json::array();  ///< keys that it replaces, if required without it

private:
    void add(const char* key, const char* text, const std::string& rest, const std::string& example)
    {
        schema.keys.push_back({key, text, rest + R"(, "examples": [)" + example + ']'});
    }
};

/// Schema of the objects in which the value of a key has a schema. is_default: whether the default has it.
io::Json having(const std::string& key, const io::Json& value, bool is_default)
{
    io::Json all = {{"properties", {{key, value}}}};
    if (!is_default) all["required"] = io::Json::List{key};
    return all;
}

/// A kind of laws, for the definition of each of its laws
struct KindSchema {
    std::string kind, standard;  ///< the name of the kind, and of its default law
    io::TypeKind text;
    io::Json variants = io::Json::array();  ///< the schema of the keys for each value of "law"
};

/// Adds the definition of a law, and the conditions that it states for the other keys of an entry of `laws`.
/// of_materials: the schema of the entries whose normal law has the stiffness of the materials
void add_law(const std::string& name, LawSchema law, const io::Json& of_materials, KindSchema& of,
             io::Json& definitions, io::Json& conditions)
{
    std::string definition = of.kind + '_' + name;
    std::replace(definition.begin(), definition.end(), '-', '_');
    const io::Json is = having("law", {{"const", name}}, name == of.standard),
                   chosen = having(of.kind, is, name == of.standard);
    of.variants.push_back({{"if", is}, {"then", {{"$ref", "#/$defs/" + definition}}}});
    if (law.of_pair.size() > 0) conditions.push_back({{"if", chosen}, {"then", {{"required", law.of_pair}}}});
    io::Json none = io::Json::array();
    for (const io::KeySchema& key : law.schema.keys)
        none.push_back({{"not", {{"required", io::Json::List{key.name}}}}});
    law.schema.keys.push_back(io::note_key);
    definitions[definition] = io::definition(of.text, name, law.schema);
    if (!law.of_material) return;
    conditions.push_back(
        {{"if", {{"allOf", io::Json::List{chosen, of_materials}}}},
         {"then",
          {{"required", io::Json::List{"restitution"}}, {"properties", {{of.kind, {{"allOf", none}}}}}}}});
    conditions.push_back({{"if", {{"allOf", io::Json::List{chosen, {{"not", of_materials}}}}}},
                          {"then", {{"properties", {{of.kind, {{"required", law.required_otherwise}}}}}}}});
}

/// Sets the definitions of the laws, and their conditions.
void set_law_definitions(io::Json& definitions)
{
    io::Json conditions = io::Json::array();
    io::Json material_laws = io::Json::array();
    NormalLaws::for_each([&]<class Law>(const Law&) {
        if (has_material_stiffness<Law>) material_laws.push_back(Law::name);
    });
    const io::Json of_materials = having("normal", having("law", {{"enum", material_laws}}, true), true);
    for_each_kind([&]<class Laws>(const std::string& kind, const std::string& standard, Laws PairLaw::*) {
        KindSchema of{.kind = kind, .standard = standard, .text = {kind + " law", "law", "Name of the law."}};
        of.text.title[0] = static_cast<char>(std::toupper(of.text.title[0]));
        // What does not depend on the type of the law is a function: it is compiled once.
        Laws::for_each([&](const auto& law) {
            add_law(law.name, LawSchema(law), of_materials, of, definitions, conditions);
        });
        definitions[kind + "_law"]["allOf"] = of.variants;
    });
    definitions["law"]["allOf"] = conditions;
}

/// Sets the definitions of the size distributions, which have a prefix because other types have their names.
void set_size_definitions(io::Json& definitions)
{
    io::Json references = io::Json::array();
    for (const SizeType& type : io::Registry<SizeType>::all()) {
        const std::string name = "sizes_" + type.name;
        references.push_back({{"$ref", "#/$defs/" + name}});
        definitions[name] = io::definition({"Size distribution", "type", "Type of the distribution."},
                                           type.name, type.schema);
    }
    definitions["sizes"]["oneOf"] = references;
}

}  // namespace

io::Json case_schema()
{
    io::Json schema = io::parsed_schema(case_schema_text, "case.schema.json");
    io::Json& definitions = schema["$defs"];
    set_law_definitions(definitions);
    io::set_one_of<BoundaryType>(definitions, "boundary", {"Boundary", "type", "Type of the boundary."});
    io::set_one_of<FillType>(definitions, "fill", {"Fill", "type", "Type of the fill."});
    set_size_definitions(definitions);
    io::Json integrators = io::Json::array();
    for (const char* name : scheme_names) integrators.push_back(name);
    schema["properties"]["integrator"]["enum"] = integrators;
    return schema;
}

}  // namespace hilda::granular
