// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/built_in_cases.hpp"

#include "granular/built_in_texts.hpp"  // generated from the files in cases/
#include "io/json_source.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

std::vector<BuiltInCase> all_cases()
{
    std::vector<BuiltInCase> all;
    for (const auto& [name, text] : built_in_texts) {
        const io::JsonSource source(text, name);
        const io::Json::Member* note = source.root.member("note");
        const std::string* words = note != nullptr ? note->value.string() : nullptr;
        all.push_back({.name = name, .text = text, .note = words != nullptr ? *words : ""});
    }
    std::sort(all.begin(), all.end(),
              [](const BuiltInCase& a, const BuiltInCase& b) { return a.name < b.name; });
    return all;
}

}  // namespace

const std::vector<BuiltInCase>& built_in_cases()
{
    static const std::vector<BuiltInCase> all = all_cases();
    return all;
}

const BuiltInCase* find_built_in_case(const std::string& name)
{
    for (const BuiltInCase& c : built_in_cases())
        if (c.name == name) return &c;
    return nullptr;
}

}  // namespace hilda::granular
