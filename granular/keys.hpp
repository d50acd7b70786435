// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads the objects of a case file, and says of what is wrong where it stands.

#pragma once

#include "granular/case/motion.hpp"
#include "granular/core/material.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <set>

namespace hilda::granular {

/// One object of a case. Every key must be asked for before end(): one that nobody knows is an error.
class Keys {
public:
    using Json = nlohmann::ordered_json;

    /// `place` is the JSON pointer of the object. InvalidCase where it is none.
    Keys(const Json& object, std::string place);

    bool has(const std::string& key);
    double number(const std::string& key);
    double number(const std::string& key, double otherwise);
    double positive(const std::string& key);
    double not_negative(const std::string& key, double otherwise = 0);
    long count(const std::string& key, long otherwise);
    bool flag(const std::string& key);  ///< false where it is not there
    std::string text(const std::string& key);
    std::string text(const std::string& key, const std::string& otherwise);
    std::array<double, 4> four(const std::string& key, const std::array<double, 4>& otherwise);
    Vec3 vector(const std::string& key);
    Vec3 vector(const std::string& key, const Vec3& otherwise);
    std::array<bool, 3> flags(const std::string& key, const std::array<bool, 3>& otherwise);
    /// Whether one of three components is a text, and so a formula
    bool has_formula(const std::string& key);
    /// Three numbers or formulas
    VectorFormula formulas(const std::string& key, const Compile& compile);
    Keys object(const std::string& key);
    /// The members of an array, none where it is not there
    std::vector<std::pair<const Json*, std::string>> list(const std::string& key);
    const Json& raw(const std::string& key);

    /// InvalidCase for a key that was not asked for
    void end() const;
    template <class Value>
    [[noreturn]] void refuse(const std::string& key, const std::string& rule, const Value& value) const
    {
        const Json& shown = value;
        throw InvalidCase(place_of(key) + ": " + rule + ", got " + shown.dump());
    }
    std::string place_of(const std::string& key) const { return key.empty() ? place : place + "/" + key; }

    const std::string place;

private:
    const Json& at(const std::string& key);
    const Json& numbers(const std::string& key, std::size_t count, const char* rule);

    const Json& of;
    std::set<std::string> known;
};

/// What a law reads: its own keys, and what the two materials have between them
class LawKeys {
public:
    LawKeys(Keys& own, Keys& pair, const Material& i, const Material& j, bool material_normal)
        : i(i), j(j), own(own), pair(pair), of_materials(material_normal)
    {}

    float positive(const std::string& key) { return static_cast<float>(own.positive(key)); }
    float not_negative(const std::string& key, float otherwise = 0)
    {
        return static_cast<float>(own.not_negative(key, otherwise));
    }
    int flag(const std::string& key) { return own.flag(key) ? 1 : 0; }
    double restitution();
    float static_friction();
    float kinetic_friction();
    /// Whether the normal law goes by the moduli of the materials, and the spring across it does so too
    bool material_normal() const { return of_materials; }

    const Material &i, &j;

private:
    Keys &own, &pair;
    bool of_materials;
};

}  // namespace hilda::granular
