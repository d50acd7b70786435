// SPDX-License-Identifier: GPL-3.0-or-later
// What a case accepts: columns of tables, overlaps at the start, rounding errors of an inertia, ranges of
// forces.
#include "granular/case/case_file.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/world/watch.hpp"
#include "granular/world/world.hpp"
#include "io/error.hpp"
#include "io/json.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace hilda;
using hilda::granular::read_case;

namespace tolerances_test {

namespace {

std::string case_of(const std::string& more, double E = 1e7, double size = 1)
{
    return R"({"hilda_case": 1, "domain": {"low": [)" + io::shortest(-size) + ", " + io::shortest(-size) +
           ", " + io::shortest(-size) + R"(], "high": [)" + io::shortest(size) + ", " + io::shortest(size) +
           ", " + io::shortest(size) +
           R"(]}, "step": 1e-5, "end": 0.01, "materials": [{"name": "m", "density": 2500, "E": )" +
           io::shortest(E) +
           R"(, "nu": 0.3}], "laws": [{"restitution": 0.5, "mu": 0.4, "tangential": {"law": "mindlin"}}], )" +
           more + '}';
}

}  // namespace

TEST_CASE("a column without effect is named, with the column that is meant", "[granular][case]")
{
    for (const auto& [column, meant] : {std::pair{"wx", "omega_x"},
                                        {"wz", "omega_z"},
                                        {"omega_X", "omega_x"},
                                        {"omegay", "omega_y"},
                                        {"v_x", "vx"},
                                        {"Vz", "vz"},
                                        {"materials", "material"},
                                        {"E0", "e0"}}) {
        std::vector<std::string> unknown;
        granular::particles_of_csv(std::string("x,y,z,radius,") + column + "\n0,0,0,1,1\n", "t.csv",
                                   &unknown);
        REQUIRE(unknown.size() == 1);
        CHECK(unknown[0].find("t.csv:1: the column '" + std::string(column) + "'") == 0);
        CHECK(unknown[0].find("did you mean '" + std::string(meant) + "'?") != std::string::npos);
    }
    std::vector<std::string> unknown;
    granular::particles_of_csv(
        "id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z,e0,e1,e2,e3\n"
        "0,0,1,0,0,0,0,0,0,0,0,0,1,0,0,0\n",
        "t.csv", &unknown);
    CHECK(unknown.empty());
    granular::particles_of_csv("x,y,z,radius,colour\n0,0,0,1,red\n", "t.csv", &unknown);
    CHECK(unknown == std::vector<std::string>{"t.csv:1: the column 'colour' has no effect"});
}

TEST_CASE("start_overlap is the largest overlap at the start", "[granular][case]")
{
    const double allowed = GENERATE(0.02, 0.05, 0.2, 0.5), overlap = GENERATE(0.01, 0.1, 0.4);
    CAPTURE(allowed, overlap);
    granular::Case c =
        read_case(case_of("\"start_overlap\": " + io::shortest(allowed) +
                          R"(, "particles": [{"r": [0, 0, 0], "radius": 0.01}, {"r": [)" +
                          io::shortest(0.02 - 0.01 * overlap) + R"(, 0, 0], "radius": 0.01}])"),
                  "case");
    CHECK(c.notices.size() == (allowed > 0.05 ? 1 : 0));
    if (overlap < allowed)
        CHECK_NOTHROW(insert_particles(c));
    else
        CHECK_THROWS_AS(insert_particles(c), io::InvalidInput);
    CHECK_THROWS_AS(read_case(case_of("\"start_overlap\": 0.6"), "case"), io::InvalidInput);
}

TEST_CASE("a run ends above largest_overlap", "[granular][case]")
{
    // Two particles approach with a spring that stops them at an overlap of 0.7 of their radius.
    const auto run = [](const std::string& key) {
        constexpr double R = 0.01, v = 1;
        const double m = 2500 * 4. / 3 * std::numbers::pi * R * R * R,
                     k = m / 2 * std::pow(2 * v / (0.7 * R), 2);
        std::string text =
            case_of(key + R"("particles": [{"r": [-0.0101, 0, 0], "radius": 0.01, "v": [1, 0, 0]}, )"
                          R"({"r": [0.0101, 0, 0], "radius": 0.01, "v": [-1, 0, 0]}])");
        const std::string law = R"("restitution": 0.5, "mu": 0.4, "tangential": {"law": "mindlin"})";
        text.replace(text.find(law), law.size(),
                     R"("normal": {"law": "hooke", "k_n": )" + io::shortest(k) + '}');
        granular::Case c = read_case(text, "case");
        insert_particles(c);
        c.world->step(2000);
        return c.world->watch().largest_overlap;
    };
    CHECK_THROWS_AS(run(""), granular::OverlapTooLarge);
    CHECK_THROWS_AS(run("\"largest_overlap\": 0.65, "), granular::OverlapTooLarge);
    CHECK(run("\"largest_overlap\": 0.75, ") == Approx(0.7).epsilon(0.02));
    CHECK_THROWS_AS(read_case(case_of("\"largest_overlap\": 1.1"), "case"), io::InvalidInput);
    CHECK_THROWS_AS(read_case(case_of("\"largest_overlap\": 0.3, \"start_overlap\": 0.4"), "case"),
                    io::InvalidInput);
    CHECK(read_case(case_of("\"largest_overlap\": 0.6"), "case").notices.size() == 1);
}

TEST_CASE("an inertia may have rounding errors", "[granular][case]")
{
    const double error = GENERATE(0., 1e-16, 1e-13, 1e-9);
    const std::string text = case_of(
        R"("boundaries": [{"name": "b", "type": "sphere", "r": [0, 0, 0], "radius": 0.1, "mass": 1, "inertia":
            [[1e-3, 2e-4, 0], [)" +
        io::shortest(2e-4 + error * 1e-3) + R"(, 1e-3, 1e-5], [0, 1e-5, 1e-3]]}])");
    if (error < 1e-10)
        CHECK_NOTHROW(read_case(text, "case"));
    else
        CHECK_THROWS_WITH(read_case(text, "case"), Catch::Contains("symmetric"));
}

TEST_CASE("forces outside the range of single precision are refused", "[granular][case]")
{
    struct Scale {
        double radius, E;
        bool fits;
    };
    const auto s = GENERATE(Scale{1e5, 2.5e15, false}, Scale{1e5, 1e8, true}, Scale{1e-9, 1e9, true},
                            Scale{1e-3, 7e10, true}, Scale{1e3, 1e9, true}, Scale{1e6, 1e16, false});
    CAPTURE(s.radius, s.E);
    granular::Case c =
        read_case(case_of(R"("particles": [{"r": [0, 0, 0], "radius": )" + io::shortest(s.radius) + "}]", s.E,
                          10 * s.radius),
                  "case");
    if (s.fits)
        CHECK_NOTHROW(insert_particles(c));
    else
        CHECK_THROWS_WITH(insert_particles(c), Catch::Contains("range of single precision"));
}

}  // namespace tolerances_test
