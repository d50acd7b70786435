// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/type_schema.hpp"

namespace hilda::io {

std::string example_text(const std::string& key, const std::string& name, const std::string& example)
{
    return '{' + in_quotes(key) + ": " + in_quotes(name) + (example.empty() ? "" : ", ") + example + '}';
}

void defines_type(ObjectReader& o, const TypeKind& kind, const std::string& definition,
                  const std::string& name, const TypeSchema& schema)
{
    if (!o.records_schema()) return;
    o.defines(definition, kind.title + ' ' + name, schema.description, schema.rest);
    o.note(kind.key, R"("const": )" + in_quotes(name), {kind.what});
}

void add_choice(Json& definitions, const std::string& name, const std::string& title,
                const std::string& description, const std::vector<std::string>& types,
                const std::string& prefix)
{
    Json references = Json::array();
    for (const std::string& type : types) references.push_back({{"$ref", "#/$defs/" + prefix + type}});
    definitions[name] = {{"title", title},
                         {"description", description},
                         {"type", "object"},
                         {"required", Json::List{"type"}},
                         {"oneOf", references}};
}

}  // namespace hilda::io
