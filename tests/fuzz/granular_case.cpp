// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/case_file.hpp"
#include "granular/case/particles/fill.hpp"
#include "io/error.hpp"
#include "tests/fuzz/targets.hpp"

#include <string>

namespace hilda::fuzz {

namespace {

// Some thousands of particles at most, and no table from elsewhere
const granular::Environment environment{.memory = std::size_t{8} << 20, .folder = "/nowhere"};

const char* const small_case = R"({"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [0.02, 0.02, 0.02]},
 "step": 5e-6, "end": 1, "orientation": true,
 "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
 "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"},
           "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}}],
 "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1]}],
 "fill": [{"type": "hcp", "low": [0.003, 0.003, 0], "high": [0.009, 0.009, 0.005], "radius": 1e-3, "spacing": 1}]})";

std::string valid_checkpoint()
{
    const granular::Case c = granular::read_case(small_case, "case.json");
    c.world->step(20);
    return c.world->to_bytes("run");
}

}  // namespace

void granular_case(std::string_view input)
{
    try {
        const granular::Case c = granular::read_case(std::string(input), "case.json", environment);
        granular::insert_particles(c);
    } catch (const io::InvalidInput&) {
    } catch (const io::NumericalFailure&) {
    }
}

void granular_checkpoint(std::string_view input)
{
    static const std::string valid = valid_checkpoint();
    const granular::Case c = granular::read_case(small_case, "case.json");
    try {
        c.world->from_bytes(sealed(input, valid), "run", "checkpoint");
        c.world->step(2);
    } catch (const io::IoError&) {
    } catch (const io::NumericalFailure&) {  // a valid state that is not the saved one
    }
}

std::string granular_checkpoint_seed() { return std::string(content_of(valid_checkpoint())); }

void particles(std::string_view input)
{
    try {
        granular::particles_of_csv(std::string(input), "table.csv");
    } catch (const io::InvalidInput&) {
    }
}

}  // namespace hilda::fuzz
