// SPDX-License-Identifier: GPL-3.0-or-later
// Reading of case files: entries, defaults, changes of entries, and errors with their place.
#include "granular/case/case_file.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/world/output.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "tests/support/paths.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <cstdio>
#include <filesystem>
#include <regex>

using namespace hilda;
using granular::read_case;
using nlohmann::ordered_json;

namespace {

ordered_json good()
{
    return ordered_json::parse(R"({"hilda_case": 1,
 "domain": {"low": [0, 0, 0], "high": [1, 1, 1]}, "step": 1e-5, "end": 0.1,
 "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}, {"name": "steel", "density": 7800, "E": 2e11, "nu": 0.3}],
 "laws": [{"between": ["glass", "glass"], "restitution": 0.9, "mu": 0.3, "tangential": {"law": "mindlin"}},
          {"between": ["glass", "steel"], "restitution": 0.5, "normal": {"law": "hooke", "k_n": 1e4}}],
 "boundaries": [{"type": "plane", "normal": [0, 0, 2], "material": "steel"}],
 "particles": [{"r": [0.5, 0.5, 0.5], "radius": 0.1, "material": "glass"}]})");
}

/// The case with one entry changed
std::string with(const std::string& pointer, const ordered_json& value)
{
    ordered_json c = good();
    c[ordered_json::json_pointer(pointer)] = value;
    return c.dump();
}

/// Location of the value at a pointer in a text
std::string place(const std::string& text, const std::string& pointer)
{
    return io::JsonSource(text, "file").place(pointer);
}

/// Message of read_case without line and column; "nothing" if the case is accepted
std::string refusal(const std::string& text, const granular::Environment& environment = {})
{
    try {
        read_case(text, "file", environment);
        return "nothing";
    } catch (const io::InvalidInput& e) {
        static const std::regex place(R"(^file:\d+:\d+ \((/[^)]*)\))");
        return std::regex_replace(e.what(), place, "file: $1");
    }
}

}  // namespace

TEST_CASE("a case has the values of its file", "[granular][case]")
{
    const granular::Case c = read_case(good().dump(), "file");
    CHECK(c.h == 1e-5);
    const auto p = c.world->particles();
    REQUIRE(p.size() == 1);
    CHECK(p[0].r.z == 0.5);
    CHECK(c.boundaries == std::vector<std::string>{"boundary 0"});
}

TEST_CASE("the example case is valid", "[granular][case]")
{
    const std::string file = std::string(tests::source_dir) + "/granular/cases/bed.json";
    const granular::Case c = read_case(io::read_file(file, 10000), file);
    CHECK(c.world->count() > 5000);
    CHECK(c.boundaries == std::vector<std::string>{"box-x", "box+x", "box-y", "box+y", "box-z"});
}

TEST_CASE("a box consists of planes, without its open sides", "[granular][case]")
{
    ordered_json c = good();
    c["boundaries"][0] = {{"name", "bin"},           {"type", "box"},      {"low", {0.1, 0.2, 0.3}},
                          {"high", {0.9, 0.8, 0.7}}, {"r", {0, 0, 0.05}},  {"v", {0, 0, 2}},
                          {"open", {"+z", "-x"}},    {"material", "steel"}};
    granular::Case box = read_case(c.dump(), "file");
    CHECK(box.boundaries == std::vector<std::string>{"bin+x", "bin-y", "bin+y", "bin-z"});
    const double away[] = {0.4, 0.3, 0.3, 0.15};  // from the middle
    for (int k = 0; k < 4; ++k) {
        const granular::Boundary& b = box.world->boundary(k);
        CHECK(granular::nearest(b, {0.5, 0.5, 0.5}).distance == Approx(away[k]));
        CHECK(b.v.z == 2);
        CHECK(b.material == 1);
    }
}

