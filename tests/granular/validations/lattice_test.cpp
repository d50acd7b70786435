// SPDX-License-Identifier: GPL-3.0-or-later
// Floor forces of a lattice of spheres under a point load.                           Fang (2022), Sec. 7.2.1
#include "granular/validations/lattice.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <stdexcept>

using namespace hilda::granular;

TEST_CASE("floor and walls carry the weight and the load of a lattice, with friction below the load (long)",
          "[granular][lattice]")
{
    const std::vector<LoadCase> of = {{Stiffness::linear, 0.2, 5}, {Stiffness::linear, 0, 20}};
    const std::vector<LatticeResponse> pressed = run_lattices(of, {.h = 5e-5, .ramp = 0.2});
    for (std::size_t n = 0; n < of.size(); ++n) {
        const LatticeResponse::BoundaryForces& now = pressed[n].after;
        const auto share = pressed[n].share(of[n].F);
        const double floor = std::accumulate(now.floor.begin(), now.floor.end(), 0.);
        CHECK(floor + now.sides == Approx(lattice::spheres + of[n].F).epsilon(1e-5));
        for (int k = 1; k <= lattice::middle; ++k)
            CHECK(share[lattice::middle + k] == Approx(share[lattice::middle - k]).margin(2e-4));
        const auto peak = std::max_element(share.begin(), share.end()) - share.begin();
        const double centre = share[lattice::middle];
        if (of[n].mu > 0) {
            CHECK(std::abs(peak - lattice::middle) <= 1);
            CHECK(centre == Approx(0.065).margin(0.005));
        } else {
            CHECK(std::abs(peak - lattice::middle) >= 5);
            CHECK(std::abs(peak - lattice::middle) <= 7);
            CHECK(centre < 0.03);
        }
    }
}

TEST_CASE("an interrupted run of lattices continues from its last state with the same results",
          "[granular][lattice]")
{
    const std::vector<LoadCase> of = {{Stiffness::linear, 0.2, 5}};
    // 0.02 s of free fall, stopped at once: the lattice counts as settled, which is not the point here
    const LatticeRun run{.h = 5e-5, .fall = 0.02, .ramp = 0.01, .kinetic = 1e3, .save_every = 2};
    int all_saves = 0;
    LatticeRun counted = run;
    counted.kept.save = [&](const std::string&) { ++all_saves; };
    const std::vector<LatticeResponse> whole = run_lattices(of, counted);
    REQUIRE(all_saves > 14);
    for (const int interrupted_at : {3, 14}) {  // before and after the load begins
        CAPTURE(interrupted_at);
        std::string saved;
        int saves = 0;
        LatticeRun part = run;
        part.kept.save = [&](const std::string& bytes) {
            saved = bytes;
            if (++saves == interrupted_at) throw std::runtime_error("interrupted");
        };
        CHECK_THROWS_AS(run_lattices(of, part), std::runtime_error);
        part.kept.load = [&](const auto& read) { read(saved, "checkpoint"); };
        part.kept.save = [&](const std::string&) { ++saves; };
        const std::vector<LatticeResponse> resumed = run_lattices(of, part);
        CHECK(saves == all_saves);
        CHECK(resumed[0].after.floor == whole[0].after.floor);
        CHECK(resumed[0].before.floor == whole[0].before.floor);
        CHECK(resumed[0].before.kinetic == whole[0].before.kinetic);
        CHECK(resumed[0].displacement == whole[0].displacement);
    }
}

TEST_CASE("a lattice that does not settle in the given time ends the run", "[granular][lattice]")
{
    const std::vector<LoadCase> of = {{Stiffness::linear, 0, 5}};
    CHECK_THROWS_WITH(run_lattices(of, {.h = 5e-5, .fall = 0.01, .longest = 0.01}),
                      Catch::Contains("lattice 0 (mu = 0, F = 5 mg) has not settled after 0.01 s"));
}
