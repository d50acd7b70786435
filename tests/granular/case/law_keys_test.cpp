// SPDX-License-Identifier: GPL-3.0-or-later
// Every key of an entry of `laws` has an effect, or is refused.
#include "granular/case/case_file.hpp"
#include "granular/case/law_list.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <map>

using namespace hilda;
using hilda::granular::read_case;

namespace law_keys_test {

namespace {

/// Members of an entry of `laws` and of its laws, in JSON
struct Entry {
    std::map<std::string, std::string> keys;
    std::string normal, tangential, rolling = "none", cohesion = "none";
    std::map<std::string, std::string> own = {};  ///< further members of a law, by its kind

    std::string text() const
    {
        std::string all;
        for (const auto& [key, value] : keys) all += '"' + key + "\": " + value + ", ";
        const auto law = [&](const char* kind, const std::string& name) {
            const auto more = own.find(kind);
            return '"' + std::string(kind) + R"(": {"law": ")" + name + '"' +
                   (more == own.end() || more->second.empty() ? "" : ", " + more->second) + '}';
        };
        return all + law("normal", normal) + ", " + law("tangential", tangential) + ", " +
               law("rolling", rolling) + ", " + law("cohesion", cohesion);
    }
};

/// Velocities after an oblique collision of two spinning grains
std::vector<double> collision(const std::string& entry)
{
    granular::Case c = read_case(
        R"({"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [0.1, 0.1, 0.1]}, "gravity": [0, 0, 0],
            "step": 2e-6, "end": 1, "materials": [{"name": "m", "density": 2500, "E": 1e7, "nu": 0.3}], "laws": [{)" +
            entry + R"(}], "particles": [
            {"r": [0.03, 0.05, 0.05], "radius": 2e-3, "v": [0.3, 0, 0], "omega": [0, 0, 90]},
            {"r": [0.034, 0.0505, 0.05], "radius": 2e-3, "omega": [10, 0, 20]}]})",
        "case");
    c.world->step(600);
    std::vector<double> all;
    for (const granular::Particle& p : c.world->particles())
        for (const double x : {p.v.x, p.v.y, p.v.z, p.omega.x, p.omega.y, p.omega.z}) all.push_back(x);
    return all;
}

const std::map<std::string, std::string> normal_members = {{"hertz", ""},
                                                           {"hooke", R"("k_n": 1e4)"},
                                                           {"scaled-hooke", R"("k_n": 1e5)"},
                                                           {"hunt-crossley", R"("alpha": 0.2)"},
                                                           {"kuwabara-kono", R"("A": 1e-6)"},
                                                           {"walton-braun", R"("k_1": 1e4, "k_2": 2e4)"}};

bool has_material_stiffness(const std::string& normal)
{
    return normal == "hertz" || normal == "hunt-crossley" || normal == "kuwabara-kono";
}

/// An entry with the keys that the laws require
Entry entry_of(const std::string& normal, const std::string& tangential)
{
    Entry e{.keys = {}, .normal = normal, .tangential = tangential};
    e.own["normal"] = normal_members.at(normal);
    if (tangential != "none") e.keys["mu"] = "0.1";
    const bool of_materials = has_material_stiffness(normal);
    if (normal == "hertz" || (of_materials && tangential != "none")) e.keys["restitution"] = "0.7";
    if (tangential != "none" && !of_materials) e.own["tangential"] = R"("k_t": 8e3, "gamma_t": 50)";
    return e;
}

}  // namespace

