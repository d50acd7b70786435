// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the contact laws of a case file, and what the function read() of a law can read.

#pragma once

#include "granular/core/pair_law.hpp"
#include "granular/reading/object_reader.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>

namespace hilda::granular {

/// Keys that a law reads: those of its own object, and those of the entry of `laws` that contains it. The
/// texts and examples are for the schema.
class LawKeys {
public:
    LawKeys(ObjectReader& own, ObjectReader& pair, const Material& i, const Material& j, const PairLaw& law)
        : i(i), j(j), own(own), pair(pair), law(law)
    {}

    float positive(const char* key, const char* text, double example)
    {
        return static_cast<float>(own.positive(key, {text, io::shortest(example)}));
    }
    float not_negative(const char* key, double default_value, const char* text, double example)
    {
        return static_cast<float>(own.not_negative(key, {text, io::shortest(example)}, default_value));
    }
    /// A required coefficient; 0 switches the law off
    float coefficient(const char* key, const char* text, double example)
    {
        return static_cast<float>(own.not_negative(key, {text, io::shortest(example)}));
    }
    /// 0 if the key is absent. `other` is the name of the key with the value `least`.
    float at_least(const char* key, float least, const char* other, const char* text, double example)
    {
        const double x = own.optional_positive(key, {text, io::shortest(example)}).value_or(0);
        if (x > 0 && static_cast<float>(x) < least)
            own.fail(key, std::string(key) + " must not be less than " + other + ", " +
                              io::shortest(static_cast<double>(least)) + ", got " + io::shortest(x));
        return static_cast<float>(x);
    }
    /// Throws io::PlacedError with the place of the key, or of the law if the key is missing.
    void refuse(const char* key, const std::string& what)
    {
        if (!own.records_schema()) own.fail(key, what);
    }
    int flag(const char* key, const char* text) { return own.flag(key, {text, "true"}, false) ? 1 : 0; }
    double restitution()
    {
        constexpr double least = 1e-7;  // the damping contains ln e, which must be finite
        used.insert("restitution");
        return std::max(pair.fraction("restitution"), least);
    }
    /// The restitution if it is given. `other`: the key of the law that it replaces
    std::optional<double> restitution_instead_of(const char* other)
    {
        if (pair.records_schema() || !pair.has("restitution")) return {};
        if (own.has(other))
            own.fail(other, std::string(other) +
                                " and restitution exclude each other: restitution determines " + other +
                                ", got both");
        return restitution();
    }
    float static_friction()
    {
        used.insert("mu_s");
        return pair.has("mu_s") ? static_cast<float>(pair.not_negative("mu_s")) : kinetic_friction();
    }
    float kinetic_friction()
    {
        used.insert("mu");
        return static_cast<float>(pair.not_negative("mu"));
    }
    /// Whether the normal law computes its stiffness from the moduli of the materials; the tangential law
    /// then does so too
    bool material_normal() const
    {
        bool result = false;
        law.normal.visit([&]<class Law>(const Law&) { result = has_material_stiffness<Law>; });
        return result;
    }

    const Material &i, &j;
    std::set<std::string> used = {};  ///< keys of the entry of `laws` that the law has read

private:
    ObjectReader &own, &pair;
    const PairLaw& law;
};

/// Index of the material with this name. If there is none, calls `fail` with the message; it must throw.
int material_named(const std::string& name, const std::vector<Material>& materials,
                   const std::function<void(const std::string&)>& fail);

/// Indices of the two materials of a law, from the key `between`. Throws io::PlacedError.
std::array<int, 2> read_between(ObjectReader& pair, const std::vector<Material>& materials);

/// Reads the laws between the materials i and j. Throws io::PlacedError. A restitution of 0 is raised to
/// 1e-7, with a warning in `notices`.
PairLaw read_pair(ObjectReader& pair, const Material& i, const Material& j,
                  std::vector<std::string>& notices);

/// "Normal law", for the key "normal"
std::string title_of_kind(const std::string& kind);

/// Calls f(key of the case, name of the default law, member of PairLaw) for each kind of law. The normal law
/// is the first, because others depend on it.
template <class F>
void for_each_kind(const F& f)
{
    f("normal", "hertz", &PairLaw::normal);
    f("tangential", "none", &PairLaw::tangential);
    f("rolling", "none", &PairLaw::rolling);
    f("spin", "none", &PairLaw::spin);
    f("cohesion", "none", &PairLaw::cohesion);
}

}  // namespace hilda::granular
