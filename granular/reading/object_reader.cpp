// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/reading/object_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace hilda::granular {

ObjectReader::ObjectReader(io::ObjectReader o) : io::ObjectReader(std::move(o))
{
    largest = std::numeric_limits<float>::max();
    least_positive = std::numeric_limits<float>::min();
}

Vec3 ObjectReader::vec3(std::string_view key, const io::About& about, const std::optional<Vec3>& fallback)
{
    if (records_schema()) {
        const io::Json by_default = fallback ? io::Json{fallback->x, fallback->y, fallback->z} : io::Json();
        note(key, "vector", about, fallback ? &by_default : nullptr);
    }
    if (fallback && find(key) == nullptr) return *fallback;
    const std::vector<double> x = numbers(key, 3);
    return {x[0], x[1], x[2]};
}

Vec3 ObjectReader::direction(std::string_view key, const io::About& about)
{
    note(key, "direction", about);
    const Vec3 v = vec3(key);
    if (!(v.norm() > 0))
        fail(key, std::string(key) + " must have a direction, got " + io::described(*find(key)));
    return (1 / v.norm()) * v;
}

std::optional<double> ObjectReader::optional_positive(std::string_view key, const io::About& about)
{
    note(key, "positive", about);
    return has(key) ? std::optional(positive(key)) : std::nullopt;
}

std::array<bool, 6> ObjectReader::sides(std::string_view key, const io::About& about)
{
    note(key,
         R"("type": "array", "items": {"enum": ["-x", "+x", "-y", "+y", "-z", "+z"]}, )"
         R"("uniqueItems": true, "default": [])",
         about);
    std::array<bool, 6> listed{};
    const io::Json::List& all = list(key, false);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::string* name = all[k].string();
        const auto* at =
            name == nullptr ? side_names.end() : std::find(side_names.begin(), side_names.end(), *name);
        if (at == side_names.end() ||
            std::exchange(listed[static_cast<std::size_t>(at - side_names.begin())], true))
            fail(key, k,
                 std::string(key) + " must list some of -x, +x, -y, +y, -z, +z, each once, got " +
                     io::described(all[k]));
    }
    return listed;
}

namespace {

/// The values of a list of `count` (words: "3", "3 or 6") flags
std::vector<bool> flag_list(const ObjectReader& o, std::string_view key, const io::Json& v,
                            const std::string& count, bool is_count)
{
    if (!is_count)
        o.fail(key, std::string(key) + " must be a list of " + count + " values, each true or false, got " +
                        io::described(v));
    std::vector<bool> x;
    for (const io::Json& value : *v.list()) {
        if (value.boolean() == nullptr)
            o.fail(key, x.size(), std::string(key) + " must be true or false, got " + io::described(value));
        x.push_back(*value.boolean());
    }
    return x;
}

}  // namespace

std::array<bool, 3> ObjectReader::flags(std::string_view key, const io::About& about,
                                        const std::array<bool, 3>& fallback)
{
    const io::Json by_default = io::Json::List(fallback.begin(), fallback.end());
    note(key, R"("type": "array", "items": {"type": "boolean"}, "minItems": 3, "maxItems": 3)", about,
         &by_default);
    const io::Json* v = find(key);
    if (v == nullptr) return fallback;
    const auto x = flag_list(*this, key, *v, "3", v->list() != nullptr && v->size() == 3);
    return {x[0], x[1], x[2]};
}

std::array<bool, 6> ObjectReader::six_flags(std::string_view key, const io::About& about, bool others)
{
    const io::Json by_default = {true, true, true, others, others, others};
    note(key,
         R"("type": "array", "items": {"type": "boolean"}, )"
         R"("oneOf": [{"minItems": 3, "maxItems": 3}, {"minItems": 6, "maxItems": 6}])",
         about, &by_default);
    const io::Json* v = find(key);
    if (v == nullptr) return {true, true, true, others, others, others};
    const auto x =
        flag_list(*this, key, *v, "3 or 6", v->list() != nullptr && (v->size() == 3 || v->size() == 6));
    if (x.size() == 3) return {x[0], x[1], x[2], others, others, others};
    return {x[0], x[1], x[2], x[3], x[4], x[5]};
}

bool ObjectReader::has_formula(std::string_view key)
{
    const io::Json* v = find(key);
    return v != nullptr && v->list() != nullptr &&
           std::any_of(v->list()->begin(), v->list()->end(),
                       [](const io::Json& part) { return part.string() != nullptr; });
}

VectorFormula ObjectReader::formulas(std::string_view key)
{
    VectorFormula all;
    std::array<io::Expression, 3> parts = expressions(key);
    for (std::size_t k = 0; k < 3; ++k)
        all.of[k] = [e = std::move(parts[k])](double t) { return e.value(t); };
    return all;
}

std::string ObjectReader::file(std::string_view key, const io::About& about)
{
    namespace fs = std::filesystem;
    std::string path = text(key, about);
    if (!source.base.empty()) path = (fs::path(source.base) / path).string();
    source.files.push_back(path);
    require_within(key, path, "case");
    return path;
}

std::vector<ObjectReader> ObjectReader::objects(std::string_view key, std::string_view of,
                                                const io::About& about, bool required)
{
    note(key,
         R"("type": "array", "items": {"$ref": "#/$defs/)" + std::string(of) + R"("}, )" +
             (required ? R"("minItems": 1)" : R"("default": [])"),
         about);
    std::vector<ObjectReader> all;
    const std::size_t count = list(key, required && records_schema()).size();
    for (std::size_t k = 0; k < count; ++k) all.push_back(object(key, k));
    return all;
}

ObjectReader ObjectReader::object(std::string_view key, std::size_t element)
{
    return {source, list(key, true)[element], io::pointer_to(pointer(key), std::to_string(element))};
}

}  // namespace hilda::granular
