// SPDX-License-Identifier: GPL-3.0-or-later
/// Typed access to the objects of a case file, with error messages that state the place of the entry.

#pragma once

#include "granular/case/motion.hpp"
#include "granular/core/material.hpp"
#include "io/error.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <set>

namespace hilda::granular {

/// One JSON object of a case. The accessors record the keys that they look up; end() rejects all others.
/// Accessors without a default value throw io::InvalidInput if the key is missing, and all throw io::InvalidInput if
/// the value is invalid.
class Keys {
public:
    using Json = nlohmann::ordered_json;

    /// `place` is the JSON pointer of the object. Throws io::InvalidInput if `object` is not a JSON object.
    Keys(const Json& object, std::string place);

    bool has(const std::string& key);
    double number(const std::string& key);
    double number(const std::string& key, double default_value);
    double positive(const std::string& key);
    double not_negative(const std::string& key, double default_value = 0);
    long count(const std::string& key, long default_value);
    bool flag(const std::string& key);  ///< false if the key is missing
    std::string text(const std::string& key);
    std::string text(const std::string& key, const std::string& default_value);
    std::array<double, 4> four(const std::string& key, const std::array<double, 4>& default_value);
    Vec3 vector(const std::string& key);
    Vec3 vector(const std::string& key, const Vec3& default_value);
    std::array<bool, 3> flags(const std::string& key, const std::array<bool, 3>& default_value);
    /// Whether the value is an array that contains a string, that is, a formula
    bool has_formula(const std::string& key);
    /// A vector of three components, each a number or a formula in t
    VectorFormula formulas(const std::string& key);
    Keys object(const std::string& key);
    /// Elements of an array with their JSON pointers; empty if the key is missing
    std::vector<std::pair<const Json*, std::string>> list(const std::string& key);
    const Json& raw(const std::string& key);

    /// Throws io::InvalidInput if the object has a key that was not looked up.
    void end() const;
    template <class Value>
    [[noreturn]] void refuse(const std::string& key, const std::string& rule, const Value& value) const
    {
        const Json& shown = value;
        throw io::InvalidInput(place_of(key) + ": " + rule + ", got " + shown.dump());
    }
    std::string place_of(const std::string& key) const { return key.empty() ? place : place + "/" + key; }

    const std::string place;

private:
    const Json& at(const std::string& key);
    const Json& numbers(const std::string& key, std::size_t count, const char* rule);

    const Json& of;
    std::set<std::string> known;
};

/// Keys that a law reads: those of its own object, and those of the entry of `laws` that contains it
class LawKeys {
public:
    LawKeys(Keys& own, Keys& pair, const Material& i, const Material& j, bool material_normal)
        : i(i), j(j), own(own), pair(pair), of_materials(material_normal)
    {}

    float positive(const std::string& key) { return static_cast<float>(own.positive(key)); }
    float not_negative(const std::string& key, float default_value = 0)
    {
        return static_cast<float>(own.not_negative(key, default_value));
    }
    int flag(const std::string& key) { return own.flag(key) ? 1 : 0; }
    double restitution();
    float static_friction();
    float kinetic_friction();
    /// Whether the normal law computes its stiffness from the moduli of the materials; the tangential law
    /// then does so too
    bool material_normal() const { return of_materials; }

    const Material &i, &j;

private:
    Keys &own, &pair;
    bool of_materials;
};

}  // namespace hilda::granular
