// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the contacts of a model file. An element of "contacts" becomes a ContactForce or ManifoldForce
/// or, if "normal" is of type "constraint", an EvolvingContact, or if it is of type "dvi", RigidContacts.
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
#include "contact/compliant/contact_group.hpp"
#include "contact/contact_list.hpp"
#include "contact/contact_types.hpp"
#include "contact/evolving/friction.hpp"
#include "contact/rigid/rigid_contacts.hpp"
#include "contact/surface_types.hpp"
#include "contact/surfaces/polytope.hpp"
#include "dae/model.hpp"
#include "dae/model_schema.hpp"
#include "dae/model_types.hpp"
#include "io/schema/schema_recorder.hpp"
#include "lie/settings.hpp"

namespace hilda::contact {

namespace {

using dae::ObjectReader;

const io::About about_friction = {"Friction law. Without it the contact is frictionless.",
                                  R"({"mu_s": 0.5, "mu_k": 0.4, "K_E": 10000})"};
constexpr const char *rolling = "rolling", *implicit = "implicit", *slide_roll_spin = "slide-roll-spin",
                     *coulomb = "coulomb";

const io::TypeSchema rolling_schema = {
    .description =
        "Ideal rolling: the material points in contact have equal velocities. This is a nonholonomic "
        "constraint without a Coulomb bound. It requires the normal law constraint without a fallback.",
    .examples = {}};

const io::TypeSchema implicit_schema = {
    .description =
        "Springs and dampers of sliding and rolling that are solved together with the step, so that no "
        "stiffness limits the step size. It requires the normal law constraint without a fallback.",
    .examples = {}};

const io::TypeSchema coulomb_schema = {
    .description = "Coulomb's law of dry friction, without a spring. It requires the normal law dvi.",
    .examples = {R"("mu_s": 0.5, "mu_k": 0.4)"}};

const io::TypeSchema rigid_schema = {
    .description =
        "Rigid bodies: there is no overlap and no stiffness, and a pair may have several contact points, as "
        "a box on a floor. Contact and friction are complementarity conditions that are solved in each step "
        "(differential variational inequality); impacts follow Newton's law. The friction law is coulomb. "
        "The command hilda integrators lists the integrators that support it.",
    .examples = {R"("restitution": 0.5)"}};

const io::TypeSchema constraint_schema = {
    .description =
        "The contact is a constraint whose algebraic unknowns are the contact points (Fang 2022, Ch. 5). "
        "There is no overlap and no stiffness. The normal force is the Lagrange multiplier. Both surfaces "
        "must be smooth: disk and foot are not allowed. The command hilda integrators lists the integrators "
        "that support it.",
    .examples = {},
    .rest = R"("dependentSchemas": {"restitution": {"required": ["unilateral"], "properties": )"
            R"({"unilateral": {"const": true}}}, "impact": {"required": ["unilateral"], "properties": )"
            R"({"unilateral": {"const": true}}}})"};

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
    const NormalLawType& law = *io::Registry<NormalLawType>::find(type);
    io::defines_type(o, normal_kind, law.name, law.name, law.schema);
    return law.read(o);
}

/// Reads the coefficients of friction.
void read_coefficients(ObjectReader& o, double& mu_s, double& mu_k)
{
    mu_s = o.not_negative("mu_s", {"Static coefficient of friction [-].", "0.5"});
    mu_k = o.not_negative(
        "mu_k",
        {.text = "Kinetic coefficient of friction [-]. It must not exceed mu_s. By default equal to mu_s.",
         .example = "0.4",
         .computed = true},
        mu_s);
    if (mu_k > mu_s)
        o.fail("mu_k",
               "mu_k must not be above mu_s, " + dae::shortest(mu_s) + ", got " + dae::shortest(mu_k));
}

/// Reads a damping coefficient if the key is given.
void read_damping(ObjectReader& o, const char* key, std::optional<double>& D, const io::About& about)
{
    if (o.given(key)) D = o.not_negative(key, about);
}

double read_zeta(ObjectReader& o)
{
    return o.not_negative("zeta",
                          {"Damping ratio of the friction springs [-]: D = 2 zeta sqrt(m K), with the "
                           "effective mass or moment of inertia m of the pair and the stiffness K of the "
                           "spring.",
                           "0.5"},
                          1);
}

io::About about_D_slide()
{
    return {"Damping coefficient of sliding friction [N s/m]. It replaces the value computed from zeta.",
            "100"};
}

/// Reads whether the springs hold bodies at rest from the start.
bool read_static_start(ObjectReader& o, bool usual)
{
    const io::About about = {
        .text =
            "Springs of friction at the start of a run. static: where the bodies are at rest relative to "
            "each other they are stretched such that they hold them. unstretched: their deflections are "
            "zero, and the static load acts on them as a jump. By default static, and unstretched with "
            "the preset dissertation.",
        .example = R"("unstretched")",
        .computed = true};
    return o.one_of("start", {"static", "unstretched"}, about, usual ? "static" : "unstretched") == "static";
}

/// Reads the keys that all friction laws have.
FrictionParameters read_parameters(ObjectReader& o)
{
    const io::About about_preset = {
        "Variant of the law. balanced: opposite rolling torques on the two bodies, which conserve angular "
        "momentum, forces bounded by the Coulomb limit, and the reduced mass in the damping. dissertation: "
        "the law as printed in Fang (2022), Ch. 4.",
        R"("dissertation")"};
    const std::string preset = o.one_of("preset", {"balanced", "dissertation"}, about_preset, "balanced");
    FrictionParameters p;
    if (preset == "dissertation") p = p.as_in_dissertation();

    read_coefficients(o, p.mu_s, p.mu_k);
    p.K_E = o.positive("K_E", {"Tangential stiffness K_E of sliding friction [N/m].", "10000"});
    p.zeta = read_zeta(o);
    read_damping(o, "D_slide", p.D_slide, about_D_slide());
    read_damping(o, "D_roll", p.D_roll,
                 {"Damping coefficient of rolling friction [N m s/rad]. It replaces the value computed from "
                  "zeta. Laws without a rolling spring ignore it.",
                  "0.01"});
    read_damping(o, "D_spin", p.D_spin,
                 {"Damping coefficient of spinning friction [N m s/rad]. It replaces the value computed from "
                  "zeta. Laws without a spinning spring ignore it.",
                  "0.01"});
    p.static_start = read_static_start(o, p.static_start);
    p.tracking.beta = o.number(
        "beta",
        {.text =
             "Fraction of the relative spin by which the tracked displacement of the contact point is "
             "rotated back [-]. By default 0.5 with the preset balanced and 1 with the preset dissertation.",
         .example = "0.5",
         .computed = true},
        p.tracking.beta);
    return p;
}

std::shared_ptr<const FrictionModel> read_keys(ObjectReader& o, const FrictionLaw& entry,
                                               const NormalLaw& normal)
{
    const FrictionParameters p = read_parameters(o);
    return entry.read != nullptr ? entry.read(o, p, normal) : entry.make(p);
}

/// Reads the keys of a friction law. `law` is its name, which has been read before.
std::shared_ptr<const FrictionModel> read_law(ObjectReader& o, const std::string& law,
                                              const NormalLaw& normal)
{
    const FrictionLaw& entry = friction_law(law);
    io::defines_type(o, friction_kind, entry.name, entry.name, entry.schema);
    return read_keys(o, entry, normal);
}

/// Records the keys of the registered normal and friction laws.
void record_laws(io::SchemaRecorder& recorder)
{
    record_surfaces(recorder);
    for (const NormalLawType& law : io::Registry<NormalLawType>::all())
        io::record_examples<dae::ObjectReader>(recorder, normal_kind, law.name, law.name, law.schema,
                                               [&](ObjectReader& o) { law.read(o); });
    for (const FrictionLaw& law : io::Registry<FrictionLaw>::all())
        io::record_examples<dae::ObjectReader>(recorder, friction_kind, law.name, law.name, law.schema,
                                               [&](ObjectReader& o) { read_keys(o, law, GivenForce(0)); });
    // A law that is not registered has these keys, and others.
    io::JsonSource source(R"({"mu_s": 0.5, "K_E": 1e4})", "friction parameters");
    source.schema = &recorder;
    ObjectReader o(source, source.root, "");
    o.defines("friction_parameters", "", "");
    read_parameters(o);
    o.finish();
    recorder.definition("friction_parameters")->open = true;
}

std::shared_ptr<const FrictionModel> read_friction(ObjectReader& contact, const NormalLaw& normal)
{
    if (!contact.has("friction")) return frictionless();
    ObjectReader o = contact.object("friction", about_friction, "friction");
    if (const dae::Json* law = o.find("law");
        law != nullptr && law->string() != nullptr && *law->string() == rolling)
        o.fail("law",
               "law \"rolling\" needs \"normal\": {\"type\": \"constraint\"}, got a compliant contact");
    const std::string law = o.one_of("law", io::Registry<FrictionLaw>::names(), {}, slide_roll_spin);
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

ConstraintNormal read_constraint_normal(ObjectReader& o, const ContactPair& pair)
{
    io::defines_type(o, normal_kind, "constraint", "constraint", constraint_schema);
    ConstraintNormal settings;
    Unilateral& unilateral = settings.unilateral;
    unilateral.enabled = o.flag(
        "unilateral",
        {"If true, the contact transmits compression only: it separates if the multiplier becomes tensile, "
         "and it closes with an impact. If false, the contact is bilateral and never separates.",
         "true"},
        false);
    const auto is_unilateral_or_given = [&](const char* key) {
        const bool given = o.find(key) != nullptr;
        return unilateral.enabled || given;
    };
    if (is_unilateral_or_given("restitution"))
        unilateral.restitution = o.fraction(
            "restitution",
            {"Coefficient of restitution e [-] of the impact with which a unilateral contact closes. "
             "Only with \"unilateral\": true.",
             "0.5"},
            0);
    if (!unilateral.enabled && o.has("restitution"))
        o.fail("restitution",
               "restitution needs \"unilateral\": true, got a bilateral contact with restitution " +
                   dae::shortest(unilateral.restitution));
    const io::About about_impact = {
        "Impact law. newton: the velocity of separation is e times the velocity of approach. poisson: the "
        "impulse of restitution is e times the impulse of compression. Only with \"unilateral\": true.",
        R"("poisson")"};
    if (is_unilateral_or_given("impact") &&
        o.one_of("impact", {"newton", "poisson"}, about_impact, "newton") == "poisson")
        unilateral.impact = Unilateral::Impact::poisson;
    if (!unilateral.enabled && o.has("impact"))
        o.fail("impact", "impact needs \"unilateral\": true, got a bilateral contact");
    const io::About about_rows = {
        "Directions on which the sum of the two unit normals is projected to make the normals opposite. "
        "tangent: two tangents of the surface of body i. fixed-xy: the global x and y axes (Fang 2022, Eq. "
        "5.17), which is singular if the normal lies in the x-y plane.",
        R"("fixed-xy")"};
    std::string rows = o.one_of("rows", {"tangent", "fixed-xy"}, about_rows, "tangent");
    if (!pair.normal_rows.empty()) {
        rows = pair.normal_rows;
        o.record("rows", rows);
        const std::string change = o.pointer("rows") + '=' + rows;
        if (pair.changes.empty() || pair.changes.back() != change) pair.changes.push_back(change);
    }
    if (rows == "fixed-xy") settings.rows = EvolvingContact::NormalRows::fixed_xy;
    if (o.has("fallback")) {
        ObjectReader law = o.object(
            "fallback",
            {"Compliant normal law (hertz or hooke) that replaces the constraint while the contact point "
             "is not unique or the multiplier is indeterminate. The friction law stays the same. Without "
             "a fallback the run stops there with an error.",
             R"({"type": "hooke", "stiffness": 1e5})"},
            "fallback");
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

/// Mass [kg] and mean moment of inertia [kg m²] of body b; infinite for the ground
std::pair<double, double> mass_of(const dae::Model& model, int b)
{
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (b == dae::ground) return {infinite, infinite};
    return {model.mass().m[b], model.mass().J_bar[b].trace() / 3};
}

ImplicitFriction read_implicit(ObjectReader& o, const ContactPair& pair)
{
    io::defines_type(o, friction_kind, implicit, implicit, implicit_schema);
    ImplicitFriction f;
    read_coefficients(o, f.mu_s, f.mu_k);
    f.K_E = o.positive("K_E", {"Tangential stiffness of sliding friction [N/m].", "1e6"});
    f.eta_r = o.not_negative(
        "eta_r",
        {"Rolling resistance coefficient eta_r [-] (Fang 2022, Eq. 4.5). Zero: no rolling resistance.",
         "0.1"},
        0);
    std::optional<double> D_slide, D_roll;
    const double zeta = read_zeta(o);
    read_damping(o, "D_slide", D_slide, about_D_slide());
    read_damping(o, "D_roll", D_roll,
                 {"Damping coefficient of rolling friction [N m s/rad]. It replaces the value computed from "
                  "zeta.",
                  "0.01"});
    const auto [m_i, I_i] = mass_of(pair.model, pair.i);
    const auto [m_j, I_j] = mass_of(pair.model, pair.j);
    f.K_D = D_slide.value_or(2 * zeta * std::sqrt(reduced(m_i, m_j) * f.K_E));
    if (D_roll)
        f.D_roll = *D_roll;
    else
        f.D_kappa = 2 * zeta * std::sqrt(reduced(I_i, I_j) * 4 * f.eta_r * f.K_E);
    f.static_start = read_static_start(o, f.static_start);
    return f;
}

ConstraintFriction read_constraint_friction(ObjectReader& contact, const ContactPair& pair,
                                            const ConstraintNormal& normal)
{
    if (!contact.has("friction")) return {};
    ObjectReader o = contact.object("friction", about_friction, "friction");
    std::vector<std::string> laws = io::Registry<FrictionLaw>::names();
    laws.insert(laws.begin(), {rolling, implicit});
    const std::string law = o.one_of("law", laws, {}, slide_roll_spin);
    ConstraintFriction settings{.ideal_rolling = law == rolling, .law = nullptr, .within_step = {}};
    if ((settings.ideal_rolling || law == implicit) && normal.fallback != nullptr)
        o.fail("law",
               "a contact with a fallback needs a friction law that the fallback "
               "supports, such as slide-roll-spin; got \"" +
                   law + "\", which is defined for the constraint only");
    if (law == implicit)
        settings.within_step = read_implicit(o, pair);
    else if (settings.ideal_rolling)
        io::defines_type(o, friction_kind, rolling, rolling, rolling_schema);
    else
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

void add_evolving(ObjectReader& o, ObjectReader normal, const ContactPair& pair, const Shape& i,
                  const Shape& j)
{
    const ConstraintNormal settings = read_constraint_normal(normal, pair);
    o.record("normal", normal.finish());
    const ConstraintFriction friction = read_constraint_friction(o, pair, settings);
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

/// Reads a rigid contact and adds it, for one pair or for all pairs of a large group.
bool add_rigid(ObjectReader& o, ObjectReader normal, const ContactPair& pair, const Shape& i, const Shape& j)
{
    io::defines_type(normal, normal_kind, "dvi", "dvi", rigid_schema);
    RigidLaw law;
    law.restitution = normal.fraction("restitution",
                                      {"Newton's coefficient of restitution e [-]: the velocity of "
                                       "separation of a contact point is e times "
                                       "the velocity of approach.",
                                       "0.5"},
                                      0);
    o.record("normal", normal.finish());
    if (o.has("friction")) {
        ObjectReader friction = o.object("friction", about_friction, "friction");
        friction.one_of("law", {coulomb});
        io::defines_type(friction, friction_kind, coulomb, coulomb, coulomb_schema);
        read_coefficients(friction, law.mu_s, law.mu_k);
        o.record("friction", friction.finish());
    }
    ContactPairs pairs;
    if (pair.group != nullptr) {
        pairs = *pair.group;
    } else {
        pairs.first = {pair.i}, pairs.second = {pair.j};
        pairs.index();
    }
    auto contacts = std::make_unique<RigidContacts>(pair.group != nullptr ? pair.group_name : pair.name,
                                                    pair.model, std::move(pairs), i, j, law);
    contacts->place = o.place();
    pair.model.contact(std::move(contacts));
    return pair.group != nullptr;
}

/// Refuses surfaces that touch at several points for a constraint, which has one contact point.
void check_single_point(const ObjectReader& o, std::string_view key, const Shape& shape)
{
    if (dynamic_cast<const Polytope*>(shape.surface.get()) != nullptr)
        o.fail(key, "a " + shape.surface->name() +
                        " touches at several points, which a constraint does not support; use \"normal\" of "
                        "type dvi, or a law with a stiffness such as hooke; got constraint");
}

/// The surfaces of a contact. All pairs of a group share them, so that a mesh is read once.
struct Surfaces {
    Shape i, j;
    io::Json text_i, text_j;  ///< canonical form

    static io::About about(std::string_view key)
    {
        if (key == "surface")
            return {"Surface of each of the bodies.", R"({"type": "sphere", "radius": 0.1})"};
        if (key == "surface_i") return {"Surface of body i.", R"({"type": "sphere", "radius": 0.1})"};
        return {"Surface of body j.", R"({"type": "plane"})"};
    }

    Surfaces(ObjectReader& o, const ContactPair& pair)
    {
        i = read_shape(o, pair.surface_i, about(pair.surface_i), text_i);
        j = pair.surface_j == pair.surface_i ? i
                                             : read_shape(o, pair.surface_j, about(pair.surface_j), text_j);
        if (pair.surface_j == pair.surface_i) text_j = text_i;
    }
};

bool read_contact(ObjectReader& o, const ContactPair& pair)
{
    if (pair.shared == nullptr) pair.shared = std::make_shared<const Surfaces>(o, pair);
    const Surfaces& surfaces = *static_cast<const Surfaces*>(pair.shared.get());
    for (const std::string& key : {pair.surface_i, pair.surface_j}) o.find(key);
    if (pair.group != nullptr && pair.group->each_two) {
        o.record("surface", surfaces.text_i);
    } else {
        o.record("surface_i", surfaces.text_i);
        o.record("surface_j", surfaces.text_j);
    }
    const Shape &i = surfaces.i, &j = surfaces.j;
    ObjectReader normal = o.object("normal",
                                   {"Normal law: how the normal force is computed.",
                                    R"({"type": "hertz", "E_star": 1e7, "restitution": 0.5})"},
                                   "normal");
    std::vector<std::string> types = normal_laws(false);
    types.insert(types.end(), {"constraint", "dvi"});
    const std::string type = normal.one_of("type", types);
    if (type == "dvi") return add_rigid(o, std::move(normal), pair, i, j);
    if (type == "constraint") {
        check_single_point(o, pair.surface_i, i);
        check_single_point(o, pair.surface_j, j);
        if (pair.group == nullptr) add_evolving(o, std::move(normal), pair, i, j);
        return false;
    }
    const std::shared_ptr<const NormalLaw> law = read_normal(normal, type);
    o.record("normal", normal.finish());
    if (pair.group != nullptr && !ContactGroup::may_have(*law)) return false;
    const std::shared_ptr<const FrictionModel> friction = read_friction(o, *law);
    if (pair.group != nullptr)
        pair.model.load(
            std::make_unique<ContactGroup>(pair.group_name, pair.model, *pair.group, i, j, law, friction));
    else
        pair.model.load(compliant_contact(pair.name, pair.model, pair.i, i, pair.j, j, law, friction));
    return pair.group != nullptr;
}

const bool registered_model_contacts = dae::register_contact_reader(
    [](ObjectReader& model, const dae::PartialModel& to) { read_contacts(model, to, read_contact); });

// The examples of contacts in the schema
constexpr const char* bodies = R"({"name": "contacts", "bodies": [)"
                               R"({"name": "ball", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}, )"
                               R"({"name": "ball-2", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0]}], )"
                               R"("contacts": [)";
constexpr const char* ball_on_floor =
    R"("body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.1}, )"
    R"("surface_j": {"type": "plane"}, )";

const bool registered_contact_schema = io::Registry<dae::SchemaPart>::add(
    {.name = "contacts",
     .models =
         {bodies + std::string(R"({"name": "ball-floor", )") + ball_on_floor +
              R"("normal": {"type": "hertz", "E_star": 1e7, "restitution": 0.5}, )"
              R"("friction": {"mu_s": 0.5, "mu_k": 0.4, "K_E": 10000, "eta_r": 0.05}}, )"
              R"({"name": "ball-bowl", "body_i": "ball", "body_j": "ground", )"
              R"("surface_i": {"type": "sphere", "radius": 0.1}, )"
              R"("surface_j": {"type": "ellipsoid", "semi_axes": [2.5, 3, 2], "concave": true}, )"
              R"("normal": {"type": "constraint"}, "friction": {"law": "rolling"}}, )"
              R"({"name": "balls", "bodies": "all", "surface": {"type": "sphere", "radius": 0.1}, )"
              R"("normal": {"type": "hooke", "stiffness": 1e5}}, )"
              R"({"name": "box-floor", "body_i": "ball", "body_j": "ground", )"
              R"("surface_i": {"type": "box", "lengths": [0.2, 0.2, 0.2]}, "surface_j": {"type": "plane"}, )"
              R"("normal": {"type": "dvi", "restitution": 0.5}, )"
              R"("friction": {"law": "coulomb", "mu_s": 0.5, "mu_k": 0.4}}]})",
          bodies + std::string("{") + ball_on_floor +
              R"("normal": {"type": "constraint", "unilateral": true, "restitution": 0.5, )"
              R"("fallback": {"type": "hooke", "stiffness": 1e5}}}, {)" +
              ball_on_floor +
              R"("normal": {"type": "constraint"}, )"
              R"("friction": {"law": "implicit", "mu_s": 0.25, "mu_k": 0.2, "K_E": 1e6, "eta_r": 0.1}}]})"},
     .record = record_laws,
     .add = add_contacts});

}  // namespace

}  // namespace hilda::contact
