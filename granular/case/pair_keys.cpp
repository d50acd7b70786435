// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/pair_keys.hpp"

#include "io/nearest.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>

namespace hilda::granular {

namespace {

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

/// Notes the keys of an entry of `laws` that several laws read.
void note_coefficients(ObjectReader& pair)
{
    pair.note("restitution", "fraction",
              {"Coefficient of restitution e [-]. Required with the normal law hertz, and if the tangential "
               "law has a spring whose stiffness is that of the materials, with hunt-crossley and "
               "kuwabara-kono. With hooke it may replace gamma_n, with walton-braun k_2. It is refused where "
               "no law uses it. 0 is treated as 1e-7, with a notice.",
               "0.7"});
    pair.note("mu", "not_negative",
              {"Kinetic coefficient of friction [-]. Required if the tangential law is not none or the spin "
               "law is torsional-spring, and refused otherwise.",
               "0.3"});
    pair.note("mu_s", "not_negative",
              {"Static coefficient of friction [-] of the tangential laws mindlin and mindlin-incremental. "
               "It must not be "
               "less than mu. By default equal to mu.",
               "0.4"});
}

/// Notes the key of the law of this kind.
void note_kind(ObjectReader& pair, const std::string& kind, const std::string& standard)
{
    static const std::map<std::string, const char*> examples = {
        {"normal", R"({"law": "hertz"})"},
        {"tangential", R"({"law": "mindlin"})"},
        {"rolling", R"({"law": "epsd", "mu_r": 0.05})"},
        {"spin", R"({"law": "torsional-spring"})"},
        {"cohesion", R"({"law": "sjkr", "k": 1000})"}};
    if (!pair.records_schema()) return;
    const std::string schema =
        R"("$ref": "#/$defs/)" + kind + R"(_law", "default": {"law": )" + io::in_quotes(standard) + '}';
    pair.note(kind, schema, {title_of_kind(kind) + '.', examples.at(kind)});
}

/// Throws io::PlacedError for a coefficient that none of the laws reads.
[[noreturn]] void refuse_without_effect(ObjectReader& pair, const std::string& key, const PairLaw& law)
{
    pair.finish();  // a misspelt key may be the cause
    const auto name_of = [](const auto& laws) {
        std::string name;
        laws.visit([&](const auto& l) { name = l.name; });
        return name;
    };
    pair.fail(key, key + " has no effect with the normal law " + name_of(law.normal) +
                       " and the tangential law " + name_of(law.tangential) + ", got " +
                       io::described(*pair.peek(key)) + "; remove it or choose a law that uses it");
}

}  // namespace

std::string title_of_kind(const std::string& kind)
{
    std::string title = kind + " law";
    title[0] = static_cast<char>(std::toupper(title[0]));
    return title;
}

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
    pair.defines(
        "law", "Contact law",
        "Contact law between two materials: one law for each of the normal force, the tangential force, "
        "rolling, spin and cohesion. E* and G* are the effective moduli of the two materials, R* the "
        "effective radius, m* the effective mass, delta the overlap, F_n the normal force.");
    pair.note("between", R"("type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2)",
              {"Names of the two materials. It may be omitted if there is only one material.",
               R"(["glass", "steel"])"});
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
    note_coefficients(pair);
    if (pair.has("restitution") && pair.fraction("restitution") == 0)
        notices.push_back(pair.place("restitution") +
                          ": 0 is replaced by 1e-7, because the damping of 0 is infinite");
    for (const char* key : {"restitution", "mu", "mu_s"}) pair.find(key);  // known even if no law reads them
    std::set<std::string> used;
    PairLaw law;
    const std::string lever =
        pair.one_of("lever", {"radius", "contact"},
                    {"Lever arms of the tangential force: radius, the radii of the two bodies; contact, the "
                     "distances of the centres from a point within the overlap, R - delta/2 between "
                     "particles of equal radii and against a boundary.",
                     R"("contact")"},
                    "radius");
    if (lever == "contact") law.lever = Lever::contact;
    for_each_kind([&]<class Laws>(const char* kind, const char* standard, Laws PairLaw::*member) {
        static const io::JsonSource none("{}", "");
        note_kind(pair, kind, standard);
        ObjectReader own =
            pair.find(kind) != nullptr ? pair.object(kind, {}, kind) : ObjectReader(none, none.root, "");
        std::vector<std::string> names;
        Laws::for_each([&](const auto& known) { names.emplace_back(known.name); });
        LawKeys keys(own, pair, i, j, law);
        (law.*member).read(own.one_of("law", names, {}, standard), keys);
        own.finish();
        used.merge(keys.used);
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
    if (lever == "contact" && !spring)
        pair.fail("lever", "lever has no effect without a tangential law, got \"contact\"");
    const double mu = pair.not_negative("mu", {}, 0), mu_s = pair.not_negative("mu_s", {}, mu);
    if (mu_s < mu)
        pair.fail("mu_s",
                  "mu_s must not be less than mu, " + io::shortest(mu) + ", got " + io::shortest(mu_s));
    for (const char* key : {"restitution", "mu", "mu_s"})
        if (pair.has(key) && !used.contains(key)) refuse_without_effect(pair, key, law);
    return law;
}

}  // namespace hilda::granular
