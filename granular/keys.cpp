// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/keys.hpp"

#include "io/error.hpp"
#include "io/expression.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

Keys::Keys(const Json& object, std::string place) : place(std::move(place)), of(object)
{
    if (!of.is_object())
        throw io::InvalidInput(this->place + ": must be an object, got " + of.dump().substr(0, 60));
}

bool Keys::has(const std::string& key)
{
    known.insert(key);
    return of.contains(key);
}

const Keys::Json& Keys::at(const std::string& key)
{
    if (!has(key)) throw io::InvalidInput(place_of(key) + ": is missing");
    return of.at(key);
}

const Keys::Json& Keys::raw(const std::string& key) { return at(key); }

double Keys::number(const std::string& key)
{
    const Json& value = at(key);
    if (!value.is_number() || !std::isfinite(value.get<double>()))
        refuse(key, "must be a finite number", value);
    return value.get<double>();
}

double Keys::number(const std::string& key, double default_value)
{
    return has(key) ? number(key) : default_value;
}

double Keys::positive(const std::string& key)
{
    const double value = number(key);
    if (!(value > 0)) refuse(key, "must be positive", value);
    return value;
}

double Keys::not_negative(const std::string& key, double default_value)
{
    const double value = number(key, default_value);
    if (!(value >= 0)) refuse(key, "must not be negative", value);
    return value;
}

long Keys::count(const std::string& key, long default_value)
{
    if (!has(key)) return default_value;
    const Json& value = at(key);
    if (!value.is_number_integer() || value.get<long>() < 0)
        refuse(key, "must be a whole number and not negative", value);
    return value.get<long>();
}

bool Keys::flag(const std::string& key)
{
    if (!has(key)) return false;
    const Json& value = at(key);
    if (!value.is_boolean()) refuse(key, "must be true or false", value);
    return value.get<bool>();
}

std::string Keys::text(const std::string& key)
{
    const Json& value = at(key);
    if (!value.is_string()) refuse(key, "must be a string", value);
    return value.get<std::string>();
}

std::string Keys::text(const std::string& key, const std::string& default_value)
{
    return has(key) ? text(key) : default_value;
}

const Keys::Json& Keys::numbers(const std::string& key, std::size_t count, const char* rule)
{
    const Json& value = at(key);
    if (!value.is_array() || value.size() != count) refuse(key, rule, value);
    for (std::size_t k = 0; k < count; ++k)
        if (!value[k].is_number() || !std::isfinite(value[k].get<double>()))
            refuse(key + "/" + std::to_string(k), "must be a finite number", value[k]);
    return value;
}

std::array<double, 4> Keys::four(const std::string& key, const std::array<double, 4>& default_value)
{
    return has(key) ? numbers(key, 4, "must be four numbers").get<std::array<double, 4>>() : default_value;
}

Vec3 Keys::vector(const std::string& key)
{
    const Json& value = numbers(key, 3, "must be three numbers");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Vec3 Keys::vector(const std::string& key, const Vec3& default_value)
{
    return has(key) ? vector(key) : default_value;
}

std::array<bool, 3> Keys::flags(const std::string& key, const std::array<bool, 3>& default_value)
{
    if (!has(key)) return default_value;
    const Json& value = at(key);
    if (!value.is_array() || value.size() != 3)
        refuse(key, "must be three values, each true or false", value);
    for (int k = 0; k < 3; ++k)
        if (!value[k].is_boolean()) refuse(key + "/" + std::to_string(k), "must be true or false", value[k]);
    return {value[0].get<bool>(), value[1].get<bool>(), value[2].get<bool>()};
}

bool Keys::has_formula(const std::string& key)
{
    if (!has(key) || !at(key).is_array()) return false;
    return std::any_of(at(key).begin(), at(key).end(), [](const Json& part) { return part.is_string(); });
}

VectorFormula Keys::formulas(const std::string& key)
{
    const Json& value = at(key);
    if (!value.is_array() || value.size() != 3) refuse(key, "must be three numbers or formulas", value);
    VectorFormula all;
    for (int k = 0; k < 3; ++k) {
        const std::string part = key + "/" + std::to_string(k);
        if (value[k].is_number() && std::isfinite(value[k].get<double>())) {
            all.of[k] = [c = value[k].get<double>()](double) { return c; };
            continue;
        }
        if (!value[k].is_string()) refuse(part, "must be a finite number or a formula", value[k]);
        try {
            all.of[k] = [e = io::Expression(value[k].get<std::string>())](double t) { return e.value(t); };
        } catch (const io::ExpressionError& e) {
            throw io::InvalidInput(place_of(part) + ": " + e.what());
        }
    }
    return all;
}

Keys Keys::object(const std::string& key) { return {at(key), place_of(key)}; }

std::vector<std::pair<const Keys::Json*, std::string>> Keys::list(const std::string& key)
{
    std::vector<std::pair<const Json*, std::string>> all;
    if (!has(key)) return all;
    const Json& value = at(key);
    if (!value.is_array()) refuse(key, "must be a list", value);
    for (std::size_t k = 0; k < value.size(); ++k)
        all.emplace_back(&value[k], place_of(key) + "/" + std::to_string(k));
    return all;
}

void Keys::end() const
{
    for (const auto& [key, value] : of.items())
        if (!known.contains(key)) {
            std::string names;
            for (const std::string& k : known) names += (names.empty() ? "" : ", ") + k;
            throw io::InvalidInput(place_of(key) + ": unknown key; valid keys are " + names);
        }
}

double LawKeys::restitution()
{
    constexpr double least = 1e-7;  // the damping contains ln e, which must be finite
    const double e = pair.number("restitution");
    if (!(e >= 0 && e <= 1)) pair.refuse("restitution", "must be in [0, 1]", e);
    return std::max(e, least);
}

float LawKeys::static_friction()
{
    return pair.has("mu_s") ? static_cast<float>(pair.not_negative("mu_s")) : kinetic_friction();
}

float LawKeys::kinetic_friction()
{
    pair.number("mu");  // mu is required: it has no default value
    return static_cast<float>(pair.not_negative("mu"));
}

}  // namespace hilda::granular
