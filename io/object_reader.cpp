// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/object_reader.hpp"

#include "io/formats/characters.hpp"
#include "io/nearest.hpp"
#include "io/schema/schema_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hilda::io {

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
    const std::string meant = did_you_mean(word, known);
    return meant.empty() ? "; allowed: " + joined(known) : meant;
}

}  // namespace

ObjectReader::ObjectReader(const JsonSource& source, const Json& value, std::string pointer)
    : source(source), value(value), own_pointer(std::move(pointer))
{
    if (value.members() == nullptr) fail("must be an object, got " + described(value));
    constexpr std::size_t usual = 8;  // keys of an object
    known.reserve(2 * usual), recorded.reserve(usual);
    if (source.schema == nullptr) return;
    notes = std::make_shared<ObjectSchema>(*source.schema);
    notes->begin();
}

void ObjectReader::defines(std::string_view name, std::string_view title, std::string_view description,
                           std::string_view rest)
{
    if (notes == nullptr) return;
    notes = source.schema->definition(std::string(name));
    if (!notes->title.empty() && notes->title != title)
        fail("the schema already has a definition of this name, of " + notes->title + ", got " +
             in_quotes(name));
    notes->title = title, notes->description = description;
    notes->rest = source.schema->kind(rest, "schema of " + notes->title);
    notes->begin();
    constexpr size_t most = 3;
    if (source.schema->shown.contains(name) && notes->examples.size() < most) notes->add_example(value);
}

void ObjectReader::note_exclusive(std::span<const std::string> keys)
{
    if (notes == nullptr) return;
    for (size_t k = 0; k < keys.size(); ++k)
        for (const std::string& other : keys.subspan(k + 1)) notes->exclude(keys[k], other);
}

void ObjectReader::note(std::string_view key, std::string_view kind, const About& about, const Json* fallback)
{
    if (notes == nullptr) return;
    const std::string of = (notes->title.empty() ? "" : notes->title + ", ") + "key " + std::string(key);
    Json schema = Json::object(), example;
    if (!about.text.empty()) schema["description"] = std::string(about.text);
    schema.update(source.schema->kind(kind, of));
    if (fallback != nullptr && !about.computed) schema["default"] = *fallback;
    schema.update(source.schema->kind(about.rest, of));
    if (!about.example.empty()) {
        const std::string list = '[' + std::string(about.example) + ']';
        schema["examples"] = parsed_schema(list, "examples of " + of);
        example = schema["examples"].at(0);
    }
    notes->describe(key, std::move(schema), std::move(example));
}

ObjectReader ObjectReader::again() const
{
    ObjectReader o(source, value, own_pointer);
    o.notes = notes;
    return o;
}

bool ObjectReader::has(std::string_view key) const
{
    if (notes != nullptr) notes->seen(key, false);
    return value.member(key) != nullptr;
}

/// Notes a key with an optional fallback.
template <class Fallback>
void ObjectReader::note_value(std::string_view key, std::string_view kind, const About& about,
                              const std::optional<Fallback>& fallback)
{
    if (notes == nullptr) return;
    const Json as_json = fallback ? Json(*fallback) : Json();
    note(key, kind, about, fallback ? &as_json : nullptr);
}

double ObjectReader::number(std::string_view key, const About& about, std::optional<double> fallback)
{
    return number_of_kind("number", key, about, fallback);
}

double ObjectReader::number_of_kind(std::string_view kind, std::string_view key, const About& about,
                                    std::optional<double> fallback)
{
    note_value(key, kind, about, fallback);
    const Json* v = lookup(key, !fallback);
    const double x = v != nullptr ? number_at(*v, pointer(key), key) : *fallback;
    record(key, x);
    return x;
}

double ObjectReader::positive(std::string_view key, const About& about, std::optional<double> fallback)
{
    const double x = number_of_kind("positive", key, about, fallback);
    if (!(x > 0)) fail(key, std::string(key) + " must be positive, got " + shortest(x));
    if (x < least_positive)
        fail(key,
             std::string(key) + " must be at least " + shortest(least_positive) + ", got " + shortest(x));
    return x;
}

double ObjectReader::not_negative(std::string_view key, const About& about, std::optional<double> fallback)
{
    const double x = number_of_kind("not_negative", key, about, fallback);
    if (!(x >= 0)) fail(key, std::string(key) + " must not be negative, got " + shortest(x));
    return x;
}

