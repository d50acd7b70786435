// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of a file, recorded from the functions that read it.
///
/// The functions read examples, from a JsonSource with a recorder. Each call of an ObjectReader notes the
/// key, its type, range, default and description. The definition of an object has the keys of all its
/// examples. A key is required if it was a required key of every example.

#pragma once

#include "io/object_reader.hpp"

#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hilda::io {

/// The keys of one kind of objects
class ObjectSchema {
public:
    explicit ObjectSchema(SchemaRecorder& recorder) : recorder(recorder) {}

    void begin();                          ///< before the keys of a further object
    void add_example(const Json& object);  ///< unless it is among them
    void seen(std::string_view key, bool required);
    void describe(std::string_view key, Json schema, Json example);
    /// Notes that at most one of the two keys may be given.
    void exclude(const std::string& key, const std::string& other);
    /// The keys of an object under a key that has no definition
    std::shared_ptr<ObjectSchema> inner(std::string_view key);
    /// The example of a key, or nullptr
    const Json* example(std::string_view key);
    /// Members of the schema: required and properties
    Json members();

    SchemaRecorder& recorder;
    std::string title, description;
    Json examples = Json::array(), rest = Json::object();
    bool open = false;  ///< whether other keys are allowed

private:
    struct Key {
        std::string name;
        Json schema = Json::object(), example = {};
        std::shared_ptr<ObjectSchema> inner = nullptr;
        bool required = true;
        enum class Now { absent, optional, required } now = Now::absent;  ///< in the present object
    };
    Key& key(std::string_view name);
    void end();

    std::deque<Key> keys;  ///< readers of missing objects refer to their examples
    std::vector<std::pair<std::string, std::string>> exclusive;
    int objects = 0;
};

class SchemaRecorder {
public:
    /// Schemas of the kinds of values that ObjectReader::note() names. They may be replaced before the first
    /// use.
    std::map<std::string, Json, std::less<>> kinds;
    /// Definitions whose examples are the objects that are read, at most three
    std::set<std::string, std::less<>> shown;

    SchemaRecorder();
    /// The definition with this name; it is added if there is none.
    std::shared_ptr<ObjectSchema> definition(const std::string& name);
    /// The schema of a key of this kind. Throws PlacedError with the name `of` for members that are not JSON.
    Json kind(std::string_view name, const std::string& of) const;
    /// The schema of a file whose root object has the definition `root`, with the others in "$defs", in the
    /// order of their first use
    Json schema(const std::string& root) const;

private:
    std::vector<std::pair<std::string, std::shared_ptr<ObjectSchema>>> all;
};

/// The value of a text in JSON. Throws PlacedError with `name`.
Json parsed_schema(const std::string& text, const std::string& name);

}  // namespace hilda::io
