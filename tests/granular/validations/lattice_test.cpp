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
    const std::vector<LatticeResponse> pressed =
        run_lattices(of, {.h = 5e-5, .settle = 0.8, .ramp = 0.2, .hold = 0.2});
    for (std::size_t n = 0; n < of.size(); ++n) {
        const LatticeResponse::BoundaryForces& now = pressed[n].after;
        const auto share = pressed[n].share(of[n].F);
        const double floor = std::accumulate(now.floor.begin(), now.floor.end(), 0.);
        CHECK(floor + now.sides == Approx(lattice::spheres + of[n].F).epsilon(2e-3));
        for (int k = 1; k <= lattice::middle; ++k)
            CHECK(share[lattice::middle + k] == Approx(share[lattice::middle - k]).margin(2e-3));
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
    const LatticeRun run{.h = 5e-5, .settle = 0.02, .ramp = 0.01, .hold = 0.01};
    const std::vector<LatticeResponse> whole = run_lattices(of, run);
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
        CHECK(saves == 20);
        CHECK(resumed[0].after.floor == whole[0].after.floor);
        CHECK(resumed[0].before.floor == whole[0].before.floor);
        CHECK(resumed[0].before.kinetic == whole[0].before.kinetic);
        CHECK(resumed[0].displacement == whole[0].displacement);
    }
}