double ObjectReader::fraction(std::string_view key, const About& about, std::optional<double> fallback)
{
    const double x = number_of_kind("fraction", key, about, fallback);
    if (!(x >= 0 && x <= 1)) fail(key, std::string(key) + " must be from 0 to 1, got " + shortest(x));
    return x;
}

int ObjectReader::integer(std::string_view key, const About& about)
{
    note(key, "integer", about);
    if (const Json* v = lookup(key, true); v->number() == nullptr)
        fail(key, std::string(key) + " must be a number, got " + described(*v));
    const double x = number_of_kind("integer", key, about, {});
    constexpr double most = 2147483647;
    if (x != std::trunc(x) || std::abs(x) > most)
        fail(key, std::string(key) + " must be an integer of at most 31 bits, got " + shortest(x));
    return static_cast<int>(x);
}

long ObjectReader::count(std::string_view key, const About& about, std::optional<long> fallback)
{
    const double x = number_of_kind("count", key, about, fallback);
    constexpr double most = 9007199254740992;  // 2^53
    if (x != std::trunc(x) || x < 0 || x > most)
        fail(key, std::string(key) + " must be an integer from 0 to 2^53, got " + shortest(x));
    return static_cast<long>(x);
}

bool ObjectReader::flag(std::string_view key, const About& about, std::optional<bool> fallback)
{
    note_value(key, "flag", about, fallback);
    const Json* v = lookup(key, !fallback);
    const bool* given = v != nullptr ? v->boolean() : nullptr;
    if (v != nullptr && given == nullptr)
        fail(key, std::string(key) + " must be true or false, got " + described(*v));
    const bool x = given != nullptr ? *given : *fallback;
    record(key, x);
    return x;
}

std::vector<double> ObjectReader::numbers(std::string_view key, std::size_t count, const About& about)
{
    if (notes != nullptr) {
        const Json number = source.schema->kind("number", {});
        const std::string size = std::to_string(count);
        note(key,
             R"("type": "array", "items": )" + written(number) + R"(, "minItems": )" + size +
                 R"(, "maxItems": )" + size,
             about);
    }
    const Json& v = *lookup(key, true);
    if (v.list() == nullptr || v.list()->size() != count)
        fail(key, std::string(key) + " must be a list of " + std::to_string(count) + " numbers, got " +
                      described(v));
    std::vector<double> x(count);
    Json::List list(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Json& element = (*v.list())[k];
        const double* const literal = element.number();
        x[k] = literal != nullptr && std::abs(*literal) <= largest  // without the text of its pointer
                   ? *literal
                   : number_at(element, pointer_to(pointer(key), std::to_string(k)), key);
        list[k].value = x[k];
    }
    record(key, std::move(list));
    return x;
}

std::string ObjectReader::text(std::string_view key, const About& about,
                               const std::optional<std::string>& fallback)
{
    note_value(key, "text", about, fallback);
    return text_of(key, fallback);
}

std::string ObjectReader::text_of(std::string_view key, const std::optional<std::string>& fallback)
{
    const Json* v = lookup(key, !fallback);
    if (v != nullptr && v->string() == nullptr)
        fail(key, std::string(key) + " must be a string, got " + described(*v));
    const std::string& s = v != nullptr ? *v->string() : *fallback;
    if (s.size() > JsonSource::max_string)
        fail(key, std::string(key) + " has " + std::to_string(s.size()) + " bytes; at most " +
                      std::to_string(JsonSource::max_string) + " are allowed");
    record(key, s);
    return s;
}

std::string ObjectReader::name(std::string_view key, const About& about,
                               const std::optional<std::string>& fallback)
{
    note_value(key, "name", about, fallback);
    std::string s = text_of(key, fallback);
    if (s.empty() || printable(s) != s)
        fail(key, std::string(key) + " must be a name without control characters, got " + described(s));
    return s;
}

std::string ObjectReader::file(std::string_view key, const About& about)
{
    note(key, "file", about);
    const Json& v = *lookup(key, true);
    const std::string* path = v.string();
    if (path == nullptr || path->empty() || printable(*path) != *path)
        fail(key, std::string(key) + " must be the path of a file, got " + described(v));
    source.files.push_back(path->front() == '/' || source.base.empty() ? *path : source.base + '/' + *path);
    require_within(key, source.files.back(), "file that names it");
    return source.files.back();
}

