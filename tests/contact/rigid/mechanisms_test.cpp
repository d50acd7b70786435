// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid contacts of bodies with joints, against closed forms and event-driven integration.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

std::string hinge(const std::string& i, const std::string& j, const Vec3& p, const Vec3& q)
{
    return R"({"type": "revolute", "name": ")" + i + ' ' + j + R"(", "body_i": ")" + i + R"(", "body_j": ")" +
           j + R"(", "s_bar_p_i": )" + list(p) + R"(, "s_bar_q_j": )" + list(q) +
           R"(, "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]})";
}

std::string inertia(double J) { return R"(, "inertia": )" + list(Vec3(J, J, J)); }

// Four bars of 0.4 m and 0.5 kg, a square that stands on the hinge B of bars 0 and 1 and falls with 3 m/s.
// Hinges: B 0-1, left 1-2, right 0-3, top 2-3
std::string square()
{
    const double q = 0.2 * std::sqrt(0.5);  // half a bar along x or z
    const Vec3 centre[] = {{q, 0, q}, {-q, 0, q}, {-q, 0, 3 * q}, {q, 0, 3 * q}};
    std::vector<std::string> bars;
    for (int k = 0; k < 4; ++k)
        bars.push_back(body("bar" + std::to_string(k), 0.5, box_shape(Vec3(0.4, 0.01, 0.01)), centre[k],
                            Vec3(0, 0, -3), Vec3::Zero(),
                            inertia(0.5 * 0.16 / 12) + about_y(-(k % 2 == 0 ? 45 : 135) * degree)));
    const Vec3 e(0.2, 0, 0);
    // the surface has a vertex at B
    const std::string surface =
        R"({"type": "convex", "vertices": [[-0.2, 0, 0], [0.2, 0, 0], [0, 0.01, 0], [0, -0.01, 0.01], [0, -0.01, -0.01]]})";
    return model(joined(bars), on_floor("bar0", surface, 0), Vec3::Zero(),
                 joined({hinge("bar0", "bar1", -e, -e), hinge("bar1", "bar2", e, -e),
                         hinge("bar0", "bar3", e, -e), hinge("bar2", "bar3", e, e)}),
                 R"(, "redundant": "keep")");
}

// A slider-crank mechanism in the x-z plane with a slider in a guide that is wider by 2 mm (Flores, Leine,
// Glocker 2010). The crank starts with 150 rad/s.
std::string slider_crank()
{
    const double l1 = 0.153, l2 = 0.306, omega = 150;
    const std::string surface = box_surface(Vec3(0.1, 0.02, 0.05));
    const auto guide = [&](const std::string& name, double side) {
        return R"({"name": ")" + name + R"(", "body_i": "slider", "body_j": "ground", "surface_i": )" +
               surface + R"(, "surface_j": {"type": "plane", "position": )" + list(Vec3(0, 0, 0.026 * side)) +
               R"(, "normal": )" + list(Vec3(0, 0, -side)) + "}, " + dvi(0.01, 0.4) + '}';
    };
    const std::string rod_shape = box_shape(Vec3(0.1, 0.01, 0.01));
    return model(joined({body("crank", 0.038, rod_shape, Vec3(l1 / 2, 0, 0), Vec3(0, 0, omega * l1 / 2),
                              Vec3(0, -omega, 0), inertia(7.4e-5)),
                         body("rod", 0.038, rod_shape, Vec3(l1 + l2 / 2, 0, 0), Vec3(0, 0, omega * l1 / 2),
                              Vec3(0, omega * l1 / l2, 0), inertia(5.9e-4)),
                         body("slider", 0.076, rod_shape, Vec3(l1 + l2, 0, 0), Vec3::Zero(), Vec3::Zero(),
                              inertia(2.7e-6))}),
                 guide("upper", 1) + ", " + guide("lower", -1), Vec3(0, 0, -g),
                 joined({hinge("ground", "crank", Vec3::Zero(), Vec3(-l1 / 2, 0, 0)),
                         hinge("crank", "rod", Vec3(l1 / 2, 0, 0), Vec3(-l2 / 2, 0, 0)),
                         hinge("rod", "slider", Vec3(l2 / 2, 0, 0), Vec3::Zero())}));
}

