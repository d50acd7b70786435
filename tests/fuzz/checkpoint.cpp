// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/checkpoint.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "io/error.hpp"
#include "tests/fuzz/targets.hpp"

namespace hilda::fuzz {

namespace {

const dae::Description& pendulum()
{
    static const dae::Description d = [] {
        dae::Description read = dae::read_model(R"({"hilda_model": 1, "name": "pendulum", "end": 1,
 "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0]}],
 "constraints": [{"name": "pin", "type": "spherical", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0]}]})",
                                                "pendulum.json");
        dae::start(read);
        return read;
    }();
    return d;
}

run::Checkpoint valid_checkpoint()
{
    run::Checkpoint c;
    c.settings = {{"model", "0123"}, {"--integrator", "rA-half-1"}};
    c.end = 1, c.interval = 10;
    c.node = c.pivots = pendulum().x;
    c.sinks = {{"trajectory", "12345"}};
    return c;
}

}  // namespace

void checkpoint(std::string_view input)
{
    static const std::string valid = to_bytes(valid_checkpoint());
    try {
        const run::Checkpoint c = run::from_bytes(sealed(input, valid), "checkpoint");
        check_fits(c, *pendulum().model, pendulum().x, "checkpoint");
        to_bytes(c);
    } catch (const io::IoError&) {
    }
}

std::string checkpoint_seed() { return std::string(content_of(to_bytes(valid_checkpoint()))); }

}  // namespace hilda::fuzz
