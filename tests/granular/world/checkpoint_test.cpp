// SPDX-License-Identifier: GPL-3.0-or-later
// A world restored from a checkpoint continues with bitwise identical results; damaged checkpoints are
// rejected.
#include "tests/support/grains.hpp"

#include "granular/case/case_file.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <cstring>

using namespace hilda;
using namespace hilda::tests;

namespace checkpoint_test {

namespace {

const char* const bed = R"({"hilda_case": 1,
 "domain": {"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.06]},
 "step": 5e-6, "end": 1,
 "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
 "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"},
           "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}}],
 "boundaries": [
  {"name": "floor", "type": "plane", "normal": [0, 0, 1]},
  {"name": "wall", "type": "cylinder", "r": [0.01, 0.01, 0], "axis": [0, 0, 1], "radius": 0.01, "inside": true}],
 "fill": [{"type": "lattice", "low": [0.003, 0.003, 0], "high": [0.017, 0.017, 0.03], "radius": 1e-3,
           "least_radius": 6e-4, "spacing": 1.02, "jitter": 1, "random_v": 0.2}]})";

bool same(const granular::World& a, const granular::World& b)
{
    const auto x = a.particles(), y = b.particles();
    bool all = x.size() == y.size();
    for (std::size_t k = 0; all && k < x.size(); ++k)
        all = x[k].r == y[k].r && x[k].v == y[k].v && x[k].omega == y[k].omega;
    return all;
}

}  // namespace

TEST_CASE("a world restored from a checkpoint continues with bitwise identical results (long)",
          "[granular][checkpoint]")
{
    const auto integrator =
        GENERATE(as<std::string>(), "", R"("integrator": "velocity-verlet",)", R"("integrator": "chung",)");
    std::string text = bed;
    text.insert(text.find("\"step\""), integrator);
    auto whole = granular::read_case(text, "bed");
    whole.world->step(10000);
    REQUIRE(whole.world->contacts().size() > 50);
    const std::string bytes = whole.world->to_bytes("run");
    auto resumed = granular::read_case(text, "bed");
    resumed.world->from_bytes(bytes, "run", "checkpoint");
    CHECK(resumed.world->t() == whole.world->t());
    for (int k = 0; k < 5; ++k) {
        whole.world->step(200), resumed.world->step(200);
        CHECK(same(*whole.world, *resumed.world));
    }
    CHECK(resumed.world->kinetic_energy() == whole.world->kinetic_energy());
    CHECK_THROWS_WITH(resumed.world->from_bytes(bytes, "another", "checkpoint"),
                      "checkpoint: the checkpoint belongs to another run");
}

TEST_CASE("checkpoints change neither the results nor the number of searches of a run",
          "[granular][checkpoint]")
{
    auto whole = granular::read_case(bed, "bed"), saved = granular::read_case(bed, "bed");
    auto resumed = std::make_unique<granular::Case>(granular::read_case(bed, "bed"));
    whole.world->step(2000);
    for (int k = 0; k < 40; ++k) {
        saved.world->step(50), resumed->world->step(50);
        const std::string bytes = saved.world->to_bytes("run");
        REQUIRE(resumed->world->to_bytes("run") == bytes);
        resumed = std::make_unique<granular::Case>(granular::read_case(bed, "bed"));
        resumed->world->from_bytes(bytes, "run", "checkpoint");
        REQUIRE(resumed->world->candidates() == saved.world->candidates());
        REQUIRE(resumed->world->contacts().size() == saved.world->contacts().size());
    }
    CHECK(whole.world->rebuilds() > 10);
    CHECK(whole.world->rebuilds() < 200);
    CHECK(saved.world->rebuilds() == whole.world->rebuilds());
    CHECK(resumed->world->rebuilds() == whole.world->rebuilds());
    const std::string bytes = whole.world->to_bytes("run");
    CHECK(saved.world->to_bytes("run") == bytes);
    CHECK(resumed->world->to_bytes("run") == bytes);
}