// Glocker's woodpecker toy with its exact kinematics, in the x-z plane: a sleeve with a hole on a pole, and a
// bird on a spring. Angles from x to z. The lower right corner of the hole touches the pole at the start.
std::string woodpecker()
{
    const double rM = 0.0031, hM = 0.0058, lM = 0.010, lG = 0.015, hS = 0.02, lS = 0.0201;
    const double phi_M = -0.10090092472062435, phi_S = -0.2788, v = -0.3411, omega = -7.4583;
    const Vec3 hinge_at(lM * std::cos(phi_M), 0, lM * std::sin(phi_M)),
        arm(lG * std::cos(phi_S), 0, lG * std::sin(phi_S));
    const auto points = [](const std::vector<Vec3>& vertices) {
        std::vector<std::string> all;
        for (const Vec3& x : vertices) all.push_back(list(x));
        return R"({"type": "convex", "vertices": [)" + joined(all) + "]}";
    };
    const auto on_pole = [&](const std::string& name, const std::string& surface, double e) {
        return R"({"name": ")" + name + R"( on pole", "body_i": ")" + name +
               R"(", "body_j": "ground", "surface_i": )" + surface +
               R"(, "surface_j": {"type": "plane", "position": [0.0025, 0, 0], "normal": [1, 0, 0]}, )" +
               dvi(0.3, e) + '}';
    };
    const std::string shape = box_shape(Vec3(0.01, 0.01, 0.01));
    return model(
        joined({body("sleeve", 0.0003, shape, Vec3::Zero(), Vec3(0, 0, v), Vec3::Zero(),
                     inertia(5e-9) + about_y(-phi_M)),
                body("bird", 0.0045, shape, hinge_at + arm, Vec3(-omega * arm.z(), 0, v + omega * arm.x()),
                     Vec3(0, -omega, 0), inertia(7e-7) + about_y(-phi_S))}),
        joined(
            {on_pole("sleeve", points({{rM, 0, -hM}, {rM, 0, hM}, {0.006, 0.002, 0}, {0.006, -0.002, 0}}), 0),
             on_pole("bird", points({{-lS, 0, hS}, {0, 0.002, hS}, {0, -0.002, hS}, {0, 0, 0}}), 0.5)}),
        Vec3(0, 0, -g),
        joined(
            {R"({"type": "planar", "name": "plane", "body_i": "ground", "body_j": "sleeve", "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]})",
             R"({"type": "CD", "name": "on pole", "body_i": "ground", "body_j": "sleeve", "c": [1, 0, 0], "f": 0})",
             hinge("sleeve", "bird", Vec3(lM, 0, 0), Vec3(-lG, 0, 0))}),
        R"(, "forces": [{"name": "spring", "type": "torsion-spring", "body_i": "sleeve", "body_j": "bird", "axis_bar_i": [0, -1, 0], "axis_bar_j": [0, -1, 0], "stiffness": 0.0056, "free_angle": )" +
            number(phi_M - phi_S) + "}]");
}

}  // namespace

TEST_CASE("a square of four hinged bars that falls on a hinge has the impulses of the closed form",
          "[contact][rigid]")
{
    const double h = 1e-6;
    Run r(square(), h);
    const double before = r.energy();
    r.step();
    for (int k = 0; k < 4; ++k) {
        const double omega = (k % 2 == 0 ? 1 : -1) * std::sqrt(40.5);  // 6.3639610 rad/s
        CHECK((r.body(k).omega_bar - Vec3(0, omega, 0)).norm() < 1e-9);
    }
    CHECK(r.energy() / before == Approx(0.6).epsilon(1e-10));
    CHECK(r.points(0).size() == 1);
    CHECK((h * r.points(0)[0].N) == Approx(2.4).epsilon(1e-10));
    // hinges, in the order of the file
    const Vec3 impulse[] = {{0.75, 0, -1.2}, {0.3, 0, -0.15}, {-0.3, 0, -0.15}, {-0.15, 0, 0}};
    for (int k = 0; k < 4; ++k) CHECK((h * r.state().lambda.segment<3>(5 * k) - impulse[k]).norm() < 1e-9);
}

TEST_CASE("a square of hinged bars converges with order one in the step after its impact", "[contact][rigid]")
{
    const auto omega = [](double h) {
        Run r(square(), h);
        r.to(8e-3);
        return r.body(0).omega_bar.y();
    };
    const double a = omega(1e-3), b = omega(5e-4), c = omega(2.5e-4);
    CHECK(std::log2((a - b) / (b - c)) == Approx(1).margin(0.15));
}

TEST_CASE("a ball rolls or slides down a V-groove with the acceleration of the closed form",
          "[contact][rigid]")
{
    const double slope = 15 * degree, N = g * std::cos(slope) / std::sqrt(2.);
    for (const double mu : {0.1, 0.05}) {  // rolling needs 0.0842083
        const auto side = [&](const std::string& name, double y) {
            return R"({"name": ")" + name + R"(", "body_i": "ball", "body_j": "ground", "surface_i": )" +
                   ball_surface(0.1) + R"(, "surface_j": {"type": "plane", "normal": )" +
                   list(Vec3(0, y, 1).normalized()) + "}, " + dvi(mu, 0) + '}';
        };
        Run r(
            model(body("ball", 1, ball_shape(0.1), Vec3(0, 0, 0.1 * std::sqrt(2.))),
                  side("left", 1) + ", " + side("right", -1), g * Vec3(std::sin(slope), 0, -std::cos(slope))),
            1e-3);
        r.to(0.5);
        const bool rolls = mu > 0.0842083071;
        CHECK(r.body(0).rdot.x() / 0.5 ==
              Approx(rolls ? 1.410563796 : g * std::sin(slope) - 2 * mu * N).epsilon(1e-8));
        for (const int k : {0, 1}) {
            const contact::LoadedPoint point = r.points(k).at(0);
            // rolling: N and the friction across the groove are not unique, their sum is
            const double across = point.F.dot(Vec3(0, k == 0 ? -1 : 1, 1).normalized());
            CHECK(point.N + across == Approx(6.700354606).epsilon(1e-7));
            CHECK(-point.F.x() == Approx(rolls ? 0.5642255183 : mu * N).epsilon(1e-7));
            CHECK(point.slips == !rolls);
        }
    }
}