TEST_CASE("boundaries move as their formulas prescribe", "[granular][case]")
{
    ordered_json c = good();
    const ordered_json plane = {{"type", "plane"}, {"normal", {0, 0, 1}}, {"material", "steel"}};
    c["step"] = 1e-3, c["materials"][0]["E"] = 7e3, c["gravity"] = {0, 0, 0};
    auto at = plane, by = plane, turning = plane, box = plane;
    at["r"] = {0, 0.5, "sin(9*t)"}, by["v"] = {0, 0, "9*cos(9*t)"}, turning["omega"] = {0, 0, "9*cos(9*t)"};
    at["normal"] = by["normal"] = turning["normal"] = {-1, 0, 0};
    at["r"][0] = 2, by["r"] = turning["r"] = {2, 0, 0};
    box = {{"type", "box"},
           {"low", {-3, -3, -3}},
           {"high", {3, 3, 3}},
           {"material", "steel"},
           {"r", {0, 0, "sin(9*t)"}}};
    c["boundaries"] = {at, by, turning, box};
    auto moving = read_case(c.dump(), "file");
    granular::World& w = *moving.world;
    CHECK(w.boundary(0).v.z == Approx(9).epsilon(1e-4));
    CHECK(w.boundary(1).v.z == Approx(9).epsilon(1e-4));
    for (int k = 0; k < 50; ++k) w.step(2);
    const double z = std::sin(0.9);
    CHECK(w.boundary(0).r.y == 0.5);
    CHECK(w.boundary(0).r.z == Approx(z).epsilon(1e-14));
    CHECK(w.boundary(1).r.z == Approx(z).epsilon(1e-5));  // h² 9²/24 = 3.4e-6
    // the angle is sin(9 t) as well
    CHECK(std::atan2(w.boundary(2).axis.y, w.boundary(2).axis.x) == Approx(z - M_PI).epsilon(1e-5));
    CHECK(w.boundary(3).r.z == Approx(z - 3).epsilon(1e-14));
    CHECK(w.boundary(8).r.z == Approx(z + 3).epsilon(1e-14));

    c["boundaries"] = {plane};
    const auto refused = [&](const char* key, const ordered_json& value, const std::string& message) {
        ordered_json wrong = c;
        wrong["boundaries"][0][key] = value;
        CHECK(refusal(wrong.dump()) == "file: /boundaries/0/" + message);
    };
    refused("v", {0, 0, "cos"},
            "v/2: the function 'cos' needs its arguments in parentheses in \"cos\" at column 1");
    refused("v", {0, "sin(9*t)"}, "v: v must be three numbers or expressions in t, got a list of 2");
    refused("v", {0, "sin(9*t)", nullptr},
            "v/2: a component must be a number or an expression in a string, got null");
    c["boundaries"][0]["r"] = {0, 0, "sin(9*t)"};
    refused("v", {0, 0, 1}, "v: v must be 0 or not be given if r is a formula, got [0, 0, 1]");
    refused("r", {0, 0, "1/t"}, "r: r must be finite at t = 0, got a list of 3");
    c["boundaries"][0]["r"] = {0, 0, -5}, c["boundaries"][0]["v"] = {0, 0, "1/t"};
    CHECK_NOTHROW(read_case(c.dump(), "file"));  // v is evaluated at the middle of a step
    c["boundaries"][0]["mass"] = 1;
    CHECK_THAT(
        refusal(c.dump()),
        Catch::StartsWith("file: /boundaries/0/v: v must be finite at t = 0 if the boundary has a mass"));
    c["boundaries"][0].erase("mass");
    c["boundaries"][0]["r"] = {0, 0, -5}, c["boundaries"][0]["v"] = {0, 0, "sqrt(min(0,0.05-t))"};
    auto bursting = read_case(c.dump(), "file");
    CHECK_THROWS_WITH(bursting.world->step(100),
                      Catch::StartsWith("boundary 'boundary 0': v is not finite at t = 0.0505 s, got ("));
}

TEST_CASE("a tool falls along its free axes and follows its formulas along the others", "[granular][case]")
{
    ordered_json c = good();
    c["step"] = 1e-3, c["materials"][0]["E"] = 7e3;
    c["boundaries"] = {{{"type", "plane"},
                        {"normal", {0, 0, -1}},
                        {"r", {0, 0, 20}},
                        {"material", "steel"},
                        {"mass", 3},
                        {"free", {false, false, true}},
                        {"v", {0.25, "30*t", "30*t"}},
                        {"F", {1, 2, "30*t"}}}};
    auto falling = read_case(c.dump(), "file");
    falling.world->step(10);
    const granular::Boundary& b = falling.world->boundary(0);
    CHECK(b.v.x == 0.25);
    CHECK(b.v.y == Approx(30 * 9.5e-3));
    CHECK(b.v.z == Approx(-9.81 * 0.01 + 30. / 3 * 1e-6 * 45));  // F at the beginnings of ten steps
    c["boundaries"][0].erase("mass");
    CHECK(refusal(c.dump()) == "file: /boundaries/0/free: free is only for a boundary with a mass, got none");
}