// The width of a cell is a whole number of units, so that the cells together are a little wider or narrower
// than the domain.
TEST_CASE("a checkpoint of a domain of any width is accepted", "[granular][checkpoint]")
{
    constexpr double R = 1e-3, largest = 5 * R;
    const bool periodic = GENERATE(false, true);
    int number = 0;
    for (double width = 34 * R; width < 68 * R; width += 0.37 * R) {
        CAPTURE(periodic, width);
        WorldOptions o;
        o.high = {width, 1.1 * width, 1.3 * width}, o.periodic = {periodic, periodic, periodic};
        o.h = 1e-5;
        const auto world = [&] {
            World w(o, {glass()});
            w.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
            return w;
        };
        World saved = world();
        saved.add(Particle{.r = {0.5 * width, 0.5 * width, 0.5 * width}, .radius = largest});
        for (int k = 0; k < 12; ++k)
            saved.add(Particle{.r = {(1 + 2.1 * k) * R, R, R}, .radius = R, .v = {-2, -1, 1}});
        saved.step(20);
        World restored = world();
        REQUIRE_NOTHROW(restored.from_bytes(saved.to_bytes("run"), "run", "checkpoint"));
        saved.step(20), restored.step(20);
        REQUIRE(same(saved, restored));
        ++number;
    }
    CHECK(number > 90);
}

TEST_CASE("a checkpoint with a wrong bit or a wrong length is rejected", "[granular][checkpoint]")
{
    auto c = granular::read_case(bed, "bed");
    c.world->step(200);
    const std::string bytes = c.world->to_bytes("run");
    unsigned seed = 1;
    const auto random = [&] { return seed = seed * 1664525u + 1013904223u; };
    for (std::size_t k = 0; k < 200; ++k) {
        std::string wrong = bytes;
        const std::size_t at = k < 40 ? k : random() % bytes.size();
        wrong[at] = static_cast<char>(wrong[at] ^ (1 << (random() >> 20) % 8));
        CHECK_THROWS_AS(c.world->from_bytes(wrong, "run", "checkpoint"), io::IoError);
        wrong.resize(random() % bytes.size());
        CHECK_THROWS_AS(c.world->from_bytes(wrong, "run", "checkpoint"), io::IoError);
    }
    CHECK_NOTHROW(c.world->from_bytes(bytes, "run", "checkpoint"));
}

// The checksum of such a file is right: only the validation of the values rejects it.
TEST_CASE("a checkpoint with an invalid index, number or length is rejected", "[granular][checkpoint]")
{
    auto c = granular::read_case(bed, "bed");
    c.world->step(4000);
    const std::string bytes = c.world->to_bytes("run");
    constexpr std::size_t header = 24, sum_bytes = 8;
    unsigned seed = 3;
    const auto random = [&] { return seed = seed * 1664525u + 1013904223u; };
    int rejected = 0;
    for (int k = 0; k < 300; ++k) {
        std::string wrong = bytes;
        const std::size_t words = (bytes.size() - header - sum_bytes) / 4;
        const std::size_t at =
            header + 4 * ((random() >> 4) % (k < 150 ? std::min<std::size_t>(words, 200) : words));
        const std::uint32_t value = k % 3 == 0 ? 0xffffffffu : k % 3 == 1 ? 0x7fc00000u : 0x7fffffffu;
        std::memcpy(wrong.data() + at, &value, sizeof value);
        const std::uint64_t sum = io::checksum(wrong.data(), wrong.size() - sum_bytes);
        std::memcpy(wrong.data() + wrong.size() - sum_bytes, &sum, sum_bytes);
        auto other = granular::read_case(bed, "bed");
        try {
            other.world->from_bytes(wrong, "run", "checkpoint");
            other.world->step(2);
        } catch (const io::IoError&) {
            ++rejected;
        } catch (const io::NumericalFailure&) {  // a valid state that is not the saved one
        }
    }
    CHECK(rejected > 100);
}

}  // namespace checkpoint_test
