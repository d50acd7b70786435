// SPDX-License-Identifier: GPL-3.0-or-later
// Filter and analysis of the motion of a projectile.                            Fang (2022), Sec. 7.2.4
#include "granular/validations/collision_record.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace hilda::granular;

namespace {

constexpr double rate = 1e4, cut_off = 500;

std::vector<double> cosine(double frequency, std::size_t n, double phase = 0)
{
    std::vector<double> x(n);
    for (std::size_t k = 0; k < n; ++k)
        x[k] = std::cos(2 * std::numbers::pi * frequency * static_cast<double>(k) / rate + phase);
    return x;
}

/// A projectile in free fall for `falling` samples, then with the acceleration a until it is at rest. The
/// filtered acceleration is the acceleration.
CollisionRecord stopped(double speed, double a, std::size_t falling, std::size_t n)
{
    CollisionRecord r{.interval = 1 / rate, .g = 9.81, .z = {0.1}, .v = {-speed}, .a = {}, .a_low = {}};
    for (std::size_t k = 0; k < n; ++k) {
        const double now = k < falling ? -r.g : r.v.back() < -1e-12 ? a : 0.;
        r.a.push_back(now);
        if (k + 1 == n) break;
        // of the step that follows: uniform acceleration
        const double next = k + 1 < falling ? -r.g : r.v.back() < -1e-12 ? a : 0.;
        r.z.push_back(r.z.back() + r.v.back() / rate + next / (2 * rate * rate));
        r.v.push_back(r.v.back() + next / rate);
    }
    r.a_low = r.a;
    return r;
}

}  // namespace

TEST_CASE("the low-pass filter has the gain of two Butterworth filters and no phase shift",
          "[granular][slow]")
{
    const std::size_t n = 4001;
    const auto warped = [](double f) { return std::tan(std::numbers::pi * f / rate); };
    for (const double f : {50., 250., cut_off, 1000., 2500., 4000.}) {
        const double gain = 1 / (1 + std::pow(warped(f) / warped(cut_off), 4));
        for (const double phase : {0., 0.7, -1.2}) {
            const std::vector<double> x = cosine(f, n, phase), y = low_pass(x, cut_off, rate);
            double worst = 0;
            for (std::size_t k = 300; k < n - 300; ++k) worst = std::max(worst, std::abs(y[k] - gain * x[k]));
            INFO(f << " Hz, phase " << phase);
            CHECK(worst < 1e-9);
        }
        if (f == cut_off) CHECK(gain == 0.5);  // -3 dB twice
    }
    // A constant and a straight line pass unchanged, up to both ends.
    std::vector<double> line(500);
    for (std::size_t k = 0; k < line.size(); ++k) line[k] = 3 - 0.01 * static_cast<double>(k);
    const std::vector<double> y = low_pass(line, cut_off, rate);
    for (std::size_t k = 0; k < line.size(); ++k) CHECK(y[k] == Approx(line[k]).margin(1e-6));
}

TEST_CASE("the filter commutes with the reversal of time", "[granular][slow]")
{
    std::vector<double> x(400, 0.);
    x[150] = 1, x[151] = -2, x[230] = 5;
    std::vector<double> back(x.rbegin(), x.rend());
    const std::vector<double> y = low_pass(x, cut_off, rate);
    back = low_pass(back, cut_off, rate);
    std::reverse(back.begin(), back.end());
    double area = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        CHECK(y[k] == Approx(back[k]).margin(1e-9));
        area += y[k];
    }
    CHECK(area == Approx(4).epsilon(1e-9));  // the gain at zero frequency is 1
    CHECK(low_pass({}, cut_off, rate).empty());
    CHECK(low_pass({2.}, cut_off, rate) == std::vector<double>{2.});
}

TEST_CASE("the collision of a projectile with a constant deceleration has the depth v^2/2a and the time v/a",
          "[granular][slow]")
{
    const std::size_t falling = 51;
    const double a = 20, begin = 0.5, v = begin + 9.81 * 50 / rate;
    const CollisionRecord r = stopped(begin, a, falling, 1000);
    const Collision c = collision(r);
    CHECK(c.start == 50);
    CHECK(c.slowed);
    CHECK(c.speed == Approx(v).epsilon(1e-12));
    CHECK(c.peak == a);
    // one sample of resolution
    CHECK(c.time == Approx(v / a).margin(2 / rate));
    CHECK(c.depth == Approx(v * v / (2 * a)).margin(1e-6));
}

TEST_CASE("the stop is the first small acceleration after nine tenths of the time to 1 cm/s",
          "[granular][slow]")
{
    CollisionRecord r = stopped(0.5, 20, 51, 1000);
    const Collision whole = collision(r);
    // A gap in the acceleration before 0.9 t_s does not count, one after it does.
    const double t_s = (whole.speed - slow_speed) / 20;
    const auto at = [&](double share) { return whole.start + static_cast<std::size_t>(share * t_s * rate); };
    r.a_low[at(0.8)] = 0;
    CHECK(collision(r).end == whole.end);
    r.a_low[at(0.95)] = 0;
    CHECK(collision(r).end == at(0.95));

    // A record that ends before the projectile is slow: t_s and the stop are its end.
    CollisionRecord cut = stopped(0.5, 20, 51, 200);
    const Collision c = collision(cut);
    CHECK_FALSE(c.slowed);
    CHECK(c.end == 199);
    CHECK(c.time == Approx(149 / rate));
}
