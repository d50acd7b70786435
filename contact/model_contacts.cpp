// SPDX-License-Identifier: GPL-3.0-or-later
/// The contacts of a model file: an element of "contacts" becomes a ContactForce.
///
///     {"name": "ball-floor", "body_i": "ball", "body_j": "ground",
///      "surface_i": {"type": "sphere", "radius": 0.2}, "surface_j": {"type": "plane"},
///      "normal": {"type": "hertz", "E_star": 1e6, "restitution": 0.5},
///      "friction": {"law": "slide-roll-spin", "mu_s": 0.3, "K_E": 1e5}}
///
/// Only what is given enters the canonical text where a default depends on other keys.

#include "contact/contact_force.hpp"
#include "contact/surface_types.hpp"
#include "dae/model_file_types.hpp"

namespace hilda::contact {

namespace {

using dae::ObjectReader;

double from_zero_to_one(ObjectReader& o, std::string_view key, double fallback)
{
    const double x = o.number(key, fallback);
    if (!(x >= 0 && x <= 1)) o.fail(key, std::string(key) + " must be from 0 to 1, got " + dae::shortest(x));
    return x;
}

double poisson_ratio(ObjectReader& o, std::string_view key)
{
    const double nu = o.number(key);
    if (!(nu > -1 && nu <= 0.5))
        o.fail(key, std::string(key) + " must be above -1 and at most 0.5, got " + dae::shortest(nu));
    return nu;
}

std::shared_ptr<const NormalLaw> read_hertz(ObjectReader& o)
{
    for (const char* key : {"E_i", "nu_i", "E_j", "nu_j"}) o.exclude("E_star", key);
    double E_star = 0;
    if (o.has("E_i") || o.has("E_j")) {
        const double E_i = o.positive("E_i"), nu_i = poisson_ratio(o, "nu_i");
        const double E_j = o.positive("E_j"), nu_j = poisson_ratio(o, "nu_j");
        E_star = effective_modulus(E_i, nu_i, E_j, nu_j);
    } else {
        E_star = o.positive("E_star");
    }
    return std::make_shared<Hertz>(E_star, from_zero_to_one(o, "restitution", 1));
}

std::shared_ptr<const NormalLaw> read_hooke(ObjectReader& o)
{
    o.exclude("damping", "restitution");
    const double stiffness = o.positive("stiffness");
    if (o.has("restitution"))
        return std::make_shared<Hooke>(Hooke::rebounding(stiffness, from_zero_to_one(o, "restitution", 1)));
    return std::make_shared<Hooke>(stiffness, o.not_negative("damping", 0));
}

std::shared_ptr<const NormalLaw> read_normal(ObjectReader& contact)
{
    ObjectReader o = contact.object("normal");
    const std::string type = o.one_of("type", {"hertz", "hooke", "given"});
    std::shared_ptr<const NormalLaw> law;
    if (type == "hertz") law = read_hertz(o);
    if (type == "hooke") law = read_hooke(o);
    if (type == "given") law = std::make_shared<GivenForce>(o.not_negative("force"));
    contact.keep("normal", o.finish());
    return law;
}

std::shared_ptr<const FrictionModel> read_friction(ObjectReader& contact, const NormalLaw& normal)
{
    if (!contact.has("friction")) return frictionless();
    ObjectReader o = contact.object("friction");
    std::vector<std::string> laws;
    for (const FrictionLaw& law : friction_laws()) laws.push_back(law.name);
    const std::string law = o.one_of("law", laws, "slide-roll-spin");
    const std::string preset = o.one_of("preset", {"balanced", "dissertation"}, "balanced");
    FrictionParameters p;
    if (preset == "dissertation") p = p.as_in_dissertation();

    p.mu_s = o.not_negative("mu_s");
    p.mu_k = o.not_negative("mu_k", p.mu_s);
    if (p.mu_k > p.mu_s)
        o.fail("mu_k",
               "mu_k must not be above mu_s, " + dae::shortest(p.mu_s) + ", got " + dae::shortest(p.mu_k));
    p.K_E = o.positive("K_E");
    p.zeta = o.not_negative("zeta", p.zeta);
    for (const auto& [key, D] :
         {std::pair("D_slide", &p.D_slide), std::pair("D_roll", &p.D_roll), std::pair("D_spin", &p.D_spin)})
        if (o.look(key) != nullptr) *D = o.not_negative(key);
    p.tracking.beta = o.number("beta", p.tracking.beta);
    const FrictionLaw& kind = friction_law(law);
    std::shared_ptr<const FrictionModel> model =
        kind.read != nullptr ? kind.read(o, p, normal) : kind.make(p);
    contact.keep("friction", o.finish());
    return model;
}

std::unique_ptr<dae::Force> read_contact(ObjectReader& o, const dae::ContactPair& pair)
{
    const Shape i = read_shape(o, "surface_i"), j = read_shape(o, "surface_j");
    const std::shared_ptr<const NormalLaw> law = read_normal(o);
    return std::make_unique<ContactForce>(pair.name, pair.model, pair.i, i, pair.j, j, law,
                                          read_friction(o, *law));
}

const bool enrolled = dae::enrol_contacts(read_contact);

}  // namespace

}  // namespace hilda::contact
