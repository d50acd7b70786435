// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the contacts of a model file. An element of "contacts" becomes a ContactForce or, if "normal" is
/// of type "constraint", an EvolvingContact.
///
///     {"name": "ball-floor", "body_i": "ball", "body_j": "ground",
///      "surface_i": {"type": "sphere", "radius": 0.2}, "surface_j": {"type": "plane"},
///      "normal": {"type": "hertz", "E_star": 1e6, "restitution": 0.5},
///      "friction": {"law": "slide-roll-spin", "mu_s": 0.3, "K_E": 1e5}}
///
///     "normal": {"type": "constraint", "unilateral": true, "restitution": 0.5, "impact": "newton",
///                "rows": "tangent", "fallback": {"type": "hooke", "stiffness": 1e5}},
///     "friction": {"law": "rolling"}
///
/// For a constraint, "friction" is ideal rolling, friction in the equations of the constraint ("implicit"),
/// or an EvolvingFriction with one of the registered laws. "fallback" adds a ContactForce with the same law,
/// which replaces the constraint while the contact point is not unique.
///
/// A key whose default depends on other keys enters the canonical text only if it is given.

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/friction.hpp"
#include "contact/surface_types.hpp"
#include "dae/model.hpp"
#include "dae/model_types.hpp"
#include "lie/settings.hpp"

namespace hilda::contact {

namespace {

using dae::ObjectReader;

constexpr const char *rolling = "rolling", *implicit = "implicit", *slide_roll_spin = "slide-roll-spin";

/// Names of the registered normal laws; of those that can be a fallback
std::vector<std::string> normal_laws(bool elastic)
{
    std::vector<std::string> names;
    for (const NormalLawType& law : io::Registry<NormalLawType>::all())
        if (law.elastic || !elastic) names.push_back(law.name);
    return names;
}

std::shared_ptr<const NormalLaw> read_normal(ObjectReader& o, const std::string& type)
{
    return io::Registry<NormalLawType>::find(type)->read(o);
}

/// Reads the coefficients of friction.
void read_coefficients(ObjectReader& o, double& mu_s, double& mu_k)
{
    mu_s = o.not_negative("mu_s");
    mu_k = o.not_negative("mu_k", mu_s);
    if (mu_k > mu_s)
        o.fail("mu_k",
               "mu_k must not be above mu_s, " + dae::shortest(mu_s) + ", got " + dae::shortest(mu_k));
}

/// Reads the keys of a friction law. `law` is its name, which has been read before.
std::shared_ptr<const FrictionModel> read_law(ObjectReader& o, const std::string& law,
                                              const NormalLaw& normal)
{
    const std::string preset = o.one_of("preset", {"balanced", "dissertation"}, "balanced");
    FrictionParameters p;
    if (preset == "dissertation") p = p.as_in_dissertation();

    read_coefficients(o, p.mu_s, p.mu_k);
    p.K_E = o.positive("K_E");
    p.zeta = o.not_negative("zeta", p.zeta);
    for (const auto& [key, D] :
         {std::pair("D_slide", &p.D_slide), std::pair("D_roll", &p.D_roll), std::pair("D_spin", &p.D_spin)})
        if (o.find(key) != nullptr) *D = o.not_negative(key);
    p.tracking.beta = o.number("beta", p.tracking.beta);
    const FrictionLaw& entry = friction_law(law);
    return entry.read != nullptr ? entry.read(o, p, normal) : entry.make(p);
}

std::shared_ptr<const FrictionModel> read_friction(ObjectReader& contact, const NormalLaw& normal)
{
    if (!contact.has("friction")) return frictionless();
    ObjectReader o = contact.object("friction");
    if (const dae::Json* law = o.find("law");
        law != nullptr && law->string() != nullptr && *law->string() == rolling)
        o.fail("law",
               "law \"rolling\" needs \"normal\": {\"type\": \"constraint\"}, got a compliant contact");
    const std::string law = o.one_of("law", io::Registry<FrictionLaw>::names(), slide_roll_spin);
    std::shared_ptr<const FrictionModel> model = read_law(o, law, normal);
    contact.record("friction", o.finish());
    return model;
}

/// Keys of "normal" of type "constraint"
struct ConstraintNormal {
    Unilateral unilateral;
    EvolvingContact::NormalRows rows = EvolvingContact::NormalRows::tangent;
    std::shared_ptr<const NormalLaw> fallback;  ///< nullptr if there is none
};

ConstraintNormal read_constraint_normal(ObjectReader& o, const dae::ContactPair& pair)
{
    ConstraintNormal settings;
    Unilateral& unilateral = settings.unilateral;
    unilateral.enabled = o.flag("unilateral", false);
    const auto is_unilateral_or_given = [&](const char* key) {
        const bool given = o.find(key) != nullptr;
        return unilateral.enabled || given;
    };
    if (is_unilateral_or_given("restitution")) unilateral.restitution = o.fraction("restitution", 0);
    if (!unilateral.enabled && o.has("restitution"))
        o.fail("restitution",
               "restitution needs \"unilateral\": true, got a bilateral contact with restitution " +
                   dae::shortest(unilateral.restitution));
    if (is_unilateral_or_given("impact") && o.one_of("impact", {"newton", "poisson"}, "newton") == "poisson")
        unilateral.impact = Unilateral::Impact::poisson;
    if (!unilateral.enabled && o.has("impact"))
        o.fail("impact", "impact needs \"unilateral\": true, got a bilateral contact");
    std::string rows = o.one_of("rows", {"tangent", "fixed-xy"}, "tangent");
    if (!pair.normal_rows.empty()) {
        rows = pair.normal_rows;
        o.record("rows", rows);
        const std::string change = o.pointer("rows") + '=' + rows;
        if (pair.changes.empty() || pair.changes.back() != change) pair.changes.push_back(change);
    }
    if (rows == "fixed-xy") settings.rows = EvolvingContact::NormalRows::fixed_xy;
    if (o.has("fallback")) {
        ObjectReader law = o.object("fallback");
        settings.fallback = read_normal(law, law.one_of("type", normal_laws(true)));
        o.record("fallback", law.finish());
    }
    return settings;
}

/// Keys of "friction" of a constraint contact. If no member is set there is no friction.
struct ConstraintFriction {
    bool ideal_rolling = false;
    std::shared_ptr<const FrictionModel> law;
    std::optional<ImplicitFriction> within_step;  ///< friction rows of the constraint
};

ImplicitFriction read_implicit(ObjectReader& o)
{
    ImplicitFriction f;
    read_coefficients(o, f.mu_s, f.mu_k);
    f.K_E = o.positive("K_E");
    f.K_D = o.not_negative("D_slide", 0);
    f.eta_r = o.not_negative("eta_r", 0);
    f.D_roll = o.not_negative("D_roll", 0);
    return f;
}

ConstraintFriction read_constraint_friction(ObjectReader& contact, const ConstraintNormal& normal)
{
    if (!contact.has("friction")) return {};
    ObjectReader o = contact.object("friction");
    std::vector<std::string> laws = io::Registry<FrictionLaw>::names();
    laws.insert(laws.begin(), {rolling, implicit});
    const std::string law = o.one_of("law", laws, slide_roll_spin);
    ConstraintFriction settings{.ideal_rolling = law == rolling, .law = nullptr, .within_step = {}};
    if ((settings.ideal_rolling || law == implicit) && normal.fallback != nullptr)
        o.fail("law",
               "a contact with a fallback needs a friction law that the fallback "
               "supports, such as slide-roll-spin; got \"" +
                   law + "\", which is defined for the constraint only");
    if (law == implicit)
        settings.within_step = read_implicit(o);
    else if (!settings.ideal_rolling)
        // A constraint has no elastic modulus for "spin": "hertz". The fallback uses the same law.
        settings.law = read_law(o, law, GivenForce(0));
    contact.record("friction", o.finish());
    return settings;
}

/// Rejects surfaces with an edge or a fixed contact point: an evolving contact point needs a smooth surface.
void check_smooth(const ObjectReader& o, std::string_view key, const Shape& shape)
{
    if (!shape.surface->is_smooth())
        o.fail(key,
               "a contact of type \"constraint\" needs a smooth surface, got a " + shape.surface->name());
}

void add_evolving(ObjectReader& o, ObjectReader normal, const dae::ContactPair& pair, const Shape& i,
                  const Shape& j)
{
    const ConstraintNormal settings = read_constraint_normal(normal, pair);
    o.record("normal", normal.finish());
    const ConstraintFriction friction = read_constraint_friction(o, settings);
    check_smooth(o, pair.surface_i, i);
    check_smooth(o, pair.surface_j, j);
    auto constraint =
        friction.within_step
            ? std::make_unique<EvolvingContact>(pair.i, i, pair.j, j, *friction.within_step, settings.rows,
                                                settings.unilateral)
            : std::make_unique<EvolvingContact>(pair.i, i, pair.j, j,
                                                friction.ideal_rolling ? EvolvingContact::Friction::rolling
                                                                       : EvolvingContact::Friction::none,
                                                settings.rows, settings.unilateral);
    const EvolvingContact& contact = *constraint;
    constraint->fallback = settings.fallback != nullptr;
    pair.model.constrain(pair.name, std::move(constraint));
    if (friction.law != nullptr)
        pair.model.load(std::make_unique<EvolvingFriction>(pair.model, contact, friction.law));
    if (settings.fallback == nullptr) return;
    auto force =
        std::make_unique<ContactForce>(pair.name, pair.model, pair.i, i, pair.j, j, settings.fallback,
                                       friction.law != nullptr ? friction.law : frictionless());
    force->set_fallback_of(contact);
    pair.model.load(std::move(force));
}

/// The surfaces of a contact. All pairs of a group share them, so that a mesh is read once.
struct Surfaces {
    Shape i, j;
    io::Json text_i, text_j;  ///< canonical form

