// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_pairs.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace hilda::contact {

namespace {

/// Whether the value of a key denotes several bodies
bool is_group(dae::ObjectReader& o, std::string_view key, const dae::BodyFinder& bodies)
{
    const io::Json* v = o.find(key);
    if (v == nullptr) return false;
    return v->list() != nullptr || (v->string() != nullptr && *v->string() == "all" && !bodies.named("all"));
}

std::vector<int> read_group(dae::ObjectReader& o, std::string_view key, const dae::BodyFinder& bodies,
                            int count)
{
    std::vector<int> numbers;
    if (o.find(key)->list() == nullptr) {
        numbers.resize(static_cast<std::size_t>(count));
        std::iota(numbers.begin(), numbers.end(), 0);
        return numbers;
    }
    const io::Json::List& list = o.list(key, true);
    if (list.empty()) o.fail(key, std::string(key) + " must not be an empty list");
    for (std::size_t k = 0; k < list.size(); ++k) {
        numbers.push_back(bodies.body_of_list(o, key, k));
        if (std::find(numbers.begin(), numbers.end() - 1, numbers.back()) != numbers.end() - 1)
            o.fail(key, k, std::string(key) + " lists a body twice, got " + dae::described(list[k]));
    }
    return numbers;
}

/// Each of `first` with each of `second`, without pairs of a body with itself and repeated pairs
std::vector<std::pair<int, int>> pairs_of(dae::ObjectReader& o, std::string_view key,
                                          const std::vector<int>& first, const std::vector<int>& second)
{
    std::vector<std::pair<int, int>> pairs;
    std::set<std::pair<int, int>> known;
    for (const int i : first)
        for (const int j : second) {
            if (i == j || !known.emplace(std::minmax(i, j)).second) continue;
            pairs.emplace_back(i, j);
            if (pairs.size() > ContactPairs::most)
                o.fail(key, "a group may have at most " + std::to_string(ContactPairs::most) +
                                " pairs of bodies, got more");
        }
    return pairs;
}

/// Conditions on several keys of a contact, for the schema
constexpr const char* conditions =
    R"("oneOf": [{"required": ["body_i", "body_j", "surface_i", "surface_j"], "not": {"anyOf": [)"
    R"({"required": ["bodies"]}, {"required": ["surface"]}]}}, {"required": ["bodies", "surface"], "not": )"
    R"({"anyOf": [{"required": ["body_i"]}, {"required": ["body_j"]}, {"required": ["surface_i"]}, )"
    R"({"required": ["surface_j"]}]}}], )"
    R"("dependentSchemas": {"friction": {"if": {"properties": {"friction": {"type": "object", "required": )"
    R"(["law"], "properties": {"law": {"enum": ["rolling", "implicit"]}}}}}, "then": {"properties": )"
    R"({"normal": {"description": "A constraint without a fallback.", "properties": {"type": {"const": )"
    R"("constraint"}}, "not": {"required": ["fallback"]}}}}}}, )"
    R"("if": {"required": ["friction"], "properties": {"normal": {"properties": {"type": {"not": {"const": )"
    R"("hertz"}}}}, "friction": {"required": ["spin"], "properties": {"law": {"const": )"
    R"("slide-roll-spin"}}}}}, "then": {"properties": {"friction": {"description": "Without a Hertzian )"
    R"(normal law, spin needs a modulus.", "required": ["E_star"]}}})";

}  // namespace

void define_contact(dae::ObjectReader& o)
{
    o.defines("contact", "Contact",
              "Contact between a surface of body i and a surface of body j: a normal force and, "
              "optionally, friction. At the start, compliant contacts must not overlap by more than "
              "a tenth of a radius of curvature. An entry can stand for many pairs of bodies: each "
              "two of the bodies of a list (bodies), or each of one list with each of another "
              "(body_i, body_j). A pair of such a group NAME has the name \"NAME: body i-body j\".",
              conditions);
}

ContactPairs read_contact_pairs(dae::ObjectReader& o, const dae::BodyFinder& bodies, int count)
{
    constexpr const char* one_or_more =
        R"("anyOf": [{"$ref": "#/$defs/reference"}, {"$ref": "#/$defs/references"}])";
    o.note("body_i", one_or_more,
           {"Body i, a list of bodies, or \"all\" for all bodies with mass.", R"("ball", "all")"});
    o.note("body_j", one_or_more,
           {"Body j, which must differ from body i, a list of bodies, or \"all\" for all bodies with mass.",
            R"("ground")"});
    o.note(
        "bodies", R"("anyOf": [{"const": "all"}, {"$ref": "#/$defs/references"}])",
        {"Bodies of which each two are in contact: a list, or \"all\" for all bodies with mass. All have the "
         "same surface.",
         R"("all", ["ball-1", "ball-2", "ball-3"])"});
    ContactPairs all;
    if (o.find("bodies") != nullptr) {
        for (const char* key : {"body_i", "body_j", "surface_i", "surface_j"})
            if (o.has(key))
                o.fail(
                    key,
                    std::string(key) +
                        " does not go with bodies, whose pairs have one key surface; give body_i and body_j "
                        "for two different surfaces");
        if (!is_group(o, "bodies", bodies))
            o.fail("bodies",
                   "bodies must be a list of bodies or \"all\", got " + dae::described(*o.find("bodies")));
        const std::vector<int> group = read_group(o, "bodies", bodies, count);
        all = {.pairs = pairs_of(o, "bodies", group, group),
               .is_group = true,
               .surface_i = "surface",
               .surface_j = "surface"};
        if (all.pairs.empty())
            o.fail("bodies", "a group must have at least two bodies, got " + std::to_string(group.size()));
        return all;
    }
    const bool group_i = is_group(o, "body_i", bodies), group_j = is_group(o, "body_j", bodies);
    if (!group_i && !group_j) {
        all.pairs = {bodies.pair(o)};
        return all;
    }
    const auto read = [&](const char* key, bool group) {
        return group ? read_group(o, key, bodies, count) : std::vector<int>{bodies.body(o, key)};
    };
    const std::vector<int> first = read("body_i", group_i), second = read("body_j", group_j);
    all.pairs = pairs_of(o, group_i ? "body_i" : "body_j", first, second);
    all.is_group = true;
    if (all.pairs.empty())
        o.fail("body_j", "body_i and body_j must contain two different bodies, got the same body");
    return all;
}

}  // namespace hilda::contact
