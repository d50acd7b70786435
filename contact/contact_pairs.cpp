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
    std::set<int> known;
    for (std::size_t k = 0; k < list.size(); ++k) {
        numbers.push_back(bodies.body_of_list(o, key, k));
        if (!known.insert(numbers.back()).second)
            o.fail(key, k, std::string(key) + " lists a body twice, got " + dae::described(list[k]));
    }
    return numbers;
}

void refuse_too_many(dae::ObjectReader& o, std::string_view key, const std::vector<int>& numbers)
{
    if (numbers.size() > ContactPairs::most_bodies)
        o.fail(key, "a group may have at most " + std::to_string(ContactPairs::most_bodies) +
                        " bodies, got " + std::to_string(numbers.size()));
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
    R"("allOf": [{"if": {"required": ["friction"], "properties": {"normal": {"properties": {"type": )"
    R"({"const": "dvi"}}}}}, "then": {"properties": {"friction": {"description": "The law of a rigid )"
    R"(contact.", "required": ["law"], "properties": {"law": {"const": "coulomb"}}}}}, "else": )"
    R"({"properties": {"friction": {"not": {"required": ["law"], "properties": {"law": {"const": )"
    R"("coulomb"}}}}}}}], )"
    R"("if": {"required": ["friction"], "properties": {"normal": {"properties": {"type": {"not": {"const": )"
    R"("hertz"}}}}, "friction": {"required": ["spin"], "properties": {"law": {"const": )"
    R"("slide-roll-spin"}}}}}, "then": {"properties": {"friction": {"description": "Without a Hertzian )"
    R"(normal law, spin needs a modulus.", "required": ["E_star"]}}})";

}  // namespace

void ContactPairs::index()
{
    const auto places_of = [](const std::vector<int>& list) {
        std::vector<int> places;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const auto at = static_cast<std::size_t>(list[k]) + 1;
            if (at >= places.size()) places.resize(at + 1, -1);
            places[at] = static_cast<int>(k);
        }
        return places;
    };
    places_in_first = places_of(first), places_in_second = places_of(second);
}

int ContactPairs::place(const std::vector<int>& places, int body)
{
    const auto at = static_cast<std::size_t>(body) + 1;
    return at < places.size() ? places[at] : -1;
}

bool ContactPairs::has(int a, int b) const
{
    if (each_two) return a < b;
    const int i = first[static_cast<std::size_t>(a)], j = second[static_cast<std::size_t>(b)];
    if (i == j) return false;
    const int other_a = place_in_first(j), other_b = place_in_second(i);
    return other_a < 0 || other_b < 0 || number(a, b) < number(other_a, other_b);
}

std::pair<int, int> ContactPairs::pair(int number) const
{
    const auto width = static_cast<int>(second.size());
    return {first[static_cast<std::size_t>(number / width)],
            second[static_cast<std::size_t>(number % width)]};
}

long ContactPairs::count() const
{
    const auto n = static_cast<long>(first.size()), m = static_cast<long>(second.size());
    if (each_two) return n * (n - 1) / 2;
    const long common =
        std::count_if(first.begin(), first.end(), [&](int b) { return place_in_second(b) >= 0; });
    return n * m - common - common * (common - 1) / 2;
}

int ContactPairs::first_number() const
{
    for (int n = 0; n < numbers(); ++n)
        if (has(n)) return n;
    return -1;
}

std::string ContactPairs::name_of_pair(const lie::System& model, const std::string& name, int i, int j)
{
    return name + ": " + model.body_name(i) + '-' + model.body_name(j);
}

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
        all.first = read_group(o, "bodies", bodies, count);
        refuse_too_many(o, "bodies", all.first);
        all.second = all.first;
        all.each_two = all.is_group = true;
        all.surface_i = all.surface_j = "surface";
        all.index();
        if (all.count() == 0)
            o.fail("bodies",
                   "a group must have at least two bodies, got " + std::to_string(all.first.size()));
        return all;
    }
    const bool group_i = is_group(o, "body_i", bodies), group_j = is_group(o, "body_j", bodies);
    if (!group_i && !group_j) {
        const auto [i, j] = bodies.pair(o);
        all.first = {i}, all.second = {j};
        all.index();
        return all;
    }
    const auto read = [&](const char* key, bool group) {
        std::vector<int> list =
            group ? read_group(o, key, bodies, count) : std::vector<int>{bodies.body(o, key)};
        refuse_too_many(o, key, list);
        return list;
    };
    all.first = read("body_i", group_i), all.second = read("body_j", group_j);
    all.is_group = true;
    all.index();
    if (all.count() == 0)
        o.fail("body_j", "body_i and body_j must contain two different bodies, got the same body");
    return all;
}

}  // namespace hilda::contact