void ObjectReader::require_within(std::string_view key, const std::string& path,
                                  const std::string& whose) const
{
    namespace fs = std::filesystem;
    if (source.within.empty()) return;
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(source.within, error),
                   canonical = fs::weakly_canonical(fs::absolute(path, error), error);
    if (error ||
        std::mismatch(folder.begin(), folder.end(), canonical.begin(), canonical.end()).first != folder.end())
        fail(key, std::string(key) + " must be below the folder of the " + whose + ", " + folder.string() +
                      ", got " + described(*peek(key)) + "; --allow-paths accepts it");
}

std::string ObjectReader::one_of(std::string_view key, const std::vector<std::string>& allowed,
                                 const About& about, const std::optional<std::string>& fallback)
{
    if (notes != nullptr) {
        const Json default_word = fallback ? Json(*fallback) : Json();
        note(key, R"("enum": )" + written(Json(allowed)), about, fallback ? &default_word : nullptr);
    }
    std::string s = text_of(key, fallback);
    if (std::find(allowed.begin(), allowed.end(), s) == allowed.end())
        fail(key, "unknown " + std::string(key) + " " + described(s) + suggestion(s, allowed));
    return s;
}

std::string ObjectReader::formula(std::string_view key, const About& about,
                                  const std::optional<std::string>& fallback,
                                  const std::vector<std::string>& variables)
{
    note_value(key, "formula", about, fallback);
    const Json* v = lookup(key, !fallback);
    if (v != nullptr && v->number() != nullptr) return shortest(number_of_kind("number", key, {}, {}));
    if (v != nullptr && v->string() == nullptr)
        fail(key, std::string(key) + " must be a number or an expression in a string, got " + described(*v));
    std::string formula = text_of(key, fallback);
    if (source.parameters != nullptr) try {
            record(key, formula = source.parameters->substituted(formula, variables));
        } catch (const ExpressionError& e) {
            fail(key, e.what());
        }
    return formula;
}

std::string ObjectReader::formula_of_names(std::string_view key, const std::vector<std::string>& variables,
                                           const About& about)
{
    note(key, "formula_of_names", about);
    std::string formula = text_of(key, {});
    if (formula.empty()) fail(key, std::string(key) + " must be an expression, got \"\"");
    if (source.parameters != nullptr) record(key, formula = source.parameters->replaced(formula, variables));
    return formula;
}

std::array<Expression, 3> ObjectReader::expressions(std::string_view key, const About& about,
                                                    const std::vector<std::string>& variables)
{
    note(key, R"("type": "array", "items": {"$ref": "#/$defs/formula"}, "minItems": 3, "maxItems": 3)",
         about);
    const Json::List& parts = *lookup_list(key, true);
    if (parts.size() != 3) {
        std::string names;
        for (const std::string& name : variables) names += (names.empty() ? "" : ", ") + name;
        fail(key, std::string(key) + " must be three numbers or expressions in " + names + ", got " +
                      described(parts));
    }
    Json::List recorded = parts;
    const auto expression = [&](std::size_t k) {
        if (parts[k].number() == nullptr && parts[k].string() == nullptr)
            fail(key, k,
                 "a component must be a number or an expression in a string, got " + described(parts[k]));
        if (const std::string* s = parts[k].string(); s != nullptr) try {
                const std::string formula =
                    source.parameters != nullptr ? source.parameters->substituted(*s, variables) : *s;
                recorded[k].value = formula;
                return Expression(formula, variables);
            } catch (const ExpressionError& e) {
                fail(key, k, e.what());
            }
        return Expression(shortest(number_at(parts[k], pointer_to(pointer(key), std::to_string(k)), key)),
                          variables);
    };
    std::array<Expression, 3> all = {expression(0), expression(1), expression(2)};
    record(key, std::move(recorded));
    return all;
}