TEST_CASE("particles can have a replica and an applied force", "[granular][case]")
{
    ordered_json c = good();
    c["gravity"] = {0, 0, 0};
    c["particles"].push_back(c["particles"][0]);
    c["particles"][1]["replica"] = 2, c["particles"][1]["force"] = {0, 0, 1e-3};
    c["fill"] = {{{"type", "lattice"},
                  {"low", {0, 0, 0}},
                  {"high", {0.2, 0.2, 0.3}},
                  {"radius", 0.1},
                  {"material", "glass"},
                  {"replica", 1}}};
    auto all = read_case(c.dump(), "file");
    all.world->step(100);  // two particles are at the same position
    const auto p = all.world->particles();
    REQUIRE(p.size() == 3);
    CHECK(p[1].replica == 2);
    CHECK(p[2].replica == 1);
    CHECK(p[1].v.z == Approx(100 * 1e-5 * 1e-3 / p[1].mass));
    CHECK(p[0].v.z == 0);
    c["particles"][1]["replica"] = 65536;
    CHECK(refusal(c.dump()) == "file: /particles/1/replica: replica must be at most 65535, got 65536");
}

TEST_CASE("errors in a case are reported with their place and value", "[granular][case]")
{
    const std::tuple<std::string, ordered_json, std::string> wrong[] = {
        {"/hilda_case", 2, "/hilda_case: the version of the format must be 1, got 2"},
        {"/hilda_case", "1", "/hilda_case: hilda_case must be a number, got \"1\""},
        {"/step", 0, "/step: step must be positive, got 0"},
        {"/step", "1e-5", "/step: step must be a number, got \"1e-5\""},
        {"/steps", 5, "/steps: unknown key \"steps\"; did you mean 'step'?"},
        {"/domain/high", {1, 1}, "/domain/high: high must be a list of 3 numbers, got [1, 1]"},
        {"/domain/high/2", -1, "/domain/high/2: high must be above low, 0, got -1"},
        {"/domain/periodic", {true, 1, false}, "/domain/periodic/1: periodic must be true or false, got 1"},
        {"/interval", -1, "/interval: interval must be positive, got -1"},
        {"/every", -1, "/every: interval must be positive, got -1"},
        {"/laws/0/mu_s", 0.2, "/laws/0/mu_s: mu_s must not be less than mu, 0.3, got 0.2"},
        {"/laws/1/mu", -1, "/laws/1/mu: mu must not be negative, got -1"},
        {"/laws/1/rolling",
         {{"law", "epsd"}, {"mu_r", 0.1}, {"eta_r", 0}},
         "/laws/1: the tangential law must not be none with this rolling or spin law"},
        {"/boundaries/0/name", "a,b", "/boundaries/0/name: name must not contain commas and quotes"},
        {"/boundaries/0/name", "a\nb", "/boundaries/0/name: name must be a name without control characters"},
        {"/integrator", "euler",
         "/integrator: unknown integrator \"euler\"; allowed: symplectic-euler, velocity-verlet"},
        {"/integrator", "chang", "/integrator: unknown integrator \"chang\"; did you mean 'chung'?"},
        {"/materials/0/E", -7e7, "/materials/0/E: E must be positive, got -7e+07"},
        {"/materials/0/nu", 0.5, "/materials/0/nu: nu must be above -1 and below 0.5, got 0.5"},
        {"/materials/1/density", 0, "/materials/1/density: density must be positive, got 0"},
        {"/materials/1/name", "glass", "/materials/1/name: two materials have the same name, got \"glass\""},
        {"/laws/0/restitution", 1.2, "/laws/0/restitution: restitution must be from 0 to 1, got 1.2"},
        {"/laws/1/restitution", -1, "/laws/1/restitution: restitution must be from 0 to 1, got -1"},
        {"/laws/1/restitution", 7, "/laws/1/restitution: restitution must be from 0 to 1, got 7"},
        {"/laws/0/between/1", "brass", "/laws/0/between/1: no material has this name, got \"brass\""},
        {"/laws/0/between/1", "glas",
         "/laws/0/between/1: no material has this name, got \"glas\"; did you mean 'glass'?"},
        {"/laws/1/between",
         {"glass", "glass"},
         "/laws/1/between: two laws have the same materials, got \"glass\" and \"glass\"; first at file:"},
        {"/laws/1/between", {"glass", 1}, "/laws/1/between/1: between must be two names of materials, got 1"},
        {"/laws/0/tangential/law", "sticky",
         "/laws/0/tangential/law: unknown law \"sticky\"; allowed: none, coulomb, mindlin"},
        {"/laws/0/tangential/mu", 1, "/laws/0/tangential/mu: unknown key \"mu\""},
        {"/laws/1/normal/k_n", -1, "/laws/1/normal/k_n: k_n must be positive, got -1"},
        {"/boundaries/0/type", "wall",
         "/boundaries/0/type: unknown type \"wall\"; allowed: body, box, cone, cylinder, disk, frustum, "
         "mesh, plane, sphere, torus"},
        {"/boundaries/0/normal",
         {0, 0, 0},
         "/boundaries/0/normal: normal must have a direction, got [0, 0, 0]"},
        {"/particles/0/radius", -0.1, "/particles/0/radius: radius must be positive, got -0.1"},
        {"/particles/0/radius", 1e39,
         "/particles/0/radius: radius must be at most 3.4028234663852886e+38 in magnitude, got 1e+39"},
        {"/particles/0/omega",
         {0, -1e39, 0},
         "/particles/0/omega/1: omega must be at most 3.4028234663852886e+38 in magnitude, got -1e+39"},
        {"/particles/0/v",
         {1e39, 0, 0},
         "/particles/0/v/0: v must be at most 3.4028234663852886e+38 in magnitude"},
        {"/particles/0/force",
         {0, 0, 1e300},
         "/particles/0/force/2: force must be at most 3.4028234663852886e+38 in magnitude"},
        {"/materials/0/E", 1e300,
         "/materials/0/E: E must be at most 3.4028234663852886e+38 in magnitude, got 1e+300"},
        {"/materials/0/density", 1e-300,
         "/materials/0/density: density must be at least 1.1754943508222875e-38, got 1e-300"},
        {"/particles/0/radius", 1e20,
         "/particles/0: particle 0: the mass must be in the range of single precision, 1.2e-38 to 8.5e37 kg, "
         "got"},
        {"/particles/0/radius", 1e-20,
         "/particles/0: particle 0: the mass must be in the range of single precision, 1.2e-38 to 8.5e37 kg, "
         "got"},
        {"/particles/0/material", "wood", "/particles/0/material: no material has this name, got \"wood\""},
        {"/particles/0/material", 1, "/particles/0/material: material must be a string, got 1"},
        {"/particles/0/r", {0.5, nullptr, 0.5}, "/particles/0/r/1: r must be a number, got null"},
    };
    for (const auto& [pointer, value, message] : wrong) {
        INFO(pointer);
        CHECK_THAT(refusal(with(pointer, value)), Catch::StartsWith("file: " + message));
    }
    CHECK_THROWS_WITH(read_case("{\"a\": 1,\n\"b\": }", "file"),
                      "file:2:6 (/b): not JSON: unexpected '}'; expected a value");
    CHECK_THROWS_WITH(read_case("{\"a\": 1,\n\"b\": ", "file"),
                      "file:2:6 (/b): not JSON: unexpected end of the text; expected a value");
    CHECK_THROWS_WITH(read_case(R"({"hilda_case": 1, "step": 1, "step": 2})", "file"),
                      "file:1:30 (/step): the key \"step\" is given twice; first at file:1:19 (/)");
    CHECK_THROWS_WITH(read_case(good().dump() + std::string(1, '\0'), "file"),
                      Catch::EndsWith("not JSON: invalid literal, got byte 0; expected the end of the text"));
    CHECK_THROWS_WITH(read_case(good().dump() + "{}", "file"), Catch::Contains("not JSON: unexpected '{'"));
    CHECK_THROWS_AS(read_case(std::string(100000, '['), "file"), io::InvalidInput);
    CHECK_THROWS_AS(read_case(R"({"hilda_case": 1e400})", "file"), io::InvalidInput);
}