TEST_CASE("the slider of a slider-crank with clearance has the impacts of the event-driven reference",
          "[contact][rigid]")
{
    // both upper corners
    const double times[] = {2.6925e-3, 5.61236e-3, 7.47506e-3, 8.42177e-3, 8.84571e-3},
                 approaches[] = {0.841612, 0.247826, 0.084204, 0.031143, 0.012029};
    double error_before = 0;
    for (const double h : {4e-6, 1e-6}) {
        Run r(slider_crank(), h);
        double approach = 0, error = 0;
        std::size_t impacts = 0;
        r.to(9.5e-3, [&](const State& x) {
            double N = 0, up = 0;
            for (const lie::ConeForce& f : x.cone_forces) N += h * f.F.norm();
            if (N > 1e-5 && approach > 0.01 && impacts < 5) {
                error = std::max({error, std::abs(x.t / times[impacts] - 1),
                                  std::abs(approach / approaches[impacts] - 1)});
                ++impacts;
            }
            const lie::Motion& slider = x.body[2];
            for (const double side : {-0.05, 0.05})
                up = std::max(
                    up, slider.rdot.z() + (slider.A * slider.omega_bar.cross(Vec3(side, 0, 0.025))).z());
            approach = up;
        });
        CHECK(impacts == 5);
        CHECK(error < 8e3 * h);  // [1/s]
        if (error_before > 0) CHECK(std::log2(error_before / error) / 2 == Approx(1).margin(0.15));
        error_before = error;
        // then all corners of the upper side remain closed
        CHECK(r.points(0).size() == 4);
        for (const contact::LoadedPoint& point : r.points(0)) CHECK(std::abs(point.at.gap) < 1e-8);
        CHECK(r.statistics().friction_relaxed == 0);
    }
}

TEST_CASE("a woodpecker pecks at the times of the event-driven reference (long)", "[contact][rigid]")
{
    const double pecks[] = {0.08269403994, 0.21250293635, 0.34330947568, 0.47405414074};
    for (const double h : {1e-4, 2e-5}) {
        Run r(woodpecker(), h);
        bool touched = false;
        std::size_t count = 0;
        r.to(0.6, [&](const State& x) {
            bool touches = false;
            for (const lie::ConeForce& f : x.cone_forces)
                touches = touches || (f.key >> 32 == 1 && h * f.F.norm() > 1e-8);
            if (touches && !touched && count < 4) CHECK(x.t == Approx(pecks[count++]).epsilon(2e-3));
            touched = touches;
        });
        CHECK(count == 4);
        CHECK(r.body(0).r.z() == Approx(-0.06543747).epsilon(2e-3));
        CHECK(r.statistics().friction_relaxed == 0);
    }
}

TEST_CASE("a driver against a wall ends the run with the contact and its error", "[contact][rigid]")
{
    const std::string surface = box_surface(Vec3(0.1, 0.1, 0.1));
    Run r(
        model(
            body("box", 1, box_shape(Vec3(0.1, 0.1, 0.1)), Vec3::Zero(), Vec3(0.1, 0, 0)),
            R"({"name": "wall", "body_i": "box", "body_j": "ground", "surface_i": )" + surface +
                R"(, "surface_j": {"type": "plane", "position": [0.06, 0, 0], "normal": [-1, 0, 0]}, )" +
                dvi(0.3, 0) + '}',
            Vec3(0, 0, -g),
            R"({"type": "translational", "name": "guide", "body_i": "box", "body_j": "ground", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}, )"
            R"({"type": "CD", "name": "driver", "body_i": "ground", "body_j": "box", "c": [1, 0, 0], "f": "0.1*t"})"),
        1e-3);
    try {
        r.to(0.2);
        FAIL("the driver moved the box into the wall");
    } catch (const lie::NumericalFailure& e) {
        CHECK(e.status == "cones_not_solved");
        CHECK_THAT(e.what(), Catch::Contains("contact 'wall'") && Catch::Contains("error of"));
        CHECK(r.state().t == Approx(0.1).margin(2e-3));
    }
}

}  // namespace rigid_tests
