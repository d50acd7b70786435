// SPDX-License-Identifier: GPL-3.0-or-later
// Constraint contacts of a model file: reading, writing, and the place of errors.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/friction.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "dae/model_file.hpp"
#include "tests/support/paths.hpp"

#include <filesystem>

using namespace hilda;
using contact::ContactForce;
using contact::EvolvingContact;
using contact::EvolvingFriction;

namespace {

const std::filesystem::path models = std::filesystem::path(tests::test_data) / "models";
const std::string ball = R"({"type": "sphere", "radius": 0.5})", flat = R"({"type": "plane"})",
                  bowl = R"({"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true})",
                  constraint = R"({"type": "constraint"})";

/// A model with one ball of 1 kg. The contact is on line 3, its keys are on lines of their own.
std::string model(const std::string& surface_i, const std::string& surface_j, const std::string& normal,
                  const std::string& friction = "", const std::string& r = "0, 0, 0.5",
                  const std::string& rdot = "0, 0, 0")
{
    return R"({"hilda_model": 1, "name": "m",
 "bodies": [{"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [)" +
           r + R"(], "r_dot": [)" + rdot + R"(]}], "contacts": [
 {"name": "c", "body_i": "ball", "body_j": "ground", "surface_i":
)" + surface_i +
           ", \"surface_j\":\n" + surface_j + ", \"normal\":\n" + normal +
           (friction.empty() ? "" : ", \"friction\":\n" + friction) + "}]}";
}

std::string refusal(const std::string& text, bool fix_initial = false)
{
    try {
        dae::Description d = dae::read_model(text, "m.json");
        dae::start(d, {.fix_initial = fix_initial});
        return "accepted";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

const EvolvingContact& first(const dae::Description& d)
{
    return dynamic_cast<const EvolvingContact&>(*d.model->general_constraints().at(0));
}

double normal_force(const dae::Description& d)
{
    return first(d).multipliers(d.model->arguments(first(d), d.x), d.x.lambda).F_N;
}

}  // namespace

TEST_CASE("constraint contacts are read, start, and are written unchanged", "[contact][model_file][evolving]")
{
    dae::Description d = dae::load_model((models / "contacts" / "evolving.json").string());
    REQUIRE(d.model->general_constraints().size() == 3);
    CHECK(d.model->forces().empty());
    CHECK(d.general_place.size() == 3);
    CHECK_THAT(d.general_place[1], Catch::EndsWith("(/contacts/1)"));
    const auto& of = [&](int k) -> const EvolvingContact& {
        return dynamic_cast<const EvolvingContact&>(*d.model->general_constraints()[k]);
    };
    CHECK(of(0).friction == EvolvingContact::Friction::rolling);
    CHECK(of(0).normal_rows == EvolvingContact::NormalRows::tangent);
    CHECK(of(1).i == dae::ground);
    CHECK(of(1).friction == EvolvingContact::Friction::none);
    CHECK(of(1).normal_rows == EvolvingContact::NormalRows::fixed_xy);
    CHECK(of(2).name == "contact-3");
    CHECK_THAT(d.text, Catch::Contains(R"("rows": "fixed-xy")") &&
                           Catch::Contains(R"("unilateral": false)") &&
                           Catch::Contains(R"("law": "rolling")") && !Catch::Contains("restitution"));
    CHECK(dae::read_model(d.text, "again.json").text == d.text);

    const dae::StartReport report = dae::start(d);
    CHECK(report.degrees_of_freedom == 3 * 6 - 5);  // three contacts, one with ideal rolling
    CHECK(d.x.alpha.size() == 18);
    // the marble of 0.2 kg lies on the ellipsoid of 2 kg, which spins about the vertical through the marble
    const auto force = [&](int k) {
        return of(k).multipliers(d.model->arguments(of(k), d.x), d.x.lambda).F_N;
    };
    CHECK(force(2) == Approx(0.2 * 9.81).epsilon(1e-12));
    CHECK(force(1) == Approx(2.2 * 9.81).epsilon(1e-12));
}

TEST_CASE("a constraint contact starts with the normal force of the closed form",
          "[contact][model_file][evolving]")
{
    const std::string at = "0, 1.320394697973225, -1.265422544940186";
    dae::Description d = dae::read_model(model(ball, bowl, constraint, "", at), "m.json");
    dae::start(d);
    CHECK(normal_force(d) == Approx(9.155246512774925).epsilon(1e-13));
    // rows along the global x and y are equivalent if the normal is not in their plane
    dae::Description xy =
        dae::read_model(model(ball, bowl, R"({"type": "constraint", "rows": "fixed-xy"})", "", at), "m.json");
    dae::start(xy);
    CHECK(normal_force(xy) == Approx(normal_force(d)).epsilon(1e-13));
}

TEST_CASE("fix-initial closes a gap at the start along the normal", "[contact][model_file][evolving]")
{
    dae::Description d =
        dae::read_model(model(ball, flat, constraint, "", "0, 0, 0.6", "1, 0, -2"), "m.json");
    dae::start(d, {.fix_initial = true});
    CHECK(d.x.body[0].r.z() == Approx(0.5).epsilon(1e-14));
    CHECK(d.x.body[0].rdot.x() == Approx(1).epsilon(1e-14));
    CHECK(std::abs(d.x.body[0].rdot.z()) < 1e-15);
    CHECK(normal_force(d) == Approx(9.81).epsilon(1e-13));
}

TEST_CASE("a unilateral contact is read with its restitution and can start inactive",
          "[contact][model_file][evolving]")
{
    const std::string opens = R"({"type": "constraint", "unilateral": true, "restitution": 0.5})";
    dae::Description d = dae::read_model(model(ball, flat, opens, "", "0, 0, 0.6", "0, 0, -2"), "m.json");
    CHECK(first(d).unilateral.enabled);
    CHECK(first(d).unilateral.restitution == 0.5);
    CHECK_THAT(d.text, Catch::Contains(R"("restitution": 0.5)"));
    CHECK(dae::read_model(d.text, "again.json").text == d.text);
    const dae::StartReport report = dae::start(d);
    CHECK(report.degrees_of_freedom == 6);
    CHECK(dae::Model::inactive(first(d), d.x));
    CHECK(d.x.body[0].rdot.z() == -2);
}

TEST_CASE("tracked friction of a model file belongs to its contact",
          "[contact][model_file][evolving][friction]")
{
    dae::Description d = dae::load_model((models / "contacts" / "evolving_friction.json").string());
    REQUIRE(d.model->general_constraints().size() == 3);
    const auto of = [&](size_t k) -> const EvolvingContact& {
        return dynamic_cast<const EvolvingContact&>(*d.model->general_constraints()[k]);
    };
    const auto& force = d.model->forces();
    REQUIRE(force.size() == 5);  // three of friction, two fallbacks
    CHECK(d.force_place.size() == 5);
    CHECK(d.force_place[2] == d.general_place[1]);
    const auto* first_friction = dynamic_cast<const EvolvingFriction*>(force[0].get());
    REQUIRE(first_friction != nullptr);
    CHECK(&first_friction->contact == &of(0));
    CHECK(first_friction->name == "ball-bowl");
    for (const auto& [k, contact] : {std::pair(2, 1), {4, 2}}) {
        const auto* fallback = dynamic_cast<const ContactForce*>(force[k].get());
        REQUIRE(fallback != nullptr);
        CHECK(fallback->normal_constraint() == &of(contact));
        CHECK(of(contact).fallback);
        const auto& friction = dynamic_cast<const EvolvingFriction&>(*force[k - 1]);
        CHECK(friction.normal_constraint() == &of(contact));
    }
    CHECK_FALSE(of(0).fallback);
    CHECK_FALSE(of(0).unilateral.enabled);
    CHECK(of(1).unilateral.enabled);
    CHECK(of(1).unilateral.restitution == 0.4);
    CHECK(of(1).unilateral.impact == contact::Unilateral::Impact::poisson);
    CHECK_THAT(d.text, Catch::Contains(R"("impact": "poisson")") && Catch::Contains(R"("fallback": {)") &&
                           Catch::Contains(R"("law": "slide-roll-spin")") &&
                           Catch::Contains(R"("preset": "dissertation")"));
    CHECK(dae::read_model(d.text, "again.json").text == d.text);

    dae::start(d);
    // the ball in the bowl is isolated, with the springs of Table 5.1: h = (sqrt(d² + 4 k) - d)/k
    const double q = 1 / 1. + 0.25 / 0.1, D = 100 * q, k = 1e4 * q;
    CHECK(first_friction->stable_step(d.x) == Approx((std::sqrt(D * D + 4 * k) - D) / k).epsilon(1e-9));
    CHECK(first_friction->normal_force(d.x) == Approx(normal_force(d)).epsilon(1e-12));
    // an inactive fallback has no force and takes no share of the mass
    const auto& fallback = dynamic_cast<const ContactForce&>(*force[2]);
    CHECK_FALSE(fallback.is_active(d.x));
    lie::Loads out(3);
    fallback.add(d.x, out);
    CHECK(out.F[1].norm() + out.n_bar[1].norm() == 0);
    dae::Model::set_mode(of(1), d.x, EvolvingContact::fallback_active);
    CHECK(fallback.is_active(d.x));
    CHECK(force[1]->stable_step(d.x) == std::numeric_limits<double>::infinity());
}

TEST_CASE("implicit friction of a model file has no stability limit",
          "[contact][model_file][evolving][friction]")
{
    const std::string friction =
        R"({"law": "implicit", "mu_s": 0.3, "mu_k": 0.25, "K_E": 1e8, "eta_r": 0.01})";
    dae::Description d = dae::read_model(model(ball, flat, constraint, friction), "m.json");
    const auto& c = dynamic_cast<const EvolvingContact&>(*d.model->general_constraints()[0]);
    CHECK(c.friction == EvolvingContact::Friction::implicit);
    CHECK(d.model->forces().empty());
    CHECK(dae::read_model(d.text, "again.json").text == d.text);
    dae::start(d);
    CHECK(d.model->stable_step(d.x).h == std::numeric_limits<double>::infinity());
    CHECK_THROWS_WITH(
        dae::read_model(
            model(ball, flat, R"({"type": "constraint", "fallback": {"type": "hooke", "stiffness": 1e4}})",
                  friction),
            "m.json"),
        Catch::Contains("/contacts/0/friction/law") && Catch::Contains("got \"implicit\""));
}

TEST_CASE("an inactive fallback does not change the stability limit of the friction",
          "[contact][model_file][evolving][friction]")
{
    const std::string friction = R"({"mu_s": 0.25, "mu_k": 0.2, "K_E": 1e4, "D_slide": 100})";
    const auto bound = [&](const std::string& normal) {
        dae::Description d = dae::read_model(model(ball, flat, normal, friction), "m.json");
        dae::start(d);
        return d.model->forces()[0]->stable_step(d.x);
    };
    CHECK(bound(R"({"type": "constraint", "fallback": {"type": "hooke", "stiffness": 1e4}})") ==
          bound(constraint));
}

TEST_CASE("an invalid constraint contact is rejected at its place in the file",
          "[contact][model_file][evolving]")
{
    struct Bad {
        std::string text, message;
    };
    const auto normal = [](const std::string& s) { return model(ball, flat, s); };
    const std::string place = "m.json:3:2 (/contacts/0): ";
    const std::vector<Bad> all = {
        {normal(R"({"type": "constraint", "unilateral": true, "restitution": 1.5})"),
         "m.json:6:59 (/contacts/0/normal/restitution): restitution must be from 0 to 1, got 1.5"},
        {normal(R"({"type": "constraint", "unilateral": true, "restitution": -0.1})"),
         "m.json:6:59 (/contacts/0/normal/restitution): restitution must be from 0 to 1, got -0.1"},
        {normal(R"({"type": "constraint", "restitution": 0.5})"),
         "m.json:6:39 (/contacts/0/normal/restitution): restitution needs \"unilateral\": true"},
        {normal(R"({"type": "constraint", "impact": "poisson"})"),
         "m.json:6:34 (/contacts/0/normal/impact): impact needs \"unilateral\": true"},
        {normal(R"({"type": "constraint", "unilateral": true, "impact": "Newton"})"),
         "m.json:6:54 (/contacts/0/normal/impact): unknown impact \"Newton\"; did you mean 'newton'?"},
        {normal(R"({"type": "constraint", "fallback": {"type": "given", "force": 1}})"),
         "m.json:6:45 (/contacts/0/normal/fallback/type): unknown type \"given\""},
        {normal(R"({"type": "constraint", "fallback": {"type": "hooke"}})"),
         "m.json:6:36 (/contacts/0/normal/fallback): missing key 'stiffness'"},
        {normal(R"({"type": "constraint", "fallback": {"type": "hertz", "E_star": -1}})"),
         "m.json:6:64 (/contacts/0/normal/fallback/E_star): E_star must be positive, got -1"},
        {normal(R"({"type": "constraint", "fallback": {"type": "hooke", "stiffness": 1, "fallback": {}}})"),
         "m.json:6:70 (/contacts/0/normal/fallback/fallback): unknown key \"fallback\""},
        {model(ball, flat, R"({"type": "constraint", "fallback": {"type": "hooke", "stiffness": 1}})",
               R"({"law": "rolling"})"),
         "m.json:7:9 (/contacts/0/friction/law): a contact with a fallback needs a friction law that the "
         "fallback supports"},
        {model(ball, flat, constraint, R"({"mu_s": 0.3})"),
         "m.json:7:1 (/contacts/0/friction): missing key 'K_E'"},
        {model(ball, flat, constraint, R"({"mu_s": 0.3, "mu_k": 0.4, "K_E": 1e4})"),
         "m.json:7:23 (/contacts/0/friction/mu_k): mu_k must not be above mu_s, 0.3, got 0.4"},
        {model(ball, flat, constraint, R"({"mu_s": 0.3, "K_E": 1e4, "spin": "hertz"})"),
         "m.json:7:1 (/contacts/0/friction): missing key 'E_star'"},
        {normal(R"({"type": "constraint", "unilateral": 1})"),
         "m.json:6:38 (/contacts/0/normal/unilateral): unilateral must be true or false, got 1"},
        {normal(R"({"type": "constraint", "stiffness": 1})"),
         "m.json:6:24 (/contacts/0/normal/stiffness): unknown key \"stiffness\""},
        {normal(R"({"type": "constraint", "rows": "fixed"})"),
         "m.json:6:32 (/contacts/0/normal/rows): unknown rows \"fixed\""},
        {normal(R"({"type": "constrain"})"),
         "m.json:6:10 (/contacts/0/normal/type): unknown type \"constrain\"; did you mean 'constraint'?"},
        {model(ball, flat, constraint, R"({"law": "roling"})"),
         "m.json:7:9 (/contacts/0/friction/law): unknown law \"roling\"; did you mean 'rolling'?"},
        {model(ball, flat, constraint, R"({"law": "rolling", "mu_s": 0.3})"),
         "m.json:7:20 (/contacts/0/friction/mu_s): unknown key \"mu_s\""},
        {model(ball, flat, R"({"type": "hooke", "stiffness": 1e4})", R"({"law": "rolling"})"),
         "m.json:7:9 (/contacts/0/friction/law): law \"rolling\" needs \"normal\": {\"type\": "
         "\"constraint\"}"},
        {model(flat, flat, constraint),
         place + "contact::EvolvingContact: at least one of the two surfaces must be curved"},
        {model(R"({"type": "disk", "radius": 0.5})", flat, constraint),
         "m.json:4:1 (/contacts/0/surface_i): a contact of type \"constraint\" needs a smooth surface, got a "
         "disk"},
        {model(ball, R"({"type": "sphere", "radius": 0.3, "concave": true})", constraint),
         place + "contact::make_detector: the radius of a sphere must be less than that of the concave "
                 "sphere around it"},
        // at the start
        {model(ball, flat, constraint, "", "0, 0, 0.6"),
         place + "contact 'c'; bodies 'ball', 'ground': not in contact "
                 "at the start, the gap or overlap is 0.1 m, at most 5e-07 m is allowed; use --fix-initial"},
        {model(ball, flat, constraint, "", "0, 0, 0.4999"),
         place + "contact 'c'; bodies 'ball', 'ground': not in contact at the start"},
        {model(ball, flat, constraint, "", "0, 0, 0.5", "0, 0, 0.5"),
         place +
             "contact 'c'; bodies 'ball', 'ground': the initial velocities violate the contact by 0.5 m/s"},
        {model(ball, flat, constraint, R"({"law": "rolling"})", "0, 0, 0.5", "0.25, 0, 0"),
         place +
             "contact 'c'; bodies 'ball', 'ground': the initial velocities violate the contact by 0.25 m/s"},
        {model(R"({"type": "cylinder", "radius": 0.5, "axis": [1, 0, 0]})", flat, constraint),
         place +
             "contact::make_detector: a pair of surfaces must have a single contact point, got cylinder and "
             "plane"},
        {model(R"({"type": "ellipsoid", "semi_axes": [0.5, 0.5, 0.5]})",
               R"({"type": "ellipsoid", "semi_axes": [0.5, 0.5, 0.5], "concave": true})", constraint, "",
               "0, 0, 0"),
         place + "contact 'c'; bodies 'ball', 'ground': "},
        {model(R"({"type": "sphere", "radius": 2.5})", bowl, constraint, "", "0, 0, 0.1"),
         place +
             "contact 'c'; bodies 'ball', 'ground': the convex body does not fit into the concave surface: "
             "its width is 5 m, the width available is 4 m"},
        {model(R"({"type": "cone", "half_angle": 0.5, "axis": [0, 0, 1]})",
               R"({"type": "sphere", "radius": 0.5, "position": [0, 0, -0.5]})", constraint, "", "0, 0, 0"),
         place + "contact 'c'; bodies 'ball', 'ground': no contact point of two surfaces: no starting points "
                 "were found, a point on the axis of a cone has no unique closest point"},
        {model(ball, R"({"type": "sphere", "radius": 2, "concave": true})", constraint, "", "0, 0, 0"),
         place + "contact 'c'; bodies 'ball', 'ground': the centres of two spheres coincide"},
    };
    for (const Bad& bad : all) {
        INFO(bad.message);
        CHECK_THAT(refusal(bad.text), Catch::StartsWith(bad.message));
    }
    CHECK(refusal(normal(constraint)) == "accepted");
    CHECK(refusal(model(ball, flat, constraint, "", "0, 0, 0.5000001")) == "accepted");
    CHECK(refusal(model(ball, flat, constraint, "", "0, 0, 0.6", "0, 0, 1"), true) == "accepted");
}

namespace {

/// G³ of an ellipsoid: the same surface, with a gradient that vanishes on it
class Cubed final : public contact::Surface {
public:
    double value(const lie::Vec3& a) const override { return std::pow(once.value(a), 3); }
    lie::Vec3 gradient(const lie::Vec3& a) const override
    {
        return 3 * std::pow(once.value(a), 2) * once.gradient(a);
    }
    lie::Mat3 hessian(const lie::Vec3& a) const override
    {
        const double G = once.value(a);
        return 6 * G * once.gradient(a) * once.gradient(a).transpose() + 3 * G * G * once.hessian(a);
    }
    bool convex() const override { return true; }
    std::optional<lie::Vec3> support(const lie::Vec3& u) const override { return once.support(u); }
    double size() const override { return once.size(); }

private:
    const contact::Ellipsoid once{lie::Vec3(0.3, 0.25, 0.15)};
};

}  // namespace

TEST_CASE("a surface without a normal at the contact is rejected at the start", "[contact][evolving]")
{
    dae::Model model;
    model.add({.name = "egg", .m = 2, .J_bar = lie::Vec3(0.034, 0.045, 0.061).asDiagonal()});
    model.constrain("egg-floor", std::make_unique<EvolvingContact>(
                                     0, contact::Shape{std::make_shared<Cubed>()}, dae::ground,
                                     contact::Shape{std::make_shared<contact::Plane>()}));
    lie::State x;
    x.body.resize(1);
    x.body[0].r.z() = 0.15;
    CHECK_THROWS_AS(dae::start(model, x), dae::ConstraintError);
    CHECK_THROWS_WITH(dae::start(model, x),
                      Catch::StartsWith("contact 'egg-floor'; bodies 'egg', 'ground': ") &&
                          Catch::Contains("a surface has no normal at (0, "));
}

TEST_CASE("two contacts with the same name or with the name of a joint are rejected",
          "[contact][model_file][evolving]")
{
    std::string text = model(ball, flat, constraint);
    text.insert(text.find(", \"contacts\""),
                R"(, "constraints": [{"name": "c", "type": "CD", "body_i": "ball", "body_j": "ground",
  "c": [1, 0, 0], "s_bar_p_i": [0, 0, 0], "s_bar_q_j": [0, 0, 0]}])");
    CHECK_THAT(refusal(text),
               Catch::Contains("(/contacts/0): dae::Model::constrain: two constraints have the same "
                               "name, got 'c'"));
}