TEST_CASE("old names of keys are read with a notice, and written with the new name", "[granular][case]")
{
    ordered_json c = good();
    c["every"] = 2e-3, c["frames_every"] = 5e-3, c["checkpoint_every"] = 1e-2;
    const granular::Case old = read_case(c.dump(), "file");
    CHECK(old.interval == 2e-3);
    CHECK(old.frame_interval == 5e-3);
    REQUIRE(old.notices.size() == 4);
    CHECK(old.notices[3] ==
          place(c.dump(), "/checkpoint_every") +
              ": checkpoint_interval has no effect: a checkpoint can be written after every step");
    CHECK(old.notices[0] ==
          place(c.dump(), "/every") + ": every was renamed to interval; the old name is still read");
    const ordered_json written = ordered_json::parse(old.source.current_text());
    CHECK(written["interval"] == 2e-3);
    CHECK_FALSE(written.contains("every"));
    CHECK_FALSE(written.contains("checkpoint_interval"));
    CHECK(read_case(old.source.current_text(), "again").notices.empty());

    const granular::Environment set{.settings = {{"/every=0.01"}}};
    const granular::Case by_old_name = read_case(good().dump(), "file", set);
    CHECK(by_old_name.interval == 0.01);
    CHECK(by_old_name.notices.size() == 1);
    const granular::Environment by_new{.settings = {{"/interval=0.02", "--interval 0.02"}}};
    CHECK(read_case(c.dump(), "file", by_new).interval == 0.02);

    c["interval"] = 1e-3;
    CHECK(refusal(c.dump()) ==
          "file: /every: every is the old name of interval, which is given as well; remove one of them");
}

