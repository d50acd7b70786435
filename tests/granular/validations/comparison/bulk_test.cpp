// SPDX-License-Identifier: GPL-3.0-or-later
// The cases of the comparison of codes for bulk processes, with few large grains.
#include "granular/validations/comparison/mixing_drum.hpp"
#include "granular/validations/comparison/penetration.hpp"
#include "granular/validations/comparison/silo.hpp"

#include <catch2/catch.hpp>

#include <omp.h>

#include <cmath>

using namespace hilda::granular;

namespace {

/// The result of f with one and with three threads
template <class F>
auto with_threads(const F& f)
{
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    auto one = f();
    omp_set_num_threads(3);
    auto three = f();
    omp_set_num_threads(threads);
    return std::pair{one, three};
}

}  // namespace

TEST_CASE("larger grains are fewer, and softer grains allow larger steps", "[granular][comparison]")
{
    CHECK(BulkScale{.size = 2}.number(100000) == 12500);
    CHECK(BulkScale{}.number(25000) == 25000);
    const BulkScale published, soft{.softness = 100}, large{.size = 2};
    CHECK(bulk_step(2e-3, M1, soft) == Approx(10 * bulk_step(2e-3, M1, published)));
    CHECK(bulk_step(4e-3, M1, large) == Approx(2 * bulk_step(2e-3, M1, published)));
    // The published step of the silo with M1 is 1.5e-6 s, 0.09 of the Rayleigh time.
    CHECK(1.5e-6 / bulk_step(2e-3, M1, published) * 0.16 == Approx(0.09).margin(0.005));
    const std::vector<Material> m = bulk_materials(soft);
    CHECK(m[M1].E == Approx(1e7));
    CHECK(m[M2].E == Approx(0.5e7));
    CHECK(m[steel].density == 7200);
}

TEST_CASE("a loose lattice has the requested number of grains, in its region and without contact",
          "[granular][comparison]")
{
    Particle p;
    p.radius = 0.01;
    Random random(1);
    const auto inside = [](const Vec3& r) { return std::hypot(r.x, r.y) < 0.08; };
    const std::vector<Particle> all = loose_layers(p, 200, 0.5, 0.1, inside, random);
    REQUIRE(all.size() == 200);
    double least = 1, lowest = 1;
    for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(inside(all[i].r));
        lowest = std::min(lowest, all[i].r.z - p.radius);
        for (std::size_t j = 0; j < i; ++j) least = std::min(least, (all[i].r - all[j].r).norm());
    }
    CHECK(least > 2 * p.radius);
    CHECK(lowest >= 0.5);
    CHECK(highest_point(all) > 0.6);
}

TEST_CASE("a silo empties, and no grain is lost (long)", "[granular][comparison]")
{
    Silo silo{.orifice = 0.12, .scale = {.size = 6, .softness = 500}, .time = 0.6};
    silo.grains = 60000;
    const auto [one, three] = with_threads([&] { return silo_flow(silo, {}); });
    CHECK(one.retained.front() == static_cast<double>(silo.number()));
    CHECK(one.retained.back() < 0.8 * one.retained.front());
    CHECK(one.retained == three.retained);
    CHECK(one.balance == 0);
    for (std::size_t k = 1; k < one.retained.size(); ++k) CHECK(one.retained[k] <= one.retained[k - 1]);
}

TEST_CASE("the rate of a silo is that of a straight line", "[granular][comparison]")
{
    SiloFlow flow;
    for (int k = 0; k <= 100; ++k) flow.t.push_back(0.02 * k), flow.retained.push_back(1000 - 8 * k);
    CHECK(flow.rate() == Approx(400));
    CHECK(flow.steady() == Approx(1));
}

TEST_CASE("a drum lifts its grains, and its torque is their moment (long)", "[granular][comparison]")
{
    MixingDrum drum;
    drum.scale = {.size = 4, .softness = 500}, drum.time = 1;
    const auto [one, three] = with_threads([&] { return drum_mixing(drum, {}); });
    CHECK(one.lost == 0);
    CHECK(one.zone2_M1 == three.zone2_M1);
    CHECK(one.torque == three.torque);
    CHECK(one.centre_angle.front() == Approx(0).margin(6));
    CHECK(one.centre_angle.back() > 10);
    CHECK(one.work > one.gain);
    double torque = 0, gravity = 0;
    for (std::size_t k = one.torque.size() / 2; k < one.torque.size(); ++k)
        torque += one.torque[k], gravity += one.gravity[k];
    CHECK(torque == Approx(gravity).epsilon(0.1));
}

TEST_CASE("the peak acceleration of a ball is NaN if one of its velocities is", "[granular][comparison]")
{
    BallMotion m;
    m.t = {0, 1, 2, 3}, m.z = {1, 1, 1, 1}, m.v = {-5, -3, 0, 1};
    CHECK(m.peak() == 3);
    m.v[1] = std::nan("");
    CHECK(std::isnan(m.peak()));
}

TEST_CASE("a ball falls freely onto a bed, which stops it (long)", "[granular][comparison]")
{
    const Penetration test{.scale = {.size = 5, .softness = 10}, .time = 0.04};
    const std::vector<Vec3> bed = penetration_bed(test, {});
    REQUIRE(static_cast<long>(bed.size()) == test.number());
    const auto [one, three] = with_threads([&] { return ball_motion(test, bed, {}); });
    CHECK(one.z == three.z);
    CHECK(one.lost == 0);
    const std::size_t contact = one.contact();
    const double t = one.t[contact];
    CHECK(one.v[contact] == Approx(-BallMotion::speed - 9.81 * t));
    CHECK(one.z[contact] ==
          Approx(BallMotion::start - BallMotion::speed * t - 9.81 * t * t / 2).epsilon(1e-4));
    CHECK(one.stop() > contact);
    CHECK(one.v[one.stop()] >= 0);
    CHECK(one.depth() > 0);
    CHECK(one.peak() > 100);
}
