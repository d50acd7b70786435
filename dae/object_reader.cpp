// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/object_reader.hpp"

#include "dae/nearest.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::dae {

namespace {

std::string in_words(const std::vector<std::string>& words)
{
    std::string all;
    for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
    return all;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known)
{
    const std::string meant = nearest(word, known);
    return meant.empty() ? "; allowed: " + in_words(known) : "; did you mean '" + meant + "'?";
}

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }

}  // namespace

ObjectReader::ObjectReader(const JsonSource& source, const Json& value, std::string pointer)
    : source(source), value(value), own_pointer(std::move(pointer))
{
    if (value.object() == nullptr) fail("must be an object, got " + described(value));
}

double ObjectReader::number(std::string_view key, std::optional<double> fallback)
{
    const Json* v = asked(key, !fallback);
    const double x = v != nullptr ? number_at(*v, pointer(key), key) : *fallback;
    keep(key, {.value = x});
    return x;
}

double ObjectReader::positive(std::string_view key, std::optional<double> fallback)
{
    const double x = number(key, fallback);
    if (!(x > 0)) fail(key, std::string(key) + " must be positive, got " + shortest(x));
    return x;
}

double ObjectReader::not_negative(std::string_view key, std::optional<double> fallback)
{
    const double x = number(key, fallback);
    if (!(x >= 0)) fail(key, std::string(key) + " must not be negative, got " + shortest(x));
    return x;
}

int ObjectReader::integer(std::string_view key)
{
    const double x = number(key);
    constexpr double most = 2147483647;
    if (x != std::trunc(x) || std::abs(x) > most)
        fail(key, std::string(key) + " must be an integer of at most 31 bits, got " + shortest(x));
    return static_cast<int>(x);
}

std::vector<double> ObjectReader::numbers(std::string_view key, std::size_t count)
{
    const Json& v = *asked(key, true);
    if (v.list() == nullptr || v.list()->size() != count)
        fail(key, std::string(key) + " must be a list of " + std::to_string(count) + " numbers, got " +
                      described(v));
    std::vector<double> x;
    Json::List list;
    for (std::size_t k = 0; k < count; ++k) {
        x.push_back(number_at((*v.list())[k], pointer_to(pointer(key), std::to_string(k)), key));
        list.push_back({.value = x.back()});
    }
    keep(key, {.value = std::move(list)});
    return x;
}

Vec3 ObjectReader::vec3(std::string_view key, const std::optional<Vec3>& fallback)
{
    if (asked(key, !fallback) == nullptr) {
        keep(key, json(*fallback));
        return *fallback;
    }
    const std::vector<double> x = numbers(key, 3);
    return {x[0], x[1], x[2]};
}

Vec3 ObjectReader::direction(std::string_view key)
{
    Vec3 v = vec3(key);
    const double length = v.norm();
    if (!(length > 0) || !std::isfinite(length))
        fail(key, std::string(key) + " must have a direction, got " + described(*look(key)) + " of length " +
                      shortest(length));
    return v;
}

Mat3 ObjectReader::matrix(std::string_view key)
{
    const Json& v = *asked(key, true);
    Mat3 m;
    const auto is_row = [](const Json& row) { return row.list() != nullptr && row.list()->size() == 3; };
    if (v.list() == nullptr || v.list()->size() != 3 ||
        !std::all_of(v.list()->begin(), v.list()->end(), is_row))
        fail(key, std::string(key) + " must be three rows of three numbers, got " + described(v));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            m(i, j) =
                number_at((*(*v.list())[i].list())[j],
                          pointer_to(pointer_to(pointer(key), std::to_string(i)), std::to_string(j)), key);
    keep(key, json(m));
    return m;
}

std::string ObjectReader::text(std::string_view key, const std::optional<std::string>& fallback)
{
    const Json* v = asked(key, !fallback);
    if (v != nullptr && v->string() == nullptr)
        fail(key, std::string(key) + " must be a string, got " + described(*v));
    const std::string& s = v != nullptr ? *v->string() : *fallback;
    if (s.size() > JsonSource::max_string)
        fail(key, std::string(key) + " has " + std::to_string(s.size()) + " bytes; at most " +
                      std::to_string(JsonSource::max_string) + " are allowed");
    keep(key, {.value = s});
    return s;
}