TEST_CASE("a randomly changed case is read or rejected", "[granular][case]")
{
    ordered_json c = good();
    c["fill"] = {{{"type", "poisson"},
                  {"low", {0, 0, 0.7}},
                  {"high", {1, 1, 1}},
                  {"radius", 0.1},
                  {"material", "glass"}}};
    c["boundaries"].push_back(
        {{"type", "box"}, {"low", {0, 0, 0}}, {"high", {1, 1, 1}}, {"open", {"+z"}}, {"material", "steel"}});
    const std::string text = c.dump(1);
    const auto seed = GENERATE(1u, 2u);
    unsigned state = seed;
    const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
    int refused = 0;
    for (int k = 0; k < 1000; ++k) {
        std::string wrong = text;
        for (unsigned n = 1 + random() % 3; n > 0; --n) {
            const std::size_t at = random() % wrong.size();
            switch (random() % 4) {
                case 0:
                    wrong[at] = static_cast<char>(random());
                    break;
                case 1:
                    wrong.erase(at, 1 + random() % 8);
                    break;
                case 2:
                    wrong.insert(at, 1, "0123456789-eE.,:[]{}\"\\ "[random() % 23]);
                    break;
                default:
                    wrong[at] = "0123456789-eE.,:[]{}\"\\ "[random() % 23];
            }
        }
        try {
            read_case(wrong, "file", {.memory = 20'000'000});
        } catch (const io::InvalidInput&) {
            ++refused;
        }
    }
    CHECK(refused > 500);
}

TEST_CASE("materials in contact need a law, and initial overlaps are limited", "[granular][case]")
{
    const auto begin = [](const std::string& text) { granular::insert_particles(read_case(text, "file")); };
    CHECK_NOTHROW(begin(good().dump()));
    const std::string other = with("/particles/0/material", "steel");
    CHECK_THROWS_WITH(begin(other), place(other, "/laws") +
                                        ": laws: no law is set between two materials that can be in contact, "
                                        "got 'steel' and 'steel'");
    ordered_json two = good();
    two["particles"].push_back({{"r", {0.5, 0.5, 0.685}}, {"radius", 0.1}, {"material", "glass"}});
    CHECK_THROWS_WITH(begin(two.dump()),
                      Catch::Contains(" (/particles/0): particle 0 and particle 1: must not overlap by more "
                                      "than 5 % of a radius at the start, got 0.015"));
    CHECK_THROWS_WITH(begin(with("/particles/0/r", {0.5, 0.5, 0.09})),
                      Catch::Contains(" (/particles/0): particle 0 and boundary 0: must not"));
    CHECK_THROWS_WITH(begin(with("/particles/0/r", {0.5, 0.5, 1.5})),
                      Catch::Contains(" (/particles/0): particle 0: is outside the domain along z, got 1.5"));
    two["particles"][1]["r"] = {0.5, 0.5, 0.75};
    ordered_json filling = {{"type", "lattice"},
                            {"low", {0, 0, 0.8}},
                            {"high", {0.4, 0.4, 1.5}},
                            {"radius", 0.05},
                            {"material", "glass"}};
    two["fill"] = {filling, filling};
    two["fill"][0]["high"][2] = 1, two["fill"][1]["low"][0] = 0.5, two["fill"][1]["high"][0] = 1;
    CHECK_THROWS_WITH(begin(two.dump()), Catch::Contains(" (/fill/1): particle ") &&
                                             Catch::Contains("is outside the domain along z"));
}

