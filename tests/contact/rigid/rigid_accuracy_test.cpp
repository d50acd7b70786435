// SPDX-License-Identifier: GPL-3.0-or-later
// The order of rA-moreau-1 for contacts that persist.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// From a point of the body to the ground, along x, 300 N/m
std::string spring(const std::string& name, const Vec3& at, double height)
{
    return R"(, "forces": [{"name": "spring", "type": "spring-damper", "body_i": ")" + name +
           R"(", "body_j": "ground", "s_bar_p_i": )" + list(at) + R"(, "s_bar_q_j": )" +
           list(Vec3(-10, 0, height)) + R"(, "stiffness": 300, "free_length": 10}])";
}

/// Errors [m, m/s, N, …] of runs with h, h/2, h/4
using Errors = std::vector<std::vector<double>>;

void check_order_one(const Errors& errors)
{
    for (std::size_t k = 0; k < errors[0].size(); ++k) {
        CAPTURE(k, errors[0][k], errors[1][k], errors[2][k]);
        for (const std::size_t n : {0, 1}) {
            const double order = std::log2(errors[n][k] / errors[n + 1][k]);
            CHECK(order > 0.85);
            CHECK(order < 1.2);
        }
    }
}

}  // namespace

TEST_CASE("a box that slides with a spring converges with order one", "[contact][rigid][order]")
{
    const double a = 0.2, b = 0.05, c = 0.03, m = 2, mu = 0.3, k = 300, v0 = 2, t = 0.1;
    const Vec3 lengths(2 * a, 0.3, 2 * b);
    const std::string text = model(body("box", m, box_shape(lengths), Vec3(0, 0, b), Vec3(v0, 0, 0)),
                                   on_floor("box", box_surface(lengths), mu), Vec3(0, 0, -g), "",
                                   spring("box", Vec3(0, 0, c), b + c));
    const double w = std::sqrt(k / m), x_f = mu * m * g / k;
    const double x = -x_f + x_f * std::cos(w * t) + v0 / w * std::sin(w * t);
    const double v = -x_f * w * std::sin(w * t) + v0 * std::cos(w * t);
    REQUIRE(v > 0.1);  // it slides in the direction of its start
    const double front = (m * g + (mu * m * g * b - k * x * c) / a) / 2;
    Errors errors;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        Run r(text, h);
        r.to(t);
        double N = 0, friction = 0;
        for (const contact::LoadedPoint& p : r.points(0)) {
            if (p.at.C().x() > r.body(0).r.x()) N += p.N;
            friction -= p.F.x();
        }
        CHECK(friction == Approx(mu * m * g).epsilon(1e-7));
        errors.push_back(
            {std::abs(r.body(0).r.x() - x), std::abs(r.body(0).rdot.x() - v), std::abs(N - front)});
    }
    check_order_one(errors);
}

TEST_CASE("a ball that slips and then rolls with a spring converges with order one",
          "[contact][rigid][order]")
{
    const std::string text = model(body("ball", 2, ball_shape(0.1), Vec3(0, 0, 0.1), Vec3(2, 0, 0)),
                                   on_floor("ball", ball_surface(0.1), 0.8), Vec3(0, 0, -g), "",
                                   spring("ball", Vec3::Zero(), 0.1));
    struct At {
        double x, v, omega, F;
        bool slips;
    };
    const auto at = [&](double h, double t) -> At {
        Run r(text, h);
        r.to(t);
        const contact::LoadedPoint p = r.points(0).at(0);
        return {r.body(0).r.x(), r.body(0).rdot.x(), r.body(0).omega_bar.y(), p.F.x(), p.slips};
    };
    for (const double t : {0.024, 0.2}) {
        const At fine = at(2e-3 / 256, t);
        CAPTURE(t, fine.slips);
        CHECK(fine.slips == (t < 0.1));
        Errors errors;
        for (const double h : {2e-3, 1e-3, 5e-4}) {
            const At x = at(h, t);
            errors.push_back({std::abs(x.x - fine.x), std::abs(x.v - fine.v)});
            if (t > 0.1) {
                errors.back().push_back(std::abs(x.omega - fine.omega));
                errors.back().push_back(std::abs(x.F - fine.F));
            }
        }
        check_order_one(errors);
    }
}

