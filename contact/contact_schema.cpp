// SPDX-License-Identifier: GPL-3.0-or-later
/// The selection among the registered surfaces, normal laws and friction laws in the schema of model files.
#include "contact/contact_types.hpp"

#include "contact/friction/friction.hpp"
#include "contact/normal/normal_law.hpp"
#include "contact/surface_types.hpp"
#include "io/json.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

/// A definition that selects one of several definitions by a key of the object
struct Group {
    std::string name;         ///< of the definition: "surface"
    io::TypeKind kind;        ///< its key is the one that selects
    std::string description;  ///< of the definition
    io::Json key;             ///< schema of the key that selects
    std::string prefix = {};  ///< of the names of the definitions of the types
    /// Further values of the key, with a definition of the same name
    std::vector<std::string> others = {};
    std::string fallback = {};      ///< value of the key if it is not given; "": it must be given
    std::string unregistered = {};  ///< definition for other values of the key; "": they are rejected
};

std::string definition_of(const Group& group, std::string name)
{
    std::replace(name.begin(), name.end(), '-', group.prefix.empty() ? '-' : '_');
    return group.prefix + name;
}

/// {"if": the key satisfies the condition, "then": the definition}
io::Json selection(const std::string& key, const io::Json& condition, bool given,
                   const std::string& definition)
{
    io::Json has_value = io::Json::object();
    if (given) has_value["required"] = io::Json::List{key};
    has_value["properties"][key] = condition;
    io::Json both = io::Json::object();
    both["if"] = has_value;
    both["then"]["$ref"] = "#/$defs/" + definition;
    return both;
}

/// Adds the definitions of the registered types, and the selection among them
template <class Type>
void add_group(io::Json& definitions, const Group& group)
{
    std::vector<std::string> names;
    for (const Type& type : io::Registry<Type>::all()) {
        names.push_back(type.name);
    }
    names.insert(names.end(), group.others.begin(), group.others.end());
    const std::string& key = group.kind.key;
    const bool has_default = !group.fallback.empty();
    io::Json selections = io::Json::array(), value = io::Json::object(), other = io::Json::object();
    for (const std::string& name : names) {
        value["const"] = name;
        selections.push_back(
            selection(key, value, has_default && name != group.fallback, definition_of(group, name)));
    }
    io::Json& definition = definitions[group.name];
    definition = {{"title", group.kind.title}, {"description", group.description}, {"type", "object"}};
    if (!has_default) definition["required"] = io::Json::List{key};
    definition["properties"][key] = group.key;
    if (group.unregistered.empty()) {
        definition["properties"][key]["enum"] = names;
    } else {
        other["not"]["enum"] = names;
        selections.push_back(selection(key, other, has_default, group.unregistered));
    }
    definition["allOf"] = selections;
}

/// The fallback of a constraint is one of the elastic normal laws.
void add_fallback(io::Json& definitions)
{
    io::Json references = io::Json::array(), selections = io::Json::array();
    for (const NormalLawType& law : io::Registry<NormalLawType>::all())
        if (law.elastic) {
            references.push_back({{"$ref", "#/$defs/" + law.name}});
            selections.push_back(selection("type", {{"const", law.name}}, false, law.name));
        }
    definitions["fallback"]["allOf"] = selections;
    definitions["fallback"]["oneOf"] = references;
}

}  // namespace

void add_contacts(io::Json& definitions)
{
    add_group<SurfaceType>(
        definitions,
        {.name = "surface",
         .kind = surface_kind,
         .description =
             "A surface and its position and orientation in the body. Points of a surface are given in "
             "the surface frame, with origin at position. z of this frame is the axis of a cone, "
             "cylinder, disk, paraboloid or torus, the outward normal of a plane or foot, and the "
             "vertical of a height map.",
         .key = {{"description",
                  "Type of the surface. Surfaces that a build adds are accepted by name; they have "
                  "further keys."},
                 {"type", "string"},
                 {"examples", io::Json::List{"sphere"}}},
         .prefix = "surface_",
         .unregistered = "pose"});
    add_group<NormalLawType>(
        definitions,
        {.name = "normal",
         .kind = normal_kind,
         .description =
             "Law of the normal force N. hertz and hooke are compliant laws in the overlap delta of the "
             "surfaces. given prescribes N. constraint replaces the force law by constraint rows; N is "
             "then a Lagrange multiplier. dvi is rigid contact with several contact points.",
         .key = {{"description", "Type of the normal law."}, {"examples", io::Json::List{"hertz"}}},
         .others = {"constraint", "dvi"}});
    add_group<FrictionLaw>(
        definitions, {.name = "friction",
                      .kind = friction_kind,
                      .description = "Law of the friction force and of the rolling and spinning torques.",
                      .key = {{"description",
                               "Name of the law. Laws that a build adds are accepted by name; they may have "
                               "further keys besides the common ones."},
                              {"type", "string"},
                              {"default", "slide-roll-spin"},
                              {"examples", io::Json::List{"slide-roll-spin", "rolling"}}},
                      .others = {"rolling", "implicit", "coulomb"},
                      .fallback = "slide-roll-spin",
                      .unregistered = "friction_parameters"});
    add_fallback(definitions);
}

}  // namespace hilda::contact