TEST_CASE("entries of a case can be changed, and errors state the option", "[granular][case]")
{
    ordered_json c = good();
    const ordered_json filling = {{"type", "lattice"}, {"low", {0, 0, 0.7}}, {"high", {1, 1, 1}},
                                  {"radius", 0.1},     {"jitter", 1},        {"material", "glass"}};
    c["fill"] = {filling, filling};
    const auto set = [&](const std::string& pointer, const std::string& value) {
        return granular::Environment{.settings = {{pointer + '=' + value}}};
    };
    const granular::Case plain = read_case(c.dump(), "file");
    CHECK(plain.source.current_text() == c.dump());  // the text is unchanged
    CHECK(read_case(c.dump(), "file", set("/end", "0.25")).end == 0.25);
    CHECK(read_case(c.dump(), "file", set("/name", "a heap")).name == "a heap");
    CHECK(read_case(c.dump(), "file", set("/gravity", "[0, 0, 1]"))
              .source.root.member("gravity")
              ->value.at(2)
              .number() != nullptr);
    const granular::Case moved = read_case(c.dump(), "file", set("/particles/0/r/2", "0.25"));
    CHECK(moved.world->particles()[0].r.z == 0.25);
    CHECK(read_case(moved.source.current_text(), "again").world->particles()[0].r.z == 0.25);

    const std::tuple<std::string, std::string, std::string> wrong[] = {
        {"/materials/1/E=-1", "/materials/1/E",
         "E must be positive, got -1 (from --set \"/materials/1/E=-1\")"},
        {"/boundaries/0={\"type\": \"plane\"}", "/boundaries/0",
         "missing key 'material' (from --set \"/boundaries/0={\\\"type\\\": \\\"plane\\\"}\")"},
        {"/materials/2/E=1", "/materials", "--set \"/materials/2/E=1\": there is no \"2\" in a list of 2"},
        {"/materials/-1/E=1", "/materials", "--set \"/materials/-1/E=1\": there is no \"-1\" in a list of 2"},
        {"/step/h=1", "/step", "--set \"/step/h=1\": there is no \"h\" in 1e-05"},
        {"/a~b=1", "", "--set \"/a~b=1\": '~' is written ~0 in a pointer, and '/' in a key is ~1"},
        {"step=1", "", "--set \"step=1\": must be /json/pointer=VALUE"}};
    for (const auto& [change, pointer, message] : wrong)
        CHECK_THROWS_WITH(read_case(c.dump(), "file", {.settings = {{change}}}),
                          place(c.dump(), pointer) + ": " + message);
    CHECK_THROWS_WITH(read_case(c.dump(), "file", set("/end", "{\"a\": 1, \"a\": 2}")),
                      Catch::Contains("the key \"a\" is given twice"));
    CHECK_THROWS_WITH(read_case(c.dump(), "file", set("/name", "\xff")), Catch::EndsWith("must be UTF-8"));
    CHECK_THROWS_WITH(read_case(c.dump(), "file", {.settings = {{"/end=-1", "--end -1"}}}),
                      place(c.dump(), "/end") + ": end must be positive, got -1 (from --end -1)");
    CHECK_THROWS_WITH(read_case(c.dump(), "file", set("/end", "1e400")),
                      Catch::Contains("got \"1e400\" (from --set"));

    // equal fills get different seeds
    granular::Environment seeded{.seed = 7};
    const granular::Case sown = read_case(c.dump(), "file", seeded);
    const io::Json& fill = sown.source.root.member("fill")->value;
    CHECK(*fill.at(0).member("seed")->value.number() == 7);
    CHECK(*fill.at(1).member("seed")->value.number() == 8);
    const auto p = sown.world->particles();
    CHECK_FALSE(p[1].r == p[1 + (p.size() - 1) / 2].r);
    CHECK_FALSE(p[1].r == plain.world->particles()[1].r);
    CHECK(read_case(good().dump(), "file", seeded).notices.size() == 1);  // the case has no fill
}

