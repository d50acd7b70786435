// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/checkpoint.hpp"

#include "dae/model_file.hpp"
#include "io/archive.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using namespace hilda::run;
using namespace hilda::studies;

namespace {

Checkpoint some_checkpoint()
{
    Checkpoint c;
    c.settings = {{"model", "0123"}, {"--integrator", "rA-half-1"}};
    c.node.t = 0.1;
    c.node.body.resize(2);
    c.node.body[1].r = {1, 2, 3};
    c.node.alpha = Eigen::VectorXd::LinSpaced(6, -1, 2);
    c.node.lambda = Eigen::VectorXd::LinSpaced(5, 0, 1);
    c.node.discrete_state = {1, -2};
    c.node.internal_state = {0.1, -1e-300, 7};
    c.number = 100;
    c.iterations = 3;
    c.pivots = c.node;
    c.statistics = {100, 250, 3, 97, 0};
    c.invariants = {100, 11, 1.5, 1.25, 0.25, 1e-12, 1e-15, {{1, 2, 3e-15}, {-4, 5, 6}}};
    c.last_step = {1, 2000, 3e-11};
    c.sinks = {{"trajectory", "12345"}, {"steps", std::string("67\0", 3)}};
    c.wall_seconds = 0.5;
    return c;
}

}  // namespace

TEST_CASE("a checkpoint is read as it was written", "[run][checkpoint]")
{
    const Checkpoint c = some_checkpoint(), back = from_bytes(to_bytes(c), "file");
    CHECK(to_bytes(back) == to_bytes(c));
    CHECK(back.settings == c.settings);
    CHECK(back.node.t == c.node.t);
    CHECK(back.node.body[1].r == c.node.body[1].r);
    CHECK(back.node.alpha == c.node.alpha);
    CHECK(back.node.lambda == c.node.lambda);
    CHECK(back.node.discrete_state == c.node.discrete_state);
    CHECK(back.node.internal_state == c.node.internal_state);
    CHECK(back.number == c.number);
    CHECK(back.statistics.refactorizations == c.statistics.refactorizations);
    CHECK(back.invariants.energy_drift == c.invariants.energy_drift);
    CHECK(back.invariants.nodes == c.invariants.nodes);
    REQUIRE(back.invariants.contact.size() == 2);
    CHECK(back.invariants.contact[1].F_N_least == -4);
    CHECK(back.last_step.correction == c.last_step.correction);
    CHECK(back.sinks == c.sinks);
    CHECK(back.wall_seconds == c.wall_seconds);
}

TEST_CASE("each flipped bit and each truncation of a checkpoint is detected", "[run][checkpoint]")
{
    const std::string good = to_bytes(some_checkpoint());
    for (size_t k = 0; k < 8 * good.size(); ++k) {
        std::string bad = good;
        bad[k / 8] = static_cast<char>(bad[k / 8] ^ (1 << k % 8));
        REQUIRE_THROWS_AS(from_bytes(bad, "file"), io::IoError);
    }
    for (size_t length = 0; length < good.size(); ++length)
        REQUIRE_THROWS_AS(from_bytes(good.substr(0, length), "file"), io::IoError);
    REQUIRE_THROWS_AS(from_bytes(good + "x", "file"), io::IoError);

    std::mt19937 random(1);
    for (int k = 0; k < 1000; ++k) {
        std::string noise(random() % 500, '\0');
        for (char& c : noise) c = static_cast<char>(random());
        REQUIRE_THROWS_AS(from_bytes(noise, "file"), io::IoError);
    }
}

TEST_CASE("the last two checkpoints are stored", "[run][checkpoint]")
{
    const tests::Scratch in;
    const std::string directory = in.path.string();
    io::CheckpointFiles files(directory);
    long loaded = 0;
    const auto load = [&] {
        return files.load([&](const std::string& bytes, const std::string& file) {
            loaded = from_bytes(bytes, file).number;
        });
    };
    CHECK_FALSE(load());
    Checkpoint c = some_checkpoint();
    for (const long number : {1, 2, 3}) {
        c.number = number;
        files.save(to_bytes(c));
        CHECK(load());
        CHECK(loaded == number);
    }
    CHECK(from_bytes(tests::read(in / "checkpoint.1"), "file").number == 2);

    tests::fs::remove(in / "checkpoint");  // as after a kill between the two renamings
    CHECK(load());
    CHECK(loaded == 2);
    files.remove();
    CHECK(tests::fs::is_empty(in.path));
}

TEST_CASE("a checkpoint that does not fit the model is rejected", "[run][checkpoint]")
{
    dae::Description d = dae::read_model(problem("ball_in_bowl").model, "ball_in_bowl");
    dae::start(d);
    Checkpoint good;
    good.node = d.x;
    const auto check = [&](const Checkpoint& c) { check_fits(c, *d.model, d.x, "file"); };
    CHECK_NOTHROW(check(good));
    Checkpoint c = good;
    c.node.body.emplace_back();
    CHECK_THROWS_WITH(check(c), "file: the checkpoint does not fit the model: wrong length of the state");
    c = good;
    c.contacts.events = {{.contact = 1}};
    CHECK_THROWS_AS(check(c), io::IoError);
    c = good;
    c.pivots.body.resize(3);
    CHECK_THROWS_AS(check(c), io::IoError);
    c = good;
    c.number = -1;
    CHECK_THROWS_AS(check(c), io::IoError);
    c = good;
    c.invariants.contact.resize(2);
    CHECK_THROWS_AS(check(c), io::IoError);
}
