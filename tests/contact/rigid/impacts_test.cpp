// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts of boxes with friction, against closed forms and event-driven integration.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// A box 0.4 m x 0.2 m of 3 kg, rotated by 25 degrees from x to z, its lowest edge at the height `gap`
std::string tilted_box(double gap, const Vec3& v, double mu, const Vec3& gravity)
{
    const Vec3 lengths(0.4, 0.3, 0.2);
    const double angle = 25 * degree, height = 0.2 * std::sin(angle) + 0.1 * std::cos(angle);
    // planar moment of inertia 3 (0.2² + 0.1²)/3 about y
    return model(
        body("box", 3, box_shape(lengths), Vec3(0, 0, gap + height), v, Vec3::Zero(), about_y(-angle)),
        on_floor("box", box_surface(lengths), mu, 0.3), gravity);
}

}  // namespace

TEST_CASE("a box that falls on an edge sticks or slips in the impact as the closed form says",
          "[contact][rigid]")
{
    struct Case {
        double vx, mu;
        Vec3 v;
        double omega, energy_ratio;
    };
    for (const Case& c : {Case{0, 0.8, Vec3(0.9495103348, 0, -0.153516086), -5.420989518, 0.3537306301},
                          Case{1, 0.1, Vec3(1.129149101, 0, -0.7085089911), -9.413751951, 0.6507882891}}) {
        Run r(tilted_box(0, Vec3(c.vx, 0, -2), c.mu, Vec3::Zero()), 1e-4);
        const double before = r.energy();
        r.step();
        const lie::Motion& box = r.body(0);
        CHECK((box.rdot - c.v).norm() < 1e-9);
        CHECK(-box.omega_bar.y() == Approx(c.omega).margin(1e-8));  // angles of the reference: from x to z
        CHECK(r.energy() / before == Approx(c.energy_ratio).margin(1e-9));
        CHECK(r.statistics().friction_relaxed == 0);
    }
}

TEST_CASE("a thrown box has the two impacts of the event-driven reference", "[contact][rigid]")
{
    // impacts at 0.20192751 s and 0.28015290 s
    const Vec3 r(0.2047180555, 0, 0.1176252931), v(0.6791510027, 0, -0.1206841637);
    const double angle = -0.02528327406, omega = 3.397947019;
    std::vector<double> error_r, error_angle;
    for (const double h : {1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5}) {
        Run run(tilted_box(0.2, Vec3(0.5, 0, 0), 0.4, Vec3(0, 0, -g)), h);
        run.to(0.3);
        const lie::Motion& box = run.body(0);
        error_r.push_back((box.r - r).norm());
        error_angle.push_back(std::abs(-run.angle_about_y(0) - angle));
        CHECK((box.rdot - v).norm() < 8 * h);
        CHECK(std::abs(-box.omega_bar.y() - omega) < 20 * h);
        CHECK(run.statistics().restitution_reduced == 0);
        CHECK(run.statistics().friction_relaxed == 0);
    }
    CHECK(error_angle[0] < 0.0065);
    CHECK(error_angle[2] < 0.0005);
    // the impacts are between nodes: the order is that of a mean over four halvings of the step
    CHECK(std::log2(error_r[0] / error_r[4]) / 4 == Approx(1.1).margin(0.25));
}

}  // namespace rigid_tests