    Surfaces(ObjectReader& o, const dae::ContactPair& pair)
    {
        i = read_shape(o, pair.surface_i, text_i);
        j = pair.surface_j == pair.surface_i ? i : read_shape(o, pair.surface_j, text_j);
        if (pair.surface_j == pair.surface_i) text_j = text_i;
    }
};

void read_contact(ObjectReader& o, const dae::ContactPair& pair)
{
    if (pair.shared == nullptr) pair.shared = std::make_shared<const Surfaces>(o, pair);
    const Surfaces& surfaces = *static_cast<const Surfaces*>(pair.shared.get());
    for (const std::string& key : {pair.surface_i, pair.surface_j}) o.find(key);
    o.record("surface_i", surfaces.text_i);
    o.record("surface_j", surfaces.text_j);
    const Shape &i = surfaces.i, &j = surfaces.j;
    ObjectReader normal = o.object("normal");
    std::vector<std::string> types = normal_laws(false);
    types.emplace_back("constraint");
    const std::string type = normal.one_of("type", types);
    if (type == "constraint") return add_evolving(o, std::move(normal), pair, i, j);
    const std::shared_ptr<const NormalLaw> law = read_normal(normal, type);
    o.record("normal", normal.finish());
    pair.model.load(std::make_unique<ContactForce>(pair.name, pair.model, pair.i, i, pair.j, j, law,
                                                   read_friction(o, *law)));
}

const bool registered_model_contacts = dae::register_contact_reader(read_contact);

}  // namespace

}  // namespace hilda::contact
