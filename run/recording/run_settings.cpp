// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/run_settings.hpp"

#include "io/error.hpp"
#include "io/json_source.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace hilda::run {

namespace {

constexpr const char* model_key = "model";

/// A list of settings on both sides
struct Sides {
    std::string earlier, now;

    void add(const std::string& a, const std::string& b)
    {
        (earlier += earlier.empty() ? "" : ", ") += a;
        (now += now.empty() ? "" : ", ") += b;
    }
};

std::string shown(const RunSettings& settings, const std::string& name)
{
    const auto at = settings.find(name);
    if (at == settings.end()) return "no " + name;
    return at->second.empty() ? name : name + ' ' + at->second;
}

/// Adds the first entry in which two JSON values differ. False if they are equal.
bool add_first(Sides& to, const io::Json& a, const io::Json& b, const std::string& pointer)
{
    if (a.members() != nullptr && b.members() != nullptr) {
        for (const io::Json::Member& member : *a.members()) {
            const io::Json::Member* other = b.member(member.key);
            const std::string here = io::pointer_to(pointer, member.key);
            if (other == nullptr) return to.add(here + ' ' + io::described(member.value), "no " + here), true;
            if (add_first(to, member.value, other->value, here)) return true;
        }
        for (const io::Json::Member& member : *b.members())
            if (a.member(member.key) == nullptr) {
                const std::string here = io::pointer_to(pointer, member.key);
                return to.add("no " + here, here + ' ' + io::described(member.value)), true;
            }
        return false;
    }
    if (a.list() != nullptr && b.list() != nullptr && a.size() == b.size()) {
        for (size_t k = 0; k < a.size(); ++k)
            if (add_first(to, a.at(k), b.at(k), pointer + '/' + std::to_string(k))) return true;
        return false;
    }
    if (a.value.index() == b.value.index() && io::written(a) == io::written(b)) return false;
    to.add(pointer + ' ' + io::described(a), pointer + ' ' + io::described(b));
    return true;
}

void add_models(Sides& to, const std::string& earlier, const std::string& now)
{
    try {
        const io::JsonSource a(earlier, "model.json"), b(now, "model.json");
        if (add_first(to, a.root, b.root, "")) return;
    } catch (const io::InvalidInput&) {
        // model.json is missing or was changed
    }
    to.add("another model", "the model given");
}

}  // namespace

std::string difference(const RunSettings& earlier, const RunSettings& now, const std::string& earlier_model,
                       const std::string& model)
{
    std::set<std::string> names;
    for (const RunSettings* settings : {&earlier, &now})
        for (const auto& [name, value] : *settings) names.insert(name);
    Sides sides;
    for (const std::string& name : names) {
        const auto a = earlier.find(name), b = now.find(name);
        if (a != earlier.end() && b != now.end() && a->second == b->second) continue;
        if (name == model_key)
            add_models(sides, earlier_model, model);
        else
            sides.add(shown(earlier, name), shown(now, name));
    }
    return sides.now.empty() ? "" : "it has " + sides.earlier + "; this run has " + sides.now;
}

}  // namespace hilda::run
