// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda-granular cases, and the words that name a case or a validation.

#pragma once

#include <string>

namespace hilda::granular {

/// A table of the built-in cases: name and note
std::string list_of_cases();

/// Writes the file of a built-in case, or of all if the name is empty: to a file, to NAME.json in an existing
/// folder, or to stdout if `to` is empty. All are written to a folder, which is made if it does not exist.
/// Throws io::UsageError if there is no such case or a file with another text would be replaced, io::IoError.
void write_cases(const std::string& name, const std::string& to);

/// The end of the message that a word is no file: the nearest name, and the names of validations and cases;
/// empty for a word that looks like a path
std::string known_names(const std::string& word);

}  // namespace hilda::granular