std::string ObjectReader::name(std::string_view key, const std::optional<std::string>& fallback)
{
    std::string s = text(key, fallback);
    if (s.empty() || std::any_of(s.begin(), s.end(), is_control))
        fail(key,
             std::string(key) + " must be a name without control characters, got " + described({.value = s}));
    return s;
}

std::string ObjectReader::one_of(std::string_view key, const std::vector<std::string>& allowed,
                                 const std::optional<std::string>& fallback)
{
    std::string s = text(key, fallback);
    if (std::find(allowed.begin(), allowed.end(), s) == allowed.end())
        fail(key, "unknown " + std::string(key) + " " + described({.value = s}) + suggestion(s, allowed));
    return s;
}

std::string ObjectReader::formula(std::string_view key, const std::optional<std::string>& fallback)
{
    const Json* v = asked(key, !fallback);
    if (v == nullptr || v->string() != nullptr) return text(key, fallback);
    if (v->number() == nullptr)
        fail(key, std::string(key) + " must be a number or an expression in a string, got " + described(*v));
    return shortest(number(key));
}

const Json::List& ObjectReader::list(std::string_view key, bool required)
{
    static const Json::List empty;
    const Json* v = asked(key, required);
    if (v == nullptr) return empty;
    if (v->list() == nullptr) fail(key, std::string(key) + " must be a list, got " + described(*v));
    return *v->list();
}

const Json* ObjectReader::look(std::string_view key) { return asked(key, false); }

void ObjectReader::keep(std::string_view key, Json as)
{
    for (Json::Member& m : kept)
        if (m.key == key) {
            m.value = std::move(as);
            return;
        }
    kept.push_back({std::string(key), 0, std::move(as)});
}

Json ObjectReader::finish()
{
    if (look("note") != nullptr) text("note");
    for (const Json::Member& m : *value.object())
        if (std::find(known.begin(), known.end(), m.key) == known.end()) refuse_unknown(m);
    return {.value = std::move(kept)};
}

std::string ObjectReader::place(std::string_view key) const
{
    const Json::Member* m = value.member(key);
    return m != nullptr ? source.place(m->value.offset, pointer(key)) : place();
}

void ObjectReader::fail(std::string_view key, const std::string& what) const
{
    const Json::Member* m = value.member(key);
    if (m == nullptr) fail(what);
    source.fail(m->value, pointer(key), what);
}

const Json* ObjectReader::asked(std::string_view key, bool required)
{
    if (std::find(known.begin(), known.end(), key) == known.end()) known.emplace_back(key);
    if (const Json::Member* m = value.member(key)) return &m->value;
    if (required) refuse_missing(key);
    return nullptr;
}

double ObjectReader::number_at(const Json& v, const std::string& at, std::string_view key) const
{
    if (v.number() == nullptr)
        source.fail(v, at, std::string(key) + " must be a number, got " + described(v));
    return *v.number();
}

/// A missing key is often a misspelt one: then that one is named. But body_j is not a misspelt body_i.
void ObjectReader::refuse_missing(std::string_view key)
{
    const std::vector<std::string> only = {std::string(key)};
    const auto stem = [](std::string_view word) { return word.substr(0, word.size() - 1); };
    for (const Json::Member& m : *value.object())
        if (std::find(known.begin(), known.end(), m.key) == known.end() && nearest(m.key, only) == key &&
            stem(m.key) != stem(key)) {
            known = only;
            refuse_unknown(m);
        }
    fail("missing key '" + only[0] + "'");
}

void ObjectReader::refuse_unknown(const Json::Member& m) const
{
    Json at{.value = nullptr, .offset = m.offset, .change = m.value.change};
    source.fail(at, pointer(m.key), "unknown key " + described({.value = m.key}) + suggestion(m.key, known));
}

Json json(const Vec3& v)
{
    Json::List list;
    for (int k = 0; k < 3; ++k) list.push_back({.value = v[k]});
    return {.value = std::move(list)};
}

Json json(const Mat3& m)
{
    Json::List rows;
    for (int i = 0; i < 3; ++i) rows.push_back(json(Vec3(m.row(i).transpose())));
    return {.value = std::move(rows)};
}

}  // namespace hilda::dae
