// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts in model files: reading, canonical text, and the place of errors.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "dae/model_file.hpp"
#include "tests/support/paths.hpp"

#include <filesystem>

using namespace hilda;
using contact::ContactForce;

namespace {

const std::filesystem::path models = std::filesystem::path(tests::test_data) / "models";
const std::string steel = R"({"type": "hooke", "stiffness": 1e4})", rough = R"({"mu_s": 0.3, "K_E": 1e4})",
                  sphere = R"({"type": "sphere", "radius": 0.2})", flat = R"({"type": "plane"})";

/// A ball on the ground. The keys of the contact are on lines 2 to 6.
std::string ball(const std::string& surface_i = sphere, const std::string& surface_j = flat,
                 const std::string& normal = steel, const std::string& friction = rough, double z = 0.2)
{
    return R"({"hilda_model": 1, "name": "m", "contacts": [
 {"name": "c", "body_i": "ball", "body_j": "ground", "surface_i":
)" + surface_i +
           ", \"surface_j\":\n" + surface_j + ", \"normal\":\n" + normal + ", \"friction\":\n" + friction +
           R"(}], "bodies": [{"name": "ball", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, )" +
           std::to_string(z) + "]}]}";
}

std::string refusal_of_model(const std::string& text)
{
    try {
        dae::Description d = dae::read_model(text, "m.json");
        dae::start(d);
        return "accepted";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("all contacts of the example models are read, can be started, and have a stable canonical text",
          "[contact][model_file]")
{
    int contacts = 0;
    for (const auto& entry : std::filesystem::directory_iterator(models / "contacts")) {
        if (entry.path().extension() != ".json") continue;  // the folder of the meshes
        INFO(entry.path());
        dae::Description d = dae::load_model(entry.path().string());
        const dae::Description again = dae::read_model(d.text, "again.json");
        CHECK(again.text == d.text);
        dae::start(d);
        lie::Loads loads(d.model->bodies());
        d.model->loads(d.x, loads);
        for (const auto& force : d.model->forces()) {
            const auto* pressing = dynamic_cast<const ContactForce*>(force.get());
            if (pressing != nullptr) CHECK(pressing->contact.name == pressing->name);
            CHECK(dynamic_cast<const contact::TrackedForce&>(*force).stable_step(d.x) > 1e-5);
            ++contacts;
        }
    }
    CHECK(contacts >= 8);
}

TEST_CASE("the defaults of a contact are those of the balanced preset", "[contact][model_file]")
{
    const dae::Description d = dae::read_model(ball(), "m.json");
    CHECK_THAT(d.text, Catch::Contains(R"("law": "slide-roll-spin")") && Catch::Contains(R"("mu_k": 0.3)") &&
                           Catch::Contains(R"("zeta": 1)") && Catch::Contains(R"("beta": 0.5)") &&
                           Catch::Contains(R"("preset": "balanced")"));
    const std::string as = R"({"mu_s": 0.3, "K_E": 1e4, "preset": "dissertation"})";
    CHECK_THAT(dae::read_model(ball(sphere, flat, steel, as), "m.json").text,
               Catch::Contains(R"("beta": 1)"));
}

TEST_CASE("Hertzian spinning friction uses the modulus of the Hertzian normal law by default",
          "[contact][model_file]")
{
    const std::string hertz = R"({"type": "hertz", "E_star": 2e6})";
    const auto stiffness = [&](const std::string& normal, const std::string& more) {
        const std::string friction = R"({"mu_s": 0.3, "K_E": 1e4, "spin": "hertz")" + more + "}";
        dae::Description d = dae::read_model(ball(sphere, flat, normal, friction, 0.199), "m.json");
        dae::start(d);
        const auto& force = dynamic_cast<const ContactForce&>(*d.model->forces()[0]);
        return force.contact.friction->springs(force.at(d.x).contact_state).K_spin;
    };
    CHECK(stiffness(hertz, "") > 0);
    CHECK(stiffness(hertz, "") == stiffness(hertz, R"(, "E_star": 2e6)"));
    CHECK(stiffness(hertz, "") > stiffness(hertz, R"(, "E_star": 4e6)"));
    CHECK_THAT(refusal_of_model(ball(sphere, flat, steel, R"({"mu_s": 0.3, "K_E": 1e4, "spin": "hertz"})")),
               Catch::Contains("(/contacts/0/friction): missing key 'E_star'"));
}

TEST_CASE("an invalid contact is rejected with its position in the file", "[contact][model_file]")
{
    struct Bad {
        std::string text, message;
    };
    const auto surface = [](const std::string& s) { return ball(s); };
    const auto normal = [](const std::string& s) { return ball(sphere, flat, s); };
    const auto friction = [](const std::string& s) { return ball(sphere, flat, steel, s); };
    const std::vector<Bad> all = {
        {surface(R"({"type": "sphere", "radius": -1})"),
         "m.json:3:30 (/contacts/0/surface_i/radius): radius must be positive, got -1"},
        {surface(R"({"type": "ellipsoid", "semi_axes": [1, 0, 1]})"),
         "m.json:3:36 (/contacts/0/surface_i/semi_axes): semi_axes must be positive, got [1, 0, 1]"},
        {normal(R"({"type": "hertz", "E_star": 0})"),
         "m.json:5:29 (/contacts/0/normal/E_star): E_star must be positive, got 0"},
        {normal(R"({"type": "hertz", "E_star": 1, "restitution": 1.1})"),
         "m.json:5:47 (/contacts/0/normal/restitution): restitution must be from 0 to 1, got 1.1"},
        {normal(R"({"type": "hertz", "E_star": 1, "nu_j": 0.3})"),
         "m.json:5:40 (/contacts/0/normal/nu_j): give one of E_star and nu_j, not both"},
        {normal(R"({"type": "hertz", "E_i": 1, "nu_i": 0.6, "E_j": 1, "nu_j": 0.3})"),
         "m.json:5:37 (/contacts/0/normal/nu_i): nu_i must be above -1 and at most 0.5, got 0.6"},
        {normal(R"({"type": "hooke", "stiffness": 1, "damping": -1})"),
         "m.json:5:46 (/contacts/0/normal/damping): damping must not be negative, got -1"},
        {normal(R"({"type": "given", "force": -2})"),
         "m.json:5:28 (/contacts/0/normal/force): force must not be negative, got -2"},
        {normal(R"({"type": "herz"})"), "m.json:5:10 (/contacts/0/normal/type): unknown type \"herz\""},
        {friction(R"({"mu_s": 0.2, "mu_k": 0.3, "K_E": 1})"),
         "m.json:6:23 (/contacts/0/friction/mu_k): mu_k must not be above mu_s, 0.2, got 0.3"},
        {friction(R"({"mu_s": -0.2, "K_E": 1})"),
         "m.json:6:10 (/contacts/0/friction/mu_s): mu_s must not be negative, got -0.2"},
        {friction(R"({"mu_s": 0.2, "K_E": 0})"),
         "m.json:6:22 (/contacts/0/friction/K_E): K_E must be positive, got 0"},
        {friction(R"({"mu_s": 0.2, "K_E": 1, "eta_r": -1})"),
         "m.json:6:34 (/contacts/0/friction/eta_r): eta_r must not be negative, got -1"},
        {friction(R"({"mu_s": 0.2, "K_E": 1, "eta_psi": -1})"),
         "m.json:6:36 (/contacts/0/friction/eta_psi): eta_psi must not be negative, got -1"},
        {friction(R"({"mu_s": 0.2, "K_E": 1, "law": "epsd", "eta_r": 1})"),
         "m.json:6:40 (/contacts/0/friction/eta_r): unknown key \"eta_r\""},
        {friction(R"({"mu_s": 0.2, "K_E": 1, "mu_r": 1})"),
         "m.json:6:25 (/contacts/0/friction/mu_r): unknown key \"mu_r\""},
        {friction(R"({"mu_s": 0.2})"), "m.json:6:1 (/contacts/0/friction): missing key 'K_E'"},
        // errors found by the contact itself
        {ball(sphere, flat, steel, rough, 0.17),
         "m.json:2:2 (/contacts/0): contact 'c': the surfaces must not overlap by more than 0.02 m, "
         "a tenth of the radius"},
        {ball(sphere, R"({"type": "sphere", "radius": 0.1, "concave": true})"),
         "m.json:2:2 (/contacts/0): contact::make_detector: the radius of a sphere must be less than that of "
         "the concave sphere around it, got 0.2 m in 0.1 m"},
        {ball(R"({"type": "foot"})", flat, steel, R"({"mu_s": 0.3, "K_E": 1, "eta_r": 0.1})"),
         "m.json:2:2 (/contacts/0): contact 'c': the normal or friction law needs curvature: the sum of "
         "the curvatures must be positive, got 0"},
        {ball(flat),
         "m.json:2:2 (/contacts/0): contact::make_detector: a pair of surfaces must have a single contact "
         "point"},
    };
    for (const Bad& bad : all) {
        INFO(bad.message);
        CHECK_THAT(refusal_of_model(bad.text), Catch::StartsWith(bad.message));
    }
    CHECK(refusal_of_model(ball()) == "accepted");

    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(models / "bad")) {
        if (!entry.path().filename().string().starts_with("contact_")) continue;
        INFO(entry.path());
        CHECK_THROWS_WITH(dae::load_model(entry.path().string()), Catch::Contains("(/contacts/0"));
        ++files;
    }
    CHECK(files >= 10);
}
