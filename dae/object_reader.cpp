// SPDX-License-Identifier: GPL-3.0-or-later
/// ObjectReader and the reader of orientations.
#include "dae/object_reader.hpp"

#include "io/nearest.hpp"
#include "lie/euler_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::dae {

namespace {

std::string joined(const std::vector<std::string>& words)
{
    std::string all;
    for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
    return all;
}

/// Ending of a message about an unknown word
std::string suggestion(std::string_view word, const std::vector<std::string>& known)
{
    const std::string meant = io::nearest(word, known);
    return meant.empty() ? "; allowed: " + joined(known) : "; did you mean '" + meant + "'?";
}

// Largest deviation from a rotation that is corrected. It admits orientations with seven digits.
constexpr double orientation_tolerance = 1e-6;
// An A with a smaller error is not changed, so that writing and reading a model leaves it unchanged.
constexpr double exact_rotation = 1e-14;

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }

}  // namespace

ObjectReader::ObjectReader(const JsonSource& source, const Json& value, std::string pointer)
    : source(source), value(value), own_pointer(std::move(pointer))
{
    if (value.object() == nullptr) fail("must be an object, got " + described(value));
}

double ObjectReader::number(std::string_view key, std::optional<double> fallback)
{
    const Json* v = lookup(key, !fallback);
    const double x = v != nullptr ? number_at(*v, pointer(key), key) : *fallback;
    record(key, {.value = x});
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

bool ObjectReader::flag(std::string_view key, std::optional<bool> fallback)
{
    const Json* v = lookup(key, !fallback);
    const bool* given = v != nullptr ? std::get_if<bool>(&v->value) : nullptr;
    if (v != nullptr && given == nullptr)
        fail(key, std::string(key) + " must be true or false, got " + described(*v));
    const bool x = given != nullptr ? *given : *fallback;
    record(key, {.value = x});
    return x;
}

std::vector<double> ObjectReader::numbers(std::string_view key, std::size_t count)
{
    const Json& v = *lookup(key, true);
    if (v.list() == nullptr || v.list()->size() != count)
        fail(key, std::string(key) + " must be a list of " + std::to_string(count) + " numbers, got " +
                      described(v));
    std::vector<double> x;
    Json::List list;
    for (std::size_t k = 0; k < count; ++k) {
        x.push_back(number_at((*v.list())[k], pointer_to(pointer(key), std::to_string(k)), key));
        list.push_back({.value = x.back()});
    }
    record(key, {.value = std::move(list)});
    return x;
}

Vec3 ObjectReader::vec3(std::string_view key, const std::optional<Vec3>& fallback)
{
    if (lookup(key, !fallback) == nullptr) {
        record(key, json(*fallback));
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
        fail(key, std::string(key) + " must have a direction, got " + described(*find(key)) + " of length " +
                      shortest(length));
    return v;
}

Mat3 ObjectReader::matrix(std::string_view key)
{
    const Json& v = *lookup(key, true);
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
    record(key, json(m));
    return m;
}

std::string ObjectReader::text(std::string_view key, const std::optional<std::string>& fallback)
{
    const Json* v = lookup(key, !fallback);
    if (v != nullptr && v->string() == nullptr)
        fail(key, std::string(key) + " must be a string, got " + described(*v));
    const std::string& s = v != nullptr ? *v->string() : *fallback;
    if (s.size() > JsonSource::max_string)
        fail(key, std::string(key) + " has " + std::to_string(s.size()) + " bytes; at most " +
                      std::to_string(JsonSource::max_string) + " are allowed");
    record(key, {.value = s});
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
    const Json* v = lookup(key, !fallback);
    if (v == nullptr || v->string() != nullptr) return text(key, fallback);
    if (v->number() == nullptr)
        fail(key, std::string(key) + " must be a number or an expression in a string, got " + described(*v));
    return shortest(number(key));
}

ObjectReader ObjectReader::object(std::string_view key) { return {source, *lookup(key, true), pointer(key)}; }

const Json::List& ObjectReader::list(std::string_view key, bool required)
{
    static const Json::List empty;
    const Json* v = lookup(key, required);
    if (v == nullptr) return empty;
    if (v->list() == nullptr) fail(key, std::string(key) + " must be a list, got " + described(*v));
    return *v->list();
}

const Json* ObjectReader::find(std::string_view key) { return lookup(key, false); }

void ObjectReader::exclude(std::string_view key, std::string_view other)
{
    const bool both = find(key) != nullptr && find(other) != nullptr;
    if (both) fail(other, "give one of " + std::string(key) + " and " + std::string(other) + ", not both");
}

void ObjectReader::record(std::string_view key, Json as)
{
    for (Json::Member& m : recorded)
        if (m.key == key) {
            m.value = std::move(as);
            return;
        }
    recorded.push_back({std::string(key), 0, std::move(as)});
}

Json ObjectReader::finish()
{
    if (find("note") != nullptr) text("note");
    for (const Json::Member& m : *value.object())
        if (std::find(known.begin(), known.end(), m.key) == known.end()) fail_unknown_key(m);
    return {.value = std::move(recorded)};
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

const Json* ObjectReader::lookup(std::string_view key, bool required)
{
    if (std::find(known.begin(), known.end(), key) == known.end()) known.emplace_back(key);
    if (const Json::Member* m = value.member(key)) return &m->value;
    if (required) fail_missing_key(key);
    return nullptr;
}

double ObjectReader::number_at(const Json& v, const std::string& at, std::string_view key) const
{
    if (v.number() == nullptr)
        source.fail(v, at, std::string(key) + " must be a number, got " + described(v));
    return *v.number();
}

/// Reports a missing key. If an unknown key of the object resembles it, that key is reported instead. Keys
/// that differ in the last letter only, such as body_i and body_j, do not count as similar.
void ObjectReader::fail_missing_key(std::string_view key)
{
    const std::vector<std::string> this_key = {std::string(key)};
    const auto stem = [](std::string_view word) { return word.substr(0, word.size() - 1); };
    for (const Json::Member& m : *value.object())
        if (std::find(known.begin(), known.end(), m.key) == known.end() &&
            io::nearest(m.key, this_key) == key && stem(m.key) != stem(key)) {
            known = this_key;
            fail_unknown_key(m);
        }
    fail("missing key '" + this_key[0] + "'");
}

void ObjectReader::fail_unknown_key(const Json::Member& m) const
{
    Json at{.value = nullptr, .offset = m.offset, .change = m.value.change};
    source.fail(at, pointer(m.key), "unknown key " + described({.value = m.key}) + suggestion(m.key, known));
}

Mat3 read_orientation(ObjectReader& o)
{
    const std::vector<std::string> forms = {"A", "p", "axis_angle"};
    const auto given = std::count_if(forms.begin(), forms.end(),
                                     [&](const std::string& key) { return o.find(key) != nullptr; });
    if (given > 1)
        o.fail("the orientation must be given once, as one of A, p and axis_angle; got " +
               std::to_string(given));

    const auto deviation_message = [](const std::string& what, double value) {
        return what + ", got " + shortest(value) + "; deviations up to " + shortest(orientation_tolerance) +
               " are corrected";
    };
    Mat3 A = Mat3::Identity();
    if (o.has("A")) {
        A = o.matrix("A");
        if (const double error = lie::orthogonality_error(A); !(error <= orientation_tolerance))
            o.fail("A", deviation_message("A must be a rotation matrix: |A^T A - I| must be 0", error));
        if (A.determinant() < 0) o.fail("A", "A must be a rotation matrix, got a reflection (det A = -1)");
        if (lie::orthogonality_error(A) > exact_rotation) A = lie::nearest_rotation(A);
    } else if (o.has("p")) {
        const std::vector<double> e = o.numbers("p", 4);
        const lie::Vec4 p(e[0], e[1], e[2], e[3]);
        if (!(std::abs(p.norm() - 1) <= orientation_tolerance))
            o.fail("p", deviation_message("p must have length 1", p.norm()));
        A = lie::rotation(p.normalized());
    } else if (o.has("axis_angle")) {
        const std::vector<double> a = o.numbers("axis_angle", 4);
        const Vec3 u(a[0], a[1], a[2]);
        if (!(std::abs(u.norm() - 1) <= orientation_tolerance))
            o.fail("axis_angle", deviation_message("the axis of axis_angle must have length 1", u.norm()));
        A = lie::exp(std::remainder(a[3], 2 * std::numbers::pi) * u.normalized());
    }
    return A;
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