TEST_CASE("a body that slides on a vertex converges with order one", "[contact][rigid][order]")
{
    const Vec3 lengths(0.4, 0.3, 0.2), axis = Vec3(0.3, 1, 0.2).normalized();
    const lie::Mat3 A = lie::exp(0.5 * axis);
    double lowest = 0;
    for (int k = 0; k < 8; ++k)
        lowest = std::min(
            lowest, A.row(2).dot(0.5 * Vec3(k & 1 ? 0.4 : -0.4, k & 2 ? 0.3 : -0.3, k & 4 ? 0.2 : -0.2)));
    const std::string pose =
        R"(, "axis_angle": [)" + number(axis[0]) + ", " + number(axis[1]) + ", " + number(axis[2]) + ", 0.5]";
    const std::string text =
        model(body("box", 3, box_shape(lengths), Vec3(0, 0, -lowest), Vec3(1, 0.5, 0), Vec3::Zero(), pose),
              on_floor("box", box_surface(lengths), 0.2));
    const auto at = [&](double h) {
        Run r(text, h);
        r.to(0.08);
        CHECK(r.state().cone_forces.size() == 1);
        return std::pair{r.body(0), r.state().cone_forces.at(0).F};
    };
    const auto [exact, F_exact] = at(4e-3 / 256);
    Errors errors;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        const auto [x, F] = at(h);
        errors.push_back({(x.r - exact.r).norm(), lie::log(exact.A.transpose() * x.A).norm(),
                          (x.rdot - exact.rdot).norm(), (x.omega_bar - exact.omega_bar).norm(),
                          (F - F_exact).norm()});
    }
    check_order_one(errors);
}

TEST_CASE("a linkage that slides on the floor converges with order one, also in its joint forces (long)",
          "[contact][rigid][order]")
{
    const double l = 0.3, angle = 40 * degree, x = l * std::cos(angle), z = l * std::sin(angle);
    const Vec3 half(l / 2, 0, 0);
    const auto hinge = [](const std::string& i, const std::string& j, const Vec3& p, const Vec3& q) {
        return R"({"type": "revolute", "body_i": ")" + i + R"(", "body_j": ")" + j + R"(", "s_bar_p_i": )" +
               list(p) + R"(, "s_bar_q_j": )" + list(q) +
               R"(, "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]})";
    };
    const std::string shape = box_shape(Vec3(l, 0.02, 0.02)),
                      surface = R"({"type": "capsule", "length": 0.3, "radius": 0.01, "axis": [1, 0, 0]})";
    const Vec3 w(0, 2, 0), v = w.cross(Vec3(x, 0, z));  // of the hinge between them
    const std::string text =
        model(body("left", 1, shape, Vec3(x / 2, 0, z / 2 + 0.01), v / 2, w, about_y(-angle)) + ", " +
                  body("right", 1, shape, Vec3(1.5 * x, 0, z / 2 + 0.01), Vec3(1.5 * v.x(), 0, v.z() / 2), -w,
                       about_y(angle)),
              on_floor("right", surface, 0.3), Vec3(0, 0, -g),
              hinge("ground", "left", Vec3(0, 0, 0.01), -half) + ", " + hinge("left", "right", half, -half));
    const auto at = [&](double h) {
        Run r(text, h);
        r.to(0.08);
        CHECK(r.state().cone_forces.size() == 1);
        return r.state();
    };
    const State exact = at(4e-3 / 256);
    Errors errors;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        const State y = at(h);
        errors.push_back({(y.body[1].r - exact.body[1].r).norm(),
                          (y.body[1].rdot - exact.body[1].rdot).norm(), (y.lambda - exact.lambda).norm(),
                          (y.cone_forces.at(0).F - exact.cone_forces.at(0).F).norm()});
    }
    check_order_one(errors);
}

}  // namespace rigid_tests