TEST_CASE("step limits are the Rayleigh time and the duration of a collision", "[granular][case]")
{
    const granular::Case c = read_case(good().dump(), "file");
    const double G = 7e7 / (2 * 1.24);
    CHECK(c.world->step_limits().rayleigh ==
          Approx(M_PI * 0.1 * std::sqrt(2500 / G) / (0.1631 * 0.24 + 0.8766)));
    // glass on glass at 0.1 m/s, shorter than with the linear law of steel (Johnson 1985, Sec. 11.4)
    const double m_eff = 2500 * 4. / 3 * M_PI * 1e-3 / 2, R_eff = 0.05, E_eff = 7e7 / (2 * (1 - 0.24 * 0.24));
    const double collision = 2.87 * std::pow(m_eff * m_eff / (R_eff * E_eff * E_eff * 0.1), 0.2);
    CHECK(c.world->step_limits().collision == Approx(collision).epsilon(1e-6));
    CHECK(collision < M_PI * std::sqrt(m_eff / 1e4));
}

TEST_CASE("a restitution of zero is raised to 1e-7 with a notice", "[granular][case]")
{
    const granular::Case c = read_case(with("/laws/0/restitution", 0), "file");
    REQUIRE(c.notices.size() == 1);
    CHECK(c.notices[0] == place(with("/laws/0/restitution", 0), "/laws/0/restitution") +
                              ": 0 is replaced by 1e-7, because the damping of 0 is infinite");
}

