// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/type_schema.hpp"

#include "io/schema/schema_recorder.hpp"

namespace hilda::dae {

std::string example_text(const std::string& key, const std::string& name, const std::string& example)
{
    return '{' + io::in_quotes(key) + ": " + io::in_quotes(name) + (example.empty() ? "" : ", ") + example +
           '}';
}

void defines_type(ObjectReader& o, const TypeKind& kind, const std::string& definition,
                  const std::string& name, const TypeSchema& schema)
{
    if (!o.records_schema()) return;
    o.defines(definition, kind.title + ' ' + name, schema.description, schema.rest);
    o.note(kind.key, R"("const": )" + io::in_quotes(name), {kind.what});
}

void record_examples(io::SchemaRecorder& recorder, const TypeKind& kind, const std::string& definition,
                     const std::string& name, const TypeSchema& schema,
                     const std::function<void(ObjectReader&)>& read)
{
    for (const std::string& example : schema.examples) {
        const std::string text =
            "{\"" + kind.key + "\": " + io::in_quotes(name) + (example.empty() ? "" : ", ") + example + '}';
        JsonSource source(text, "example of " + name, text.size() + 1);
        source.schema = &recorder;
        ObjectReader o(source, source.root, "");
        o.find(kind.key);
        defines_type(o, kind, definition, name, schema);
        read(o);
        o.finish();
        recorder.definition(definition)->examples.push_back(source.root);
    }
}

}  // namespace hilda::dae
