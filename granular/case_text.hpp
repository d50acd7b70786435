// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON of a case: as a file has it, with entries changed, and where what is wrong stands.

#pragma once

#include "granular/keys.hpp"

namespace hilda::granular {

/// An entry that is to be another than the file has it
struct Setting {
    std::string pointer;  ///< RFC 6901
    std::string value;    ///< JSON; what is none is a text
    std::string asked;    ///< as the user did, for messages
};

class CaseText {
public:
    using Json = Keys::Json;

    /// InvalidCase
    CaseText(std::string text, std::string file);

    /// An entry that is there, or a new key of an object that is. InvalidCase
    void set(const Setting& setting);

    const Json& json() const { return all; }
    /// Of the file, or where entries were changed of what it says then
    std::string text() const;
    const std::vector<Setting>& settings() const { return made; }

    /// "/pointer: what", which becomes "FILE:LINE:COL (/pointer): what", with how the entry was changed; what has no
    /// pointer gets the name of the file.
    std::string placed(const std::string& what) const;

private:
    std::string of_file, file;
    Json all;
    std::vector<Setting> made;
};

}  // namespace hilda::granular