ObjectReader ObjectReader::object(std::string_view key, const About& about, std::string_view definition)
{
    if (notes != nullptr) {
        const std::string name(definition);
        note(key, name.empty() ? R"("type": "object")" : R"("$ref": "#/$defs/)" + name + '"', about);
    }
    ObjectReader o(source, *lookup(key, true), pointer(key));
    if (notes != nullptr && definition.empty()) o.notes = notes->inner(key);
    return o;
}

const Json::List& ObjectReader::list(std::string_view key, bool required, const About& about)
{
    note(key, R"("type": "array")", about);
    static const Json::List empty;
    const Json::List* const elements = lookup_list(key, required);
    return elements != nullptr ? *elements : empty;
}

const Json::List* ObjectReader::lookup_list(std::string_view key, bool required)
{
    const Json* v = lookup(key, required);
    if (v != nullptr && v->list() == nullptr)
        fail(key, std::string(key) + " must be a list, got " + described(*v));
    return v != nullptr ? v->list() : nullptr;
}

const Json* ObjectReader::peek(std::string_view key) const
{
    const Json::Member* m = value.member(key);
    return m != nullptr ? &m->value : nullptr;
}

const Json* ObjectReader::find(std::string_view key) { return lookup(key, false); }

void ObjectReader::exclude(std::string_view key, std::string_view other)
{
    if (notes != nullptr) notes->exclude(std::string(key), std::string(other));
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

void ObjectReader::allow_schema(const About& about)
{
    note("$schema", R"("type": "string", "maxLength": 4096)", about);
    if (const Json* v = find("$schema"); v != nullptr && v->string() == nullptr)
        fail("$schema", "$schema must be a string, got " + described(*v));
}

Json ObjectReader::finish()
{
    note("note", "note", {});
    if (find("note") != nullptr) text_of("note", {});
    for (const Json::Member& m : *value.members())
        if (std::find(known.begin(), known.end(), m.key) == known.end()) fail_unknown_key(m);
    return std::move(recorded);
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

void ObjectReader::fail(std::string_view key, std::size_t element, const std::string& what) const
{
    const Json::Member* m = value.member(key);
    source.fail(m->value.list()->at(element), pointer_to(pointer(key), std::to_string(element)), what);
}

void ObjectReader::version(std::string_view key)
{
    refuse_other_kinds(key);
    if (const int version = integer(key); version != 1)
        fail(key, "the version of the format must be 1, got " + std::to_string(version));
}

void ObjectReader::refuse_other_kinds(std::string_view key) const
{
    struct Kind {
        std::string_view key, what, command;
    };
    static constexpr Kind kinds[] = {{"hilda_model", "a model", "hilda run"},
                                     {"hilda_case", "a case of grains", "hilda granular"},
                                     {"hilda_cosim", "a co-simulation", "hilda cosim"}};
    if (peek(key) != nullptr) return;
    for (const Kind& other : kinds)
        for (const Kind& expected : kinds)
            if (peek(other.key) != nullptr && expected.key == key)
                fail(other.key, "the file is " + std::string(other.what) + ", not " +
                                    std::string(expected.what) + "; use " + std::string(other.command));
}

const Json* ObjectReader::lookup(std::string_view key, bool required)
{
    if (std::find(known.begin(), known.end(), key) == known.end()) known.emplace_back(key);
    if (notes != nullptr) notes->seen(key, required);
    if (const Json::Member* m = value.member(key)) return &m->value;
    if (notes != nullptr && required)
        if (const Json* const example = notes->example(key)) return example;
    if (required) fail_missing_key(key);
    return nullptr;
}

double ObjectReader::number_at(const Json& v, const std::string& at, std::string_view key) const
{
    const double* literal = v.number();
    const bool expression = v.string() != nullptr && source.parameters != nullptr;
    if (literal == nullptr && !expression)
        source.fail(v, at, std::string(key) + " must be a number, got " + described(v));
    double x = literal != nullptr ? *literal : 0;
    if (expression) try {
            x = source.parameters->value(*v.string());
        } catch (const ExpressionError& e) {
            source.fail(v, at, std::string(key) + " must be a number or an expression: " + e.what());
        }
    if (std::abs(x) > largest)
        source.fail(
            v, at,
            std::string(key) + " must be at most " + shortest(largest) + " in magnitude, got " + shortest(x));
    return x;
}

/// Reports a missing key. If an unknown key of the object resembles it, that key is reported instead. Keys
/// that differ in the last letter only, such as body_i and body_j, do not count as similar.
void ObjectReader::fail_missing_key(std::string_view key)
{
    const std::vector<std::string> this_key = {std::string(key)};
    const auto stem = [](std::string_view word) { return word.substr(0, word.size() - 1); };
    for (const Json::Member& m : *value.members())
        if (std::find(known.begin(), known.end(), m.key) == known.end() &&
            io::nearest(m.key, this_key) == key && stem(m.key) != stem(key)) {
            known = this_key;
            fail_unknown_key(m);
        }
    fail("missing key '" + this_key[0] + "'");
}

void ObjectReader::fail_unknown_key(const Json::Member& m) const
{
    Json at;
    at.offset = m.offset;
    at.change = m.value.change;
    source.fail(at, pointer(m.key), "unknown key " + described(m.key) + suggestion(m.key, known));
}

}  // namespace hilda::io
