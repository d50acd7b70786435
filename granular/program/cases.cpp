// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/cases.hpp"

#include "granular/case/built_in_cases.hpp"
#include "granular/validations/validation.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

std::vector<std::string> names_of_cases()
{
    std::vector<std::string> all;
    for (const BuiltInCase& c : built_in_cases()) all.push_back(c.name);
    return all;
}

std::string text_of(const BuiltInCase& c) { return c.text.ends_with('\n') ? c.text : c.text + '\n'; }

std::string file_in(const std::string& folder, const BuiltInCase& c)
{
    return (std::filesystem::path(folder) / (c.name + ".json")).string();
}

/// Throws io::UsageError for a file with another text, which may be a case that a user has changed.
void check_replaceable(const std::string& file, const std::string& text)
{
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error) &&
        io::read_file(file, io::JsonSource::max_bytes) != text)
        throw io::UsageError("granular: --write: " + file +
                             " exists and is another case; remove it, or choose another name");
}

void write_all(const std::string& folder)
{
    if (folder.ends_with(".json"))
        throw io::UsageError("granular: --write without NAME writes all cases to a folder; '" + folder +
                             "' is the name of a file");
    for (const BuiltInCase& c : built_in_cases()) check_replaceable(file_in(folder, c), text_of(c));
    io::make_directory(folder);
    for (const BuiltInCase& c : built_in_cases()) io::write_file(file_in(folder, c), text_of(c));
}

}  // namespace

std::string list_of_cases()
{
    std::size_t width = 0;
    for (const BuiltInCase& c : built_in_cases()) width = std::max(width, c.name.size());
    std::string text;
    for (const BuiltInCase& c : built_in_cases())
        text += io::formatted("%-*s  %s\n", static_cast<int>(width), c.name.c_str(), c.note.c_str());
    text.pop_back();
    return io::wrapped_help(text);
}

void write_cases(const std::string& name, const std::string& to)
{
    if (name.empty()) return write_all(to);
    const BuiltInCase* const found = find_built_in_case(name);
    if (found == nullptr)
        throw io::UsageError("granular: unknown case" + io::with_nearest(name, names_of_cases()));
    const std::string text = text_of(*found);
    if (to.empty()) {
        std::fputs(text.c_str(), stdout);
        return;
    }
    std::error_code error;
    const std::string file = std::filesystem::is_directory(to, error) ? file_in(to, *found) : to;
    check_replaceable(file, text);
    io::write_named_file(file, text);
}

std::string known_names(const std::string& word)
{
    if (word.find('/') != std::string::npos || word.find('.') != std::string::npos) return "";
    const std::vector<std::string> cases = names_of_cases();
    std::vector<std::string> known = io::Registry<Validation>::names();
    const auto list = [](const std::vector<std::string>& names) {
        std::string all;
        for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
        return all;
    };
    const std::string validations = list(known);
    known.insert(known.end(), cases.begin(), cases.end());
    const std::string meant = io::did_you_mean(word, known);
    return meant + (meant.empty() ? "; " : " ") + "validations: " + validations + "; cases: " + list(cases);
}

}  // namespace hilda::granular
