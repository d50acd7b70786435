// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/pair_keys.hpp"

#include "io/nearest.hpp"

#include <algorithm>
#include <limits>

namespace hilda::granular {

namespace {

/// Keys that a law reads: those of its own object, and those of the entry of `laws` that contains it. The
/// texts and examples are for the schema.
class LawKeys {
public:
    LawKeys(ObjectReader& own, ObjectReader& pair, const Material& i, const Material& j, const PairLaw& law)
        : i(i), j(j), own(own), pair(pair), law(law)
    {}

    float positive(const char* key, const char*, double) { return static_cast<float>(own.positive(key)); }
    float not_negative(const char* key, double default_value, const char*, double)
    {
        return static_cast<float>(own.not_negative(key, {}, default_value));
    }
    /// 0 if the key is absent. `other` is the name of the key with the value `least`.
    float at_least(const char* key, float least, const char* other, const char*, double)
    {
        if (!own.has(key)) return 0;
        const double x = own.positive(key);
        if (static_cast<float>(x) < least)
            own.fail(key, std::string(key) + " must not be less than " + other + ", " +
                              io::shortest(static_cast<double>(least)) + ", got " + io::shortest(x));
        return static_cast<float>(x);
    }
    int flag(const char* key, const char*) { return own.flag(key, {}, false) ? 1 : 0; }
    double restitution()
    {
        constexpr double least = 1e-7;  // the damping contains ln e, which must be finite
        return std::max(pair.fraction("restitution"), least);
    }
    float static_friction()
    {
        return pair.has("mu_s") ? static_cast<float>(pair.not_negative("mu_s")) : kinetic_friction();
    }
    float kinetic_friction() { return static_cast<float>(pair.not_negative("mu")); }
    /// Whether the normal law computes its stiffness from the moduli of the materials; the tangential law
    /// then does so too
    bool material_normal() const
    {
        bool result = false;
        law.normal.visit([&]<class Law>(const Law&) { result = has_material_stiffness<Law>; });
        return result;
    }

    const Material &i, &j;

private:
    ObjectReader &own, &pair;
    const PairLaw& law;
};

/// Checks that the stiffnesses that are computed from several keys are in the range of single precision.
void check_stiffness(ObjectReader& pair, const Material& i, const Material& j, const PairLaw& law)
{
    constexpr double most = std::numeric_limits<float>::max();
    const auto refuse = [&](const std::string& what, double value) {
        if (!(value <= most))
            pair.fail(what + " must be at most " + io::shortest(most) + ", got " + io::shortest(value));
    };
    law.normal.visit([&]<class Law>(const Law& l) {
        if constexpr (has_material_stiffness<Law>) {
            const std::string of = " of " + io::described(i.name) + " and " + io::described(j.name);
            refuse("the effective modulus E*" + of, effective_modulus(i, j));
            refuse("the stiffness 8 G*" + of, 8 * effective_shear_modulus(i, j));
        }
        if constexpr (requires { l.k_1, l.k_2; })
            refuse("the stiffness k_2, which is k_1/e^2 if it is not given,", static_cast<double>(l.k_2));
    });
}

}  // namespace

int material_named(const std::string& name, const std::vector<Material>& materials,
                   const std::function<void(const std::string&)>& fail)
{
    std::vector<std::string> known;
    for (const Material& m : materials) known.push_back(m.name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
        fail("no material has this name, got " + io::described(name) + io::did_you_mean(name, known));
    return static_cast<int>(found - known.begin());
}

std::array<int, 2> read_between(ObjectReader& pair, const std::vector<Material>& materials)
{
    std::array<int, 2> ij = {0, 0};
    if (materials.size() == 1 && pair.find("between") == nullptr) return ij;
    const io::Json::List& names = pair.list("between", true);
    if (names.size() != 2)
        pair.fail("between", "between must be two names of materials, got " + io::described(names));
    for (std::size_t k = 0; k < 2; ++k) {
        if (names[k].string() == nullptr)
            pair.fail("between", k, "between must be two names of materials, got " + io::described(names[k]));
        ij[k] = material_named(*names[k].string(), materials,
                               [&](const std::string& what) { pair.fail("between", k, what); });
    }
    return ij;
}

PairLaw read_pair(ObjectReader& pair, const Material& i, const Material& j, std::vector<std::string>& notices)
{
    if (pair.has("restitution") && pair.fraction("restitution") == 0)
        notices.push_back(pair.place("restitution") +
                          ": 0 is replaced by 1e-7, because the damping of 0 is infinite");
    for (const char* key : {"restitution", "mu", "mu_s"}) pair.find(key);  // known even if no law reads them
    PairLaw law;
    if (pair.one_of("lever", {"radius", "contact"}, {}, "radius") == "contact") law.lever = Lever::contact;
    for_each_kind([&]<class Laws>(const char* kind, const char* standard, Laws PairLaw::*member) {
        static const io::JsonSource none("{}", "");
        ObjectReader own = pair.find(kind) != nullptr ? pair.object(kind) : ObjectReader(none, none.root, "");
        std::vector<std::string> names;
        Laws::for_each([&](const auto& known) { names.emplace_back(known.name); });
        LawKeys keys(own, pair, i, j, law);
        (law.*member).read(own.one_of("law", names, {}, standard), keys);
        own.finish();
    });
    check_stiffness(pair, i, j, law);
    const bool spring = !law.tangential.is<NoFriction>();
    const bool has_rotational_spring =
        !(law.rolling.is<NoRolling>() || law.rolling.is<ConstantTorque>()) || !law.spin.is<NoSpin>();
    if (has_rotational_spring && !spring)
        pair.fail(
            "tangential",
            "the tangential law must not be none with this rolling or spin law, whose stiffness is that of "
            "the tangential law");
    // Checked even if no law reads them.
    const double mu = pair.not_negative("mu", {}, 0), mu_s = pair.not_negative("mu_s", {}, mu);
    if (mu_s < mu)
        pair.fail("mu_s",
                  "mu_s must not be less than mu, " + io::shortest(mu) + ", got " + io::shortest(mu_s));
    return law;
}

}  // namespace hilda::granular
