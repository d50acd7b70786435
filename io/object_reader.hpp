// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of one JSON object. It checks types and ranges, fills in defaults, and rejects unknown keys.

#pragma once

#include "io/expression.hpp"
#include "io/json_source.hpp"

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace hilda::io {

class ObjectSchema;

/// What the schema says about a key
struct About {
    /// Complete sentences, with unit and frame
    std::string_view text = {};
    std::string_view example = {};  ///< a value in JSON
    std::string_view rest = {};     ///< members of the schema besides those of the reading function
    bool computed = false;          ///< the fallback depends on other keys: the schema has no default
};

/// Each reading function returns the value of a key in the type given by the name of the function. It throws
/// PlacedError for a value of another type or outside the range, and for a missing key without a fallback.
/// The values are recorded for the canonical form in the order of the calls. A key that no function has
/// requested is unknown, see finish().
///
/// The calls are also the schema: an object of a source with a SchemaRecorder notes each key with its type,
/// range, fallback and description. A key is required unless it has a fallback or find(), has() or given()
/// was called for it before. The value of a missing required key is its example.
class ObjectReader {
public:
    ObjectReader(const JsonSource& source, const Json& value, std::string pointer);

    double number(std::string_view key, const About& about = {}, std::optional<double> fallback = {});
    double positive(std::string_view key, const About& about = {}, std::optional<double> fallback = {});
    double not_negative(std::string_view key, const About& about = {}, std::optional<double> fallback = {});
    int integer(std::string_view key, const About& about = {});  ///< of at most 31 bits
    /// An integer >= 0
    long count(std::string_view key, const About& about = {}, std::optional<long> fallback = {});
    /// From 0 to 1
    double fraction(std::string_view key, const About& about = {}, std::optional<double> fallback = {});
    bool flag(std::string_view key, const About& about = {}, std::optional<bool> fallback = {});
    std::vector<double> numbers(std::string_view key, std::size_t count, const About& about = {});
    std::string text(std::string_view key, const About& about = {},
                     const std::optional<std::string>& fallback = {});
    /// A text that is not empty and has no control characters, for use in messages and table headers
    std::string name(std::string_view key, const About& about = {},
                     const std::optional<std::string>& fallback = {});
    /// Path of a file, relative to the folder of the text (JsonSource::base) unless it is absolute. It must
    /// be below JsonSource::within, also after symbolic links have been followed. It is not recorded.
    std::string file(std::string_view key, const About& about = {});
    /// Refuses a path of this key outside of JsonSource::within, "the folder of the WHOSE".
    void require_within(std::string_view key, const std::string& path, const std::string& whose) const;
    /// One of the allowed words
    std::string one_of(std::string_view key, const std::vector<std::string>& allowed, const About& about = {},
                       const std::optional<std::string>& fallback = {});
    /// A number or an expression in `variables`, returned as the text of an expression without parameters
    std::string formula(std::string_view key, const About& about = {},
                        const std::optional<std::string>& fallback = {},
                        const std::vector<std::string>& variables = {"t"});
    /// An expression in names that are checked later, without parameters. `variables` are not parameters.
    std::string formula_of_names(std::string_view key, const std::vector<std::string>& variables,
                                 const About& about = {});
    /// Three numbers or expressions in `variables`
    std::array<Expression, 3> expressions(std::string_view key, const About& about = {},
                                          const std::vector<std::string>& variables = {"t"});
    /// Reader of the object under a key. Call record(key, reader.finish()) when it has been read.
    /// `definition`: that of the object in the schema, which the reader of the object names by defines();
    /// without it the keys of the object are in the schema of this one.
    ObjectReader object(std::string_view key, const About& about = {}, std::string_view definition = {});
    /// A number, or the value of an expression if the text has parameters. `at` is the pointer of v, `key`
    /// its name in messages.
    double number_at(const Json& v, const std::string& at, std::string_view key) const;
    /// The elements of a list. Empty if the key is missing and not required. The schema of the elements is in
    /// About::rest.
    const Json::List& list(std::string_view key, bool required, const About& about = {});

    bool records_schema() const { return notes != nullptr; }
    /// A reader of the same object from the beginning
    ObjectReader again() const;

    bool has(std::string_view key) const;
    /// Whether the key is given. It becomes known. Always true while a schema is recorded, so that the key is
    /// read.
    bool given(std::string_view key) { return find(key) != nullptr || notes != nullptr; }
    /// The value of a key, or nullptr if it is missing. The key becomes known, and its value is not recorded.
    const Json* find(std::string_view key);
    /// The same without any effect on the schema or the known keys
    const Json* peek(std::string_view key) const;
    /// Throws PlacedError if both of two alternative keys are given.
    void exclude(std::string_view key, std::string_view other);
    /// Records the value of a key for the canonical form. A value recorded earlier is replaced.
    void record(std::string_view key, Json as);

    /// Reads the version of a file, which must be 1, from the key that names the kind of file. Throws
    /// PlacedError for a file of another kind; the message has the command for such files.
    void version(std::string_view key);
    /// The second half of version(): throws PlacedError for a file of another kind.
    void refuse_other_kinds(std::string_view key) const;
    /// Accepts the key "$schema" of the root object, a string. Editors find the schema by it; it has no other
    /// effect.
    void allow_schema(const About& about = {});

    /// Notes for the schema that the object has the definition `name`, to which the following keys belong,
    /// and the title and the description of the definition. `rest`: further members of the definition in
    /// JSON, which are conditions on several keys.
    void defines(std::string_view name, std::string_view title, std::string_view description,
                 std::string_view rest = {});
    /// Notes that at most one of the keys may be given.
    void note_exclusive(std::span<const std::string> keys);
    /// Notes what the schema says about a key: its type by the name of a kind of values (SchemaRecorder), or
    /// by members of a JSON object, such as "type": "number".
    void note(std::string_view key, std::string_view kind, const About& about,
              const Json* fallback = nullptr);

    /// Throws PlacedError for unknown keys, and returns the canonical form of the object. "note" is always
    /// allowed.
    Json finish();

    /// JSON pointer of a key
    std::string pointer(std::string_view key) const { return pointer_to(own_pointer, key); }
    const std::string& pointer() const { return own_pointer; }
    /// Location of the object, and of the value of a key
    std::string place() const { return source.place(value.offset, own_pointer); }
    std::string place(std::string_view key) const;
    /// Throws PlacedError with the location of the value of a key, or of the object if the key is missing.
    [[noreturn]] void fail(std::string_view key, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const { source.fail(value, own_pointer, what); }
    /// The same, for an element of the list under a key
    [[noreturn]] void fail(std::string_view key, std::size_t element, const std::string& what) const;

    /// Calls `f` and adds the location of the object to messages of exceptions that have none.
    template <class F>
    auto located(const F& f) const
    {
        try {
            return f();
        } catch (const PlacedError&) {
            throw;
        } catch (const InvalidInput& e) {
            fail(e.what());
        } catch (const ExpressionError& e) {
            fail(e.what());
        }
    }

protected:
    const Json* lookup(std::string_view key, bool required);

    const JsonSource& source;
    /// Range of the precision in which the numbers are used: the largest magnitude, and the least positive
    /// value
    double largest = std::numeric_limits<double>::max(), least_positive = 0;

private:
    template <class Fallback>
    void note_value(std::string_view key, std::string_view kind, const About& about,
                    const std::optional<Fallback>& fallback);
    double number_of_kind(std::string_view kind, std::string_view key, const About& about,
                          std::optional<double> fallback);
    std::string text_of(std::string_view key, const std::optional<std::string>& fallback);
    const Json::List* lookup_list(std::string_view key, bool required);
    [[noreturn]] void fail_missing_key(std::string_view key);
    [[noreturn]] void fail_unknown_key(const Json::Member& m) const;

    const Json& value;
    std::string own_pointer;
    std::vector<std::string> known;  // keys requested so far
    Json::Object recorded;
    std::shared_ptr<ObjectSchema> notes;  // nullptr: no schema is recorded
};

}  // namespace hilda::io
