// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/case_changes.hpp"

#include <algorithm>
#include <array>

namespace hilda::granular {

namespace {

/// A list that contains objects or lists
bool is_nested(const io::Json& value)
{
    return value.list() != nullptr &&
           std::any_of(value.list()->begin(), value.list()->end(), [](const io::Json& element) {
               return element.members() != nullptr || element.list() != nullptr;
           });
}

void compare(const io::Json& before, const io::Json& now, const std::string& pointer,
             std::vector<CaseChange>& all)
{
    if (before.members() != nullptr && now.members() != nullptr) {
        for (const io::Json::Member& m : *before.members()) {
            const io::Json::Member* const other = now.member(m.key);
            const std::string at = io::pointer_to(pointer, m.key);
            if (other == nullptr)
                all.push_back({at, &m.value, nullptr});
            else
                compare(m.value, other->value, at, all);
        }
        for (const io::Json::Member& m : *now.members())
            if (before.member(m.key) == nullptr)
                all.push_back({io::pointer_to(pointer, m.key), nullptr, &m.value});
    } else if (is_nested(before) && is_nested(now) && before.size() == now.size()) {
        for (std::size_t k = 0; k < before.size(); ++k)
            compare(before.at(k), now.at(k), pointer + '/' + std::to_string(k), all);
    } else if (io::written(before) != io::written(now)) {
        all.push_back({pointer, &before, &now});
    }
}

std::vector<std::string> tokens_of(const std::string& pointer)
{
    std::vector<std::string> all;
    for (std::size_t begin = 1; begin <= pointer.size();) {
        const std::size_t end = std::min(pointer.find('/', begin), pointer.size());
        all.push_back(pointer.substr(begin, end - begin));
        begin = end + 1;
    }
    return all;
}

bool is_formula(const io::Json* value)
{
    return value != nullptr && value->list() != nullptr &&
           std::any_of(value->list()->begin(), value->list()->end(),
                       [](const io::Json& part) { return part.string() != nullptr; });
}

template <std::size_t n>
bool contains(const std::array<const char*, n>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string CaseChange::text() const
{
    const auto shown = [](const io::Json* value) {
        std::string all = value == nullptr ? "missing" : io::written(*value);
        constexpr std::size_t most = 60;
        return all.size() > most || all.find('\n') != std::string::npos ? std::string("another value") : all;
    };
    return (pointer.empty() ? "/" : pointer) + " was " + shown(was) + " and is " + shown(is) + " now";
}

bool CaseChange::is_possible() const
{
    constexpr std::array of_case = {"name", "gravity", "end", "interval", "$schema"};
    constexpr std::array of_boundary = {"v", "omega", "F", "T"};
    constexpr std::array of_insertion = {"rate", "mass_rate", "to", "v", "random_v", "active"};
    const std::vector<std::string> at = tokens_of(pointer);
    if (at.empty()) return false;
    if (at.back() == "note") return true;
    if (at.size() == 1) return contains(of_case, at[0]);
    if (at.size() < 3) return false;
    const std::string& key = at[2];
    // Numbers of r are the place at the start; a formula continues from the present place.
    if (at[0] == "boundaries")
        return contains(of_boundary, key) || (key == "r" && (is_formula(is) || is_formula(was)));
    // take_over() refuses other laws that are stated by other keys.
    if (at[0] == "laws") return key != "between" && at.back() != "law";
    return at[0] == "insert" && contains(of_insertion, key);
}

std::vector<CaseChange> changes_of(const io::Json& before, const io::Json& now)
{
    std::vector<CaseChange> all;
    compare(before, now, "", all);
    return all;
}

}  // namespace hilda::granular