TEST_CASE("every key of an entry of laws changes the motion or is refused", "[granular][case][laws]")
{
    const std::map<std::string, std::array<std::string, 2>> values = {
        {"restitution", {"0.5", "0.9"}},
        {"mu", {"0.02", "0.1"}},
        {"mu_s", {"0.1", "3"}},
        {"lever", {"\"radius\"", "\"contact\""}}};
    int refused = 0, effective = 0;
    for (const auto& [normal, members] : normal_members)
        for (const std::string& tangential : granular::law_names("tangential")) {
            const Entry base = entry_of(normal, tangential);
            CAPTURE(normal, tangential);
            CHECK_NOTHROW(collision(base.text()));
            for (const auto& [key, value] : values) {
                CAPTURE(key);
                std::vector<std::vector<double>> results;
                try {
                    for (const std::string& v : value) {
                        Entry changed = base;
                        changed.keys[key] = v;
                        results.push_back(collision(changed.text()));
                    }
                } catch (const io::InvalidInput& e) {
                    CHECK(std::string(e.what()).find("/laws/0/") != std::string::npos);
                    CHECK(std::string(e.what()).find(key) != std::string::npos);
                    ++refused;
                    continue;
                }
                ++effective;
                CHECK(results.at(0) != results.at(1));
            }
        }
    CHECK(refused > 30);
    CHECK(effective > 50);
}

TEST_CASE("laws of rolling and cohesion without their coefficient are refused", "[granular][case][laws]")
{
    for (const std::string& rolling : granular::law_names("rolling")) {
        Entry e = entry_of("hertz", "mindlin");
        e.rolling = rolling;
        if (rolling == "none") continue;
        CHECK_THROWS_WITH(collision(e.text()), Catch::Contains("mu_r"));
        e.own["rolling"] = R"("mu_r": 0.1)";
        CHECK_NOTHROW(collision(e.text()));
    }
    for (const std::string& cohesion : granular::law_names("cohesion")) {
        Entry e = entry_of("hertz", "none");
        e.cohesion = cohesion;
        if (cohesion == "none") continue;
        const std::string key = cohesion == "constant" ? "F_c" : "k";
        CHECK_THROWS_WITH(collision(e.text()), Catch::Contains(key));
        e.own["cohesion"] = '"' + key + "\": " + (key == "k" ? "1e4" : "1e-3");
        CHECK(collision(e.text()) != collision(entry_of("hertz", "none").text()));
    }
    Entry e = entry_of("hooke", "coulomb");
    e.own["tangential"] = R"("k_t": 8e3)";
    CHECK_THROWS_WITH(collision(e.text()), Catch::Contains("gamma_t"));
    e = entry_of("hooke", "none");
    e.own["normal"] += R"(, "gamma_n": 10)";
    e.keys["restitution"] = "0.5";
    CHECK_THROWS_WITH(collision(e.text()), Catch::Contains("exclude"));
}

TEST_CASE("hooke with a coefficient of restitution has it for all masses and stiffnesses",
          "[granular][case][laws]")
{
    const double e = GENERATE(0.1, 0.5, 0.9, 1.), radius = GENERATE(5e-4, 3e-3), k = GENERATE(1e3, 1e5);
    const double mass = 2500 * 4. / 3 * M_PI * radius * radius * radius;
    const double h = M_PI * std::sqrt(mass / 2 / k) / 400;
    std::ostringstream text;
    text << R"({"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [0.1, 0.1, 0.1]}, "gravity": [0, 0, 0],
        "step": )"
         << h << R"(, "end": 1, "materials": [{"name": "m", "density": 2500, "E": 1e7, "nu": 0.3}],
        "laws": [{"restitution": )"
         << e << R"(, "normal": {"law": "hooke", "k_n": )" << k
         << R"(}}], "particles": [{"r": [0.05, 0.05, 0.05],
        "radius": )"
         << radius << R"(, "v": [0.2, 0, 0]}, {"r": [)" << 0.05 + 2 * radius + 1e-9
         << R"(, 0.05, 0.05], "radius": )" << radius << "}]}";
    granular::Case c = read_case(text.str(), "case");
    c.world->step(1200);
    const auto all = c.world->particles();
    CAPTURE(e, radius, k);
    CHECK((all[1].v.x - all[0].v.x) / 0.2 == Approx(e).margin(0.01));
}

}  // namespace law_keys_test
