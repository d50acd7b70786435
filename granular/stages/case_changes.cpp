// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/case_changes.hpp"

#include <algorithm>

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

/// Keys that can change during a run
struct Changeable {
    const char* list;  ///< whose entries have the keys; "": the case
    std::vector<std::string> keys;
    std::vector<ChangeIn> where;
};

/// A note can change everywhere. Of laws all keys can change with which the laws remain the same:
/// check_parameters() refuses others.
const std::vector<Changeable>& all_changeable()
{
    using enum ChangeIn;
    static const std::vector<Changeable> all = {
        {"", {"name", "note", "end", "interval"}, {resumed_run, resumed_stages}},
        {"", {"gravity"}, {resumed_run, stage}},
        {"boundaries", {"r", "v", "omega", "F", "T"}, {resumed_run, stage}},
        {"laws", {}, {resumed_run, stage}},
        {"insert", {"rate", "mass_rate", "to", "v", "random_v", "active"}, {resumed_run, stage}}};
    return all;
}

template <class T>
bool contains(const std::vector<T>& all, const T& one)
{
    return std::find(all.begin(), all.end(), one) != all.end();
}

/// The elements as "a, b and c"
std::string enumeration(const std::vector<std::string>& all)
{
    std::string text;
    for (std::size_t k = 0; k < all.size(); ++k)
        text += (k == 0 ? "" : k + 1 < all.size() ? ", " : " and ") + all[k];
    return text;
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

bool CaseChange::is_possible(ChangeIn where) const
{
    const std::vector<std::string> at = tokens_of(pointer);
    if (at.empty()) return false;
    if (where != ChangeIn::stage && (at.back() == "note" || pointer == "/$schema")) return true;
    if (at.size() == 2) return false;
    const std::string list = at.size() == 1 ? "" : at[0], &key = at.size() == 1 ? at[0] : at[2];
    for (const Changeable& c : all_changeable()) {
        if (c.list != list || !contains(c.where, where)) continue;
        if (!list.empty() && at.back() == "note") return true;
        if (list == "laws") return key != "between" && at.back() != "law";
        // Numbers of r are the place at the start; a formula continues from the present place.
        if (contains(c.keys, key))
            return list != "boundaries" || key != "r" || is_formula(is) || is_formula(was);
    }
    return false;
}

std::string changeable_entries(ChangeIn where)
{
    std::vector<std::string> of_case, others;
    for (const Changeable& c : all_changeable()) {
        if (!contains(c.where, where)) continue;
        const std::string list = c.list;
        if (list.empty())
            of_case.insert(of_case.end(), c.keys.begin(), c.keys.end());
        else if (list == "laws")
            others.emplace_back("the numbers of laws");
        else
            others.push_back(enumeration(c.keys) + " of " + (list == "insert" ? "insertions" : list));
    }
    std::string text = where == ChangeIn::stage            ? "a stage can set "
                       : where == ChangeIn::resumed_stages ? "a run with stages can change "
                                                           : "a run can change ";
    text += enumeration(of_case);
    for (std::size_t k = 0; k < others.size(); ++k)
        text += (k + 1 < others.size() ? "; " : "; and ") + others[k];
    return text;
}

std::vector<CaseChange> changes_of(const io::Json& before, const io::Json& now)
{
    std::vector<CaseChange> all;
    compare(before, now, "", all);
    return all;
}

}  // namespace hilda::granular
