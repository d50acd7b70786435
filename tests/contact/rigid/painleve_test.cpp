// SPDX-License-Identifier: GPL-3.0-or-later
// The sliding rod of Painlevé (1895): Coulomb's law without a solution, or with two, for the accelerations.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// A rod of 1 m and 1 kg at `angle` from the floor. Its lower end slides with -1 m/s along x, in the
// direction to which it does not lean.
std::string rod(double angle, double mu, double omega)
{
    const double l = 0.5, c = l * std::cos(angle), s = l * std::sin(angle);
    // positive omega: from x to z
    const Vec3 v(-1 - omega * s, 0, omega * c);
    const std::string surface =
        R"({"type": "convex", "vertices": [[-0.5, 0, 0], [0.5, 0, 0], [0, 0.001, 0], [0, -0.001, 0], [0, 0, 0.001], [0, 0, -0.001]]})";
    return model(body("rod", 1, box_shape(Vec3(1, 0.01, 0.01)), Vec3(c, 0, s), v, Vec3(0, -omega, 0),
                      R"(, "inertia": [0.001, 0.08333333333333333, 0.08333333333333333])" + about_y(-angle)),
                 on_floor("rod", surface, mu));
}

struct AfterStep {
    Vec3 impulse, v;
    double omega;  // from x to z
};

AfterStep one_step(const std::string& text, double h)
{
    Run r(text, h);
    r.step();
    CHECK(r.statistics().friction_relaxed == 0);
    Vec3 impulse = Vec3::Zero();
    for (const lie::ConeForce& f : r.state().cone_forces) impulse += h * f.F;
    return {impulse, r.body(0).rdot, -r.body(0).omega_bar.y()};
}

}  // namespace

TEST_CASE("a rod without a solution for its accelerations has an impact without collision",
          "[contact][rigid]")
{
    // the end of the rod sticks at once: the impulse is that of its mass matrix, and the gravity of the step
    const Vec3 impulse(0.8125, 0, 0.3247595264), v(-0.1875, 0, 0.3247595264);
    for (const double h : {1e-2, 1e-3, 1e-4}) {
        const std::string text = rod(30 * degree, 3, 0);
        const AfterStep x = one_step(text, h), half = one_step(text, h / 2);
        CHECK((2 * half.impulse - x.impulse - impulse).norm() < 1e-8);
        CHECK((2 * half.v - x.v - v).norm() < 1e-8);
        CHECK(2 * half.omega - x.omega == Approx(0.75).margin(1e-8));
        if (h == 1e-2) CHECK(x.impulse.x() == Approx(0.84436).margin(1e-5));
    }
    Run r(rod(30 * degree, 3, 0), 1e-4);
    const double potential = g * 0.25, before = r.energy() - potential;
    r.step();
    CHECK(before == Approx(0.5).epsilon(1e-9));
    CHECK(r.energy() - potential == Approx(0.09375).margin(2e-3));
    double last = r.energy();
    r.to(0.05, [&](const State&) {
        CHECK(r.energy() <= last + 1e-6);
        last = r.energy();
    });
}

TEST_CASE("a rod with two solutions for its accelerations jams", "[contact][rigid]")
{
    // The contact rows are those of the beginning of the step, in which the centripetal acceleration of the
    // end is not contained. Of the two solutions, flight and impact without collision, the scheme has the
    // second.
    const std::string text = rod(30 * degree, 3, 7);
    const AfterStep x = one_step(text, 1e-4), half = one_step(text, 5e-5);
    CHECK((2 * half.impulse - x.impulse - Vec3(0.8125, 0, 0.3247595264)).norm() < 1e-8);
    CHECK((2 * half.v - x.v - Vec3(-1.9375, 0, 3.35584844)).norm() < 1e-7);
    CHECK(2 * half.omega - x.omega == Approx(7.75).margin(1e-8));
}

TEST_CASE("a steeper rod slides with the normal force of its accelerations", "[contact][rigid]")
{
    const double A = 0.9612852531;  // m times the inverse mass of the end along the normal, with its friction
    const AfterStep x = one_step(rod(65 * degree, 0.5, 0), 1e-5);
    CHECK(x.impulse.z() / 1e-5 == Approx(g / A).epsilon(1e-7));
    CHECK(x.impulse.x() == Approx(0.5 * x.impulse.z()).epsilon(1e-7));
}

}  // namespace rigid_tests
