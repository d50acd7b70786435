// SPDX-License-Identifier: GPL-3.0-or-later
/// A JSON tree that was read from a text, for messages of the form
/// "FILE:LINE:COL (/json/pointer): what is wrong".

#pragma once

#include "io/error.hpp"
#include "io/json.hpp"

namespace hilda::io {

class SchemaRecorder;

/// Invalid input with its location. what() begins with "FILE:LINE:COL (/json/pointer): ".
class PlacedError : public InvalidInput {
public:
    PlacedError(const std::string& place, std::string json_pointer, std::string what_is_wrong,
                const std::string& origin = "")
        : InvalidInput(place + ": " + what_is_wrong + origin), pointer(std::move(json_pointer)),
          reason(std::move(what_is_wrong))
    {}

    std::string pointer;  ///< of the invalid entry; "": the whole text
    std::string reason;   ///< what is wrong, without the location and the option that gave the value
};

/// Named constants of a text. Where a number is expected, a string is an expression in their names.
class Parameters {
public:
    virtual ~Parameters() = default;
    /// Value of an expression, finite. Throws ExpressionError.
    virtual double value(const std::string& expression) const = 0;
    /// An expression in `variables`, in which the names of parameters are replaced by their values. A
    /// variable takes precedence over a parameter of the same name.
    virtual std::string substituted(const std::string& expression,
                                    const std::vector<std::string>& variables) const = 0;
    /// The same without a check of the other names
    virtual std::string replaced(const std::string& expression,
                                 const std::vector<std::string>& variables) const = 0;
};

/// Strict JSON (RFC 8259, UTF-8), with changes by --set.
///
/// The constructor throws PlacedError for invalid JSON, for duplicate keys of an object, for numbers outside
/// the range of double, for integers of 2^53 and more, and for texts that exceed the limits below.
class JsonSource {
public:
    static constexpr std::size_t max_bytes = std::size_t{64} << 20;
    static constexpr int max_depth = 64;
    static constexpr std::size_t max_string = 4096;     ///< [bytes]
    static constexpr std::size_t max_values = 2000000;  ///< each takes about 50 bytes of memory

    Json root;
    std::string base;    ///< folder of relative names of files; "": the current directory
    std::string within;  ///< folder that must contain the files that the text names; "": they may be anywhere
    /// Files that the text names: the paths that ObjectReader::file() has returned
    mutable std::vector<std::string> files;
    const Parameters* parameters = nullptr;  ///< of the readers; nullptr: numbers are written as digits
    SchemaRecorder* schema = nullptr;        ///< notes the keys that are read; may be nullptr

    /// `file` is the file name used in messages. A file of the program itself may have longer strings.
    JsonSource(std::string text, std::string file, std::size_t longest_string = max_string);

    /// Applies a change "/json/pointer=VALUE": replaces a value, or adds a key to an object. A VALUE that is
    /// not valid JSON is taken as a string, unless it begins like an object, a list or a string. Throws
    /// PlacedError for an invalid change. `origin` is the option that gave the change, for messages; by
    /// default --set "change".
    void set(const std::string& change, const std::string& origin = "");

    std::vector<std::string> changes;  ///< that were applied

    /// Accepts an old name of a key of the root object, in the text and in later changes, with an entry in
    /// `notices`. Messages keep the name of the text. Throws PlacedError if the text has both names.
    void rename(const std::string& old_name, const std::string& new_name);
    /// Removes a member of the root.
    void remove(const std::string& key);
    std::vector<std::string> notices;  ///< one line with the location for each old name that was used

    /// The text as it was read, or the canonical text if a value or a name was changed
    std::string current_text() const { return changed ? written(root) + '\n' : text; }

    /// Location "FILE:LINE:COL (/json/pointer)". Columns are counted in characters from 1.
    std::string place(std::size_t offset, const std::string& pointer) const;
    /// Location of the value with a pointer, or of the innermost existing value that contains it
    std::string place(const std::string& pointer) const;
    /// Throws PlacedError "location: what". The message also names the --set that gave the value.
    [[noreturn]] void fail(const Json& at, const std::string& pointer, const std::string& what) const;
    [[noreturn]] void fail(const std::string& pointer, const std::string& what) const;

private:
    struct Renamed {
        std::string old_name, new_name;
        bool in_text;
    };

    const Json& find(const std::string& pointer) const;
    void notice(const std::string& pointer, const Renamed& key);
    std::string from(const Json& at) const;

    std::string text, file;
    /// Number of UTF-8 characters before this byte of the text
    std::size_t characters_before(std::size_t offset) const;

    std::vector<std::uint32_t> line_start;
    std::vector<std::uint32_t> characters_before_block;  ///< the same for each block of the text
    std::vector<std::string> origins;
    std::vector<Renamed> renamed;
    bool changed = false;  ///< by --set, or because a key has its new name
};

/// Parses a text. `source` forms the locations of errors.
Json parse_json(std::string_view text, const JsonSource& source, std::size_t longest_string);

}  // namespace hilda::io