TEST_CASE("a case that exceeds the available memory is rejected before memory is allocated",
          "[granular][case]")
{
    ordered_json c = good();
    c["fill"] = {{{"type", "lattice"},
                  {"low", {0, 0, 0}},
                  {"high", {1, 1, 1}},
                  {"radius", 5e-6},
                  {"material", "glass"},
                  {"spacing", 1}}};
    CHECK_THAT(refusal(c.dump(), {.memory = 64'000'000'000}),
               Catch::StartsWith("file: /fill: 1e+15 particles need about ") &&
                   Catch::EndsWith(" GB of memory; 64 GB are available"));
    CHECK_THAT(refusal(c.dump(), {.device_memory = 64'000'000'000}),
               Catch::EndsWith(" GB of memory of the GPU; 64 GB are available"));
    c["fill"][0]["count"] = 100;
    CHECK_NOTHROW(read_case(c.dump(), "file", {.memory = 64'000'000'000}));
    CHECK_THAT(refusal(c.dump(), {.memory = 10'000}),
               Catch::StartsWith("file: /fill: 101 particles need about ") &&
                   Catch::EndsWith(" GB of memory; 1e-05 GB are available"));
    c["domain"]["high"] = {1, 1, 1e4};
    c["fill"][0]["low"] = {0, 0, 0.7};
    c["particles"] = ordered_json::array();
    CHECK_THAT(refusal(c.dump(), {.memory = 64'000'000'000}),
               Catch::StartsWith("file: /domain: ") && Catch::Contains("cells need about"));
}

TEST_CASE("a run can start from the particle table of another run", "[granular][fill]")
{
    ordered_json c = good();
    c["orientation"] = true;
    c["particles"].push_back({{"r", {0.3, 0.2, 1. / 3}},
                              {"radius", 0.05},
                              {"material", "steel"},
                              {"v", {0.1, 1. / 7, 1}},
                              {"omega", {1e-3, 1, 1. / 3}},
                              {"orientation", {0.6, 0, 0.8, 0}}});
    c["laws"].push_back({{"between", {"steel", "steel"}}, {"restitution", 0.5}});
    granular::Case first = read_case(c.dump(), "file");
    first.world->step(500);
    const std::string table = particles_csv(*first.world);
    const auto listed = granular::particles_of_csv(table, "table");
    const auto there = first.world->particles();
    REQUIRE(listed.size() == there.size());
    for (std::size_t k = 0; k < there.size(); ++k) {
        CHECK(listed[k].r == there[k].r);
        CHECK(listed[k].v == there[k].v);
        CHECK(listed[k].omega == there[k].omega);
        CHECK(listed[k].e == there[k].e);
        CHECK(listed[k].radius == there[k].radius);
        CHECK(listed[k].material == there[k].material);
    }

    const std::string file =
        std::filesystem::temp_directory_path() / ("hilda-table-" + std::to_string(getpid()) + ".csv");
    io::write_file(file, table);
    c.erase("particles");
    c["fill"] = {{{"type", "csv"}, {"file", file}}};
    granular::Case next = read_case(c.dump(), "file");
    next.world->step(0);
    const auto begun = next.world->particles();
    REQUIRE(begun.size() == there.size());
    for (std::size_t k = 0; k < there.size(); ++k) {
        CHECK((begun[k].r - there[k].r).norm() < 1e-12);
        CHECK((begun[k].v - there[k].v).norm() <= 1e-9 * there[k].v.norm());
    }
    io::write_file(file, table + "1,2\n");
    CHECK_THAT(refusal(c.dump()),
               Catch::StartsWith("file: /fill/0/file: " + file + ':') &&
                   Catch::Contains("a row must have a field for each of the 16 columns, got 2"));
    std::remove(file.c_str());
    CHECK_THAT(refusal(c.dump()), Catch::StartsWith("file: /fill/0/file: " + file + ": does not exist"));
}

TEST_CASE("an invalid particle table is rejected with its line", "[granular][fill]")
{
    const std::tuple<const char*, const char*> wrong[] = {
        {"", "t: contains no particles"},
        {"x,y,z,radius\n", "t: contains no particles"},
        {"x,y,radius\n1,2,3\n", "t:2: missing column z; the columns are 'x', 'y', 'radius'"},
        {"x;y;z;radius\n1;2;3;1\n",
         "t:1: the names of the columns are separated by semicolons; a table has commas, and points in its "
         "numbers"},
        {"x,y,z,radius\n1,2,3,1\n\n1,2,three,1\n", "t:4: z must be a finite number, got 'three'"},
        {"x,y,z,radius\n1,2,nan,1\n", "t:2: z must be a finite number, got 'nan'"},
        {"x,y,z,radius\n1,2,3,-1\n", "t:2: radius must be positive, got -1"},
        {"x,y,x,z,radius\n1,2,3,4,1\n", "t:1: two columns have the same name, got 'x'"},
        {"x,y,z,radius,vx\n1,2,3,1,0\n",
         "t:2: missing column vy; the columns are 'x', 'y', 'z', 'radius', 'vx'"},
        {"x,y,z,radius,vz\n1,2,3,1,-2\n",
         "t:2: missing column vx; the columns are 'x', 'y', 'z', 'radius', 'vz'"},
        {"x,y,z,radius,omega_y\n1,2,3,1,5\n",
         "t:2: missing column omega_x; the columns are 'x', 'y', 'z', 'radius', 'omega_y'"},
        {"x,y,z,radius,e3\n1,2,3,1,1\n",
         "t:2: missing column e0; the columns are 'x', 'y', 'z', 'radius', 'e3'"},
        {"x,y,z,radius,material\n1,2,3,1,0.5\n", "t:2: material must be the number of a material, got '0.5'"},
        {"x,y,z,radius\n1,2,3\n", "t:2: a row must have a field for each of the 4 columns, got 3"}};
    for (const auto& [table, message] : wrong)
        CHECK_THROWS_WITH(granular::particles_of_csv(table, "t"), message);
    const auto all = granular::particles_of_csv("\r\n radius , z,y,x,colour\r\n1, 4,3 ,2,red\r\n", "t");
    REQUIRE(all.size() == 1);
    CHECK(all[0].r == granular::Vec3{2, 3, 4});
}

TEST_CASE("particles of a fill do not overlap and are within its box", "[granular][fill]")
{
    const std::string type = GENERATE("lattice", "hcp", "poisson");
    granular::FillSpec f;
    f.type = io::Registry<granular::FillType>::find(type);
    f.low = {0, 0, 0}, f.high = {0.02, 0.02, 0.02};
    f.radius = 1e-3, f.sizes = granular::Sizes(1e-3), f.spacing = 2e-3 * (type == "hcp" ? 1 : 1.05),
    f.jitter = 1;
    const auto all = granular::fill(f);
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const double c : {all[i].r.x, all[i].r.y, all[i].r.z}) REQUIRE((c >= 1e-3 && c <= 0.019));
        for (std::size_t j = i + 1; j < all.size(); ++j)
            REQUIRE((all[i].r - all[j].r).norm() > 2e-3 * (1 - 1e-12));
    }
    const double packing = static_cast<double>(all.size()) * 4 / 3 * M_PI * 1e-9 / 8e-6;
    CHECK(packing > (type == "hcp" ? 0.55 : type == "lattice" ? 0.37 : 0.2));
    CHECK(granular::fill(f)[5].r == all[5].r);
    // alternate rows and layers of a crystal may have one particle less
    CHECK(granular::estimated_count(f) == Approx(double(all.size())).epsilon(0.12));
    f.max_count = 7;
    const auto some = granular::fill(f);
    REQUIRE(some.size() == 7);
    CHECK(some[6].r.z == all[6].r.z);
}
