// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON text of a case, with changes of entries and with places (line and column) for messages.

#pragma once

#include "granular/keys.hpp"

#include <map>

namespace hilda::granular {

/// A change of one entry of a case
struct Setting {
    std::string pointer;  ///< RFC 6901
    std::string value;    ///< JSON; text that is not JSON is taken as a string
    std::string origin;   ///< the option that requested the change, for messages
};

/// The text of a case file, parsed. Old names of keys at the top level are replaced by the new names, with a
/// notice.
class CaseText {
public:
    using Json = Keys::Json;

    /// `file` is the name used in messages. Throws io::InvalidInput if the text is not JSON, if a key occurs twice
    /// in one object, or if a key is given under its old and its new name.
    CaseText(std::string text, std::string file);

    /// Changes an entry that exists, or adds a key to an object that exists. Throws io::InvalidInput.
    void set(const Setting& setting);

    const Json& json() const { return all; }
    /// The text of the file, or the JSON text of the case if entries were changed or renamed
    std::string text() const;
    const std::vector<Setting>& settings() const { return applied; }

    /// One notice "/pointer: text" for each old name of a key that was read
    const std::vector<std::string>& notices() const { return renamed_notices; }

    /// Converts "/pointer: text" to "FILE:LINE:COLUMN (/pointer): text", followed by the origin of the entry
    /// if a Setting changed it. A text without a pointer is prefixed with the file name.
    std::string with_location(const std::string& what) const;

private:
    void replace_old_names();

    std::string file_text, file;
    Json all;
    std::vector<Setting> applied;
    std::map<std::string, std::string> old_names;  ///< name in the file of each renamed key, by its new name
    std::vector<std::string> renamed_notices;
};

}  // namespace hilda::granular
