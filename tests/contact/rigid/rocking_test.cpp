// SPDX-License-Identifier: GPL-3.0-or-later
// Rocking blocks against the solution of Housner (1963) for large angles.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// A block of half width a and half height b, at rest, rotated by `angle` from z to x about its lower edge
std::string block(double a, double b, double angle, double mu)
{
    const Vec3 lengths(2 * a, 0.2, 2 * b);
    const double height = a * std::sin(angle) + b * std::cos(angle);
    return model(
        body("block", 1, box_shape(lengths), Vec3(0, 0, height), Vec3::Zero(), Vec3::Zero(), about_y(angle)),
        on_floor("block", box_surface(lengths), mu));
}

struct Rocking {
    std::vector<double> impacts, amplitudes, ratios;  // times, angles, angular velocities after/before
};

Rocking rock(Run& r, double h, double t_end)
{
    Rocking found;
    double angle = r.angle_about_y(0), omega = 0, before = 0;
    r.to(t_end, [&](const State& x) {
        const double angle_now = r.angle_about_y(0), now = x.body[0].omega_bar.y();
        if (angle_now * angle < 0) {
            found.impacts.push_back(x.t - h * std::abs(angle_now) / (std::abs(angle_now) + std::abs(angle)));
            before = std::abs(omega);
        } else if (before > 0) {  // the step that closes the other edge is this one or the one before
            found.ratios.push_back(std::abs(now) / before);
            before = 0;
        }
        if (now * omega < 0 && std::abs(angle_now) > 1e-3 && found.impacts.size() > found.amplitudes.size())
            found.amplitudes.push_back(std::abs(angle_now));
        angle = angle_now, omega = now;
    });
    return found;
}

double largest_error(const std::vector<double>& of, const std::vector<double>& exact)
{
    if (of.size() < exact.size()) return 1;
    double largest = 0;
    for (std::size_t k = 0; k < exact.size(); ++k)
        largest = std::max(largest, std::abs(of[k] / exact[k] - 1));
    return largest;
}

}  // namespace

TEST_CASE("a rocking block loses the energy of Housner's impacts (long)", "[contact][rigid]")
{
    const std::vector<double> times = {0.3713976082, 0.9442576239, 1.419828175, 1.827327329},
                              amplitudes = {0.1105300958, 0.08645362767, 0.06890930218};
    const auto rocking = [&](double h) {
        Run r(block(0.1, 0.4, 0.6 * std::atan(0.25), 0.6), h);
        return rock(r, h, 2);
    };
    const Rocking coarse = rocking(1e-3), fine = rocking(2.5e-4), finest = rocking(6.25e-5);
    CHECK(largest_error(coarse.impacts, times) < 0.03);
    CHECK(largest_error(fine.impacts, times) < 0.005);
    CHECK(largest_error(fine.amplitudes, amplitudes) < 0.015);
    CHECK(largest_error(finest.amplitudes, amplitudes) < 0.005);
    // the impacts are between nodes: the order is that of a mean over four halvings of the step
    const double order =
        std::log2(largest_error(coarse.impacts, times) / largest_error(finest.impacts, times)) / 4;
    CHECK(order == Approx(1).margin(0.15));
    for (std::size_t k = 0; k < 3; ++k) CHECK(finest.ratios[k] == Approx(0.9117647).epsilon(2e-3));
}

TEST_CASE("a wider rocking block has the impacts of the closed form (long)", "[contact][rigid]")
{
    const std::vector<double> times = {0.36285778, 0.65591066, 0.83995449};
    std::vector<double> error;
    for (const double h : {1e-3, 2.5e-4, 6.25e-5}) {
        Run r(block(0.1, 0.2, 20 * degree, 0.6), h);
        error.push_back(largest_error(rock(r, h, 1).impacts, times));
    }
    CHECK(error[0] < 0.03);
    CHECK(error[1] < 0.01);
    CHECK(std::log2(error[0] / error[2]) / 4 == Approx(1).margin(0.15));
}

TEST_CASE("a rocking block comes to rest where it stood, with enough friction", "[contact][rigid]")
{
    // the impacts need the coefficient 4 (1 - r)/(1 + r) = 0.1846 with r = 0.9117647
    for (const double mu : {0.186, 0.175}) {
        Run r(block(0.1, 0.4, 0.6 * std::atan(0.25), mu), 1e-3);
        const double angle = r.angle_about_y(0);
        // the edge about which it is rotated is at rest at a cos - b sin from the centre
        const double edge = 0.1 * std::cos(angle) - 0.4 * std::sin(angle);
        r.to(5.6);
        CHECK(r.body(0).rdot.norm() + r.body(0).omega_bar.norm() < 1e-10);
        CHECK(std::abs(r.angle_about_y(0)) < 1e-8);
        const double moved = std::abs(r.body(0).r.x() + 0.1 - edge);
        CAPTURE(mu, moved);
        CHECK((moved < 1e-6) == (mu > 0.185));
    }
}

}  // namespace rigid_tests
