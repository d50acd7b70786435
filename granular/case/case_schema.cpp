// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of cases, with the force laws and the registered types of boundaries and fills.
#include "granular/case/case_schema.hpp"

#include "granular/case/boundary_keys.hpp"
#include "granular/case/pair_keys.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/insertion/sizes.hpp"

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
    io::TypeSchema schema;
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

/// Sets the definitions of the laws, and the conditions that they state for the other keys of an entry of
/// `laws`.
void set_law_definitions(io::Json& definitions)
{
    io::Json conditions = io::Json::array();
    io::Json material_laws = io::Json::array();
    NormalLaws::for_each([&]<class Law>(const Law&) {
        if (has_material_stiffness<Law>) material_laws.push_back(Law::name);
    });
    const io::Json of_materials = having("normal", having("law", {{"enum", material_laws}}, true), true);
    for_each_kind([&]<class Laws>(const std::string& kind, const std::string& standard, Laws PairLaw::*) {
        io::Json variants = io::Json::array();
        io::TypeKind law_kind = {kind + " law", "law", "Name of the law."};
        law_kind.title[0] = static_cast<char>(std::toupper(law_kind.title[0]));
        Laws::for_each([&](const auto& law) {
            const std::string name = law.name;
            std::string definition = kind + '_' + name;
            std::replace(definition.begin(), definition.end(), '-', '_');
            LawSchema read(law);
            const io::Json is = having("law", {{"const", name}}, name == standard),
                           chosen = having(kind, is, name == standard);
            variants.push_back({{"if", is}, {"then", {{"$ref", "#/$defs/" + definition}}}});
            if (read.of_pair.size() > 0)
                conditions.push_back({{"if", chosen}, {"then", {{"required", read.of_pair}}}});
            io::Json none = io::Json::array();
            for (const io::KeySchema& key : read.schema.keys)
                none.push_back({{"not", {{"required", io::Json::List{key.name}}}}});
            read.schema.keys.push_back(io::note_key);
            definitions[definition] = io::definition(law_kind, name, read.schema);
            if (!read.of_material) return;
            conditions.push_back({{"if", {{"allOf", io::Json::List{chosen, of_materials}}}},
                                  {"then",
                                   {{"required", io::Json::List{"restitution"}},
                                    {"properties", {{kind, {{"allOf", none}}}}}}}});
            conditions.push_back(
                {{"if", {{"allOf", io::Json::List{chosen, {{"not", of_materials}}}}}},
                 {"then", {{"properties", {{kind, {{"required", read.required_otherwise}}}}}}}});
        });
        definitions[kind + "_law"]["allOf"] = variants;
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
