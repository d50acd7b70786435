// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid contacts of model files with rA-moreau-1, against closed forms.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace hilda;

namespace rigid_tests {

namespace {

const std::string flat_box = box_shape(Vec3(0.2, 0.2, 0.1)), flat_surface = box_surface(Vec3(0.2, 0.2, 0.1)),
                  small_ball = ball_shape(0.1), small_surface = ball_surface(0.1);

Vec3 on_slope(double angle) { return g * Vec3(std::sin(angle), 0, -std::cos(angle)); }

}  // namespace

TEST_CASE("a box slides down a slope, stops, and stays", "[contact][rigid]")
{
    const double angle = 20 * std::numbers::pi / 180;
    const std::string text = model(body("box", 2, flat_box, Vec3(0, 0, 0.05), Vec3(1.5, 0, 0)),
                                   on_floor("box", flat_surface, 0.5), on_slope(angle));
    const double a = g * (0.5 * std::cos(angle) - std::sin(angle)), distance = 1.5 * 1.5 / (2 * a);
    std::vector<double> error;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        const State x = run(text, h, 1.4);
        error.push_back(distance - x.body[0].r.x());
        CHECK(x.body[0].rdot.norm() < 1e-10);
        CHECK(x.body[0].omega_bar.norm() < 1e-10);
        CHECK(x.body[0].r.z() == Approx(0.05).epsilon(1e-12));
        Vec3 F = Vec3::Zero();
        for (const lie::ConeForce& f : x.cone_forces) F += f.F;
        CHECK((F + 2 * on_slope(angle)).norm() < 1e-8);  // the weight is carried
    }
    CHECK(error[2] < 1e-3);
    CHECK(std::log2(error[0] / error[1]) == Approx(1).margin(0.05));
    CHECK(std::log2(error[1] / error[2]) == Approx(1).margin(0.05));

    // it does not creep in 10 s
    const State start = run(text, 1e-3, 1.3), end = run(text, 1e-3, 11.3);
    CHECK((end.body[0].r - start.body[0].r).norm() < 1e-10);
}

TEST_CASE("the forces at the front and rear of a sliding box are those of its balance", "[contact][rigid]")
{
    const double angle = 20 * std::numbers::pi / 180;
    const std::string text = model(body("box", 2, flat_box, Vec3(0, 0, 0.05), Vec3(1.5, 0, 0)),
                                   on_floor("box", flat_surface, 0.5), on_slope(angle));
    dae::Description d = dae::read_model(text, "m.json");
    dae::start(d);
    const auto integrator = lie::scheme("rA-moreau-1").make(*d.model, {});
    lie::March march(d.x, *integrator, 1e-3);
    const auto& contacts = dynamic_cast<const contact::RigidContacts&>(*d.model->rigid_contacts()[0]);
    for (const bool at_rest : {false, true}) {
        while (march.node().t < (at_rest ? 1.3 : 0.5)) march.advance({});
        std::vector<contact::LoadedPoint> points;
        contacts.points(march.node(), 0, points);
        double front = 0, rear = 0, friction = 0;
        for (const contact::LoadedPoint& p : points) {
            (p.at.C().x() > march.node().body[0].r.x() ? front : rear) += p.N;
            friction -= p.F.x();
            CHECK(p.slips == !at_rest);
        }
        CHECK(front == Approx(at_rest ? 10.89599 : 11.52298).epsilon(1e-5));
        CHECK(rear == Approx(at_rest ? 7.54078 : 6.91379).epsilon(1e-5));
        if (at_rest) CHECK(friction == Approx(6.71044).epsilon(1e-5));
    }
}

TEST_CASE("at the limit of friction a box stays below it and slides above it", "[contact][rigid]")
{
    for (const double offset : {-1e-4, 1e-4}) {
        const double angle = std::atan(0.5) + offset;
        const State x = run(model(body("box", 2, flat_box, Vec3(0, 0, 0.05)),
                                  on_floor("box", flat_surface, 0.5), on_slope(angle)),
                            1e-3, 1);
        if (offset < 0)
            CHECK(std::abs(x.body[0].r.x()) < 1e-9);
        else
            CHECK(x.body[0].rdot.x() == Approx(g * (std::sin(angle) - 0.5 * std::cos(angle))).epsilon(1e-4));
    }
}

TEST_CASE("an oblique bounce of a ball has the closed form of Newton and Coulomb", "[contact][rigid]")
{
    // sticks: v_t = 5/7 of that before; slips: v_t - mu (1 + e) v_n, omega + 5/2 mu (1 + e) v_n / R
    const auto after = [](double mu, double v_t, double omega) {
        return run(model(body("ball", 1, small_ball, Vec3(0, 0, 0.1 + 1e-9), Vec3(v_t, 0, -2),
                              Vec3(0, omega, 0)),
                         on_floor("ball", small_surface, mu, 0.5), Vec3::Zero()),
                   1e-4, 1e-3)
            .body[0];
    };
    const lie::Motion sticks = after(0.4, 1, 0), slips = after(0.1, 3, -5);
    CHECK(sticks.rdot.z() == Approx(1).epsilon(1e-9));
    CHECK(sticks.rdot.x() == Approx(5. / 7).epsilon(1e-8));
    CHECK(sticks.omega_bar.y() == Approx(50. / 7).epsilon(1e-8));
    CHECK(slips.rdot.x() == Approx(2.7).epsilon(1e-8));
    CHECK(slips.omega_bar.y() == Approx(2.5).epsilon(1e-7));
}

TEST_CASE("touching balls of a cradle share an impact as Newton's law says", "[contact][rigid]")
{
    for (const int n : {3, 5}) {
        std::string bodies, contacts;
        for (int k = 0; k < n; ++k) {
            const std::string name = "b" + std::to_string(k);
            bodies +=
                (k > 0 ? ", " : "") + body(name, 1, small_ball, Vec3(0.2 * k + (k > 0 ? 1e-9 : 0), 0, 0),
                                           Vec3(k == 0 ? 1 : 0, 0, 0));
            if (k == 0) continue;
            contacts += (k > 1 ? ", " : "") + (R"({"body_i": "b)" + std::to_string(k - 1)) +
                        R"(", "body_j": ")" + name + R"(", "name": "c)" + std::to_string(k) +
                        R"(", "surface_i": )" + small_surface + R"(, "surface_j": )" + small_surface +
                        R"(, "normal": {"type": "dvi", "restitution": 1}})";
        }
        const State x = run(model(bodies, contacts, Vec3::Zero()), 1e-4, 1e-3);
        // the first ball has -1 + 4/(n + 1) ... of the momentum; the others move together
        CHECK(x.body[0].rdot.x() == Approx(n == 3 ? -1. / 3 : -0.6).epsilon(1e-7));
        for (int k = 1; k < n; ++k)
            CHECK(x.body[static_cast<size_t>(k)].rdot.x() == Approx(n == 3 ? 2. / 3 : 0.4).epsilon(1e-7));
    }
}

TEST_CASE("a bouncing ball comes to rest", "[contact][rigid]")
{
    const std::string text =
        model(body("ball", 1, small_ball, Vec3(0, 0, 1.1)), on_floor("ball", small_surface, 0, 0.5));
    const auto first_impact = [&](double h) {
        double t = 0, before = 0;
        run(text, h, 0.6, [&](const State& x) {
            if (t == 0 && before < 0 && x.body[0].rdot.z() > 0) t = x.t;
            before = x.body[0].rdot.z();
        });
        return t;
    };
    for (const double h : {1e-3, 1e-4}) CHECK(first_impact(h) == Approx(0.4515236).margin(1.5 * h));
    const State x = run(text, 1e-3, 1.6);
    CHECK(x.body[0].rdot.squaredNorm() < 1e-12);
    CHECK(x.body[0].r.z() == Approx(0.1).epsilon(1e-8));
}

TEST_CASE("a stack of ten boxes rests, and each interface carries the weight above", "[contact][rigid]")
{
    std::string bodies, contacts = on_floor("b0", R"({"type": "box", "lengths": [0.2, 0.2, 0.2]})", 0.5);
    const std::string surface = R"({"type": "box", "lengths": [0.2, 0.2, 0.2]})";
    for (int k = 0; k < 10; ++k) {
        bodies += (k > 0 ? ", " : "") +
                  body("b" + std::to_string(k), 1, R"({"box": [0.2, 0.2, 0.2]})", Vec3(0, 0, 0.1 + 0.2 * k));
        if (k > 0)
            contacts += R"(, {"name": "c)" + std::to_string(k) + R"(", "body_i": "b)" + std::to_string(k) +
                        R"(", "body_j": "b)" + std::to_string(k - 1) + R"(", "surface_i": )" + surface +
                        R"(, "surface_j": )" + surface +
                        R"(, "normal": {"type": "dvi"}, "friction": {"law": "coulomb", "mu_s": 0.5}})";
    }
    dae::Description d = dae::read_model(model(bodies, contacts), "m.json");
    dae::start(d);
    const auto integrator = lie::scheme("rA-moreau-1").make(*d.model, {});
    lie::March march(d.x, *integrator, 1e-3);
    for (int n = 0; n < 1000; ++n) march.advance({});
    for (int k = 0; k < 10; ++k) {
        const lie::Motion& of = march.node().body[static_cast<size_t>(k)];
        CHECK((of.r - Vec3(0, 0, 0.1 + 0.2 * k)).norm() < 1e-9);
        CHECK(of.rdot.norm() < 1e-9);
        std::vector<contact::LoadedPoint> points;
        const auto& c =
            dynamic_cast<const contact::RigidContacts&>(*d.model->rigid_contacts()[static_cast<size_t>(k)]);
        c.points(march.node(), 0, points);
        CHECK(points.size() == 4);
        double N = 0;
        for (const contact::LoadedPoint& p : points) N += p.N;
        CHECK(N == Approx((10 - k) * g).epsilon(1e-6));
    }
}

TEST_CASE("wrong rigid contacts are refused", "[contact][rigid]")
{
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            dae::Description d = dae::read_model(text, "m.json");
            dae::start(d);
            lie::scheme("rA-half-1").make(*d.model, {});
            return "accepted";
        } catch (const lie::InvalidInput& e) {
            return e.what();
        }
    };
    const std::string box = body("box", 2, flat_box, Vec3(0, 0, 0.05));
    using Catch::Contains;
    CHECK_THAT(refusal(model(box, on_floor("box", flat_surface, -1))), Contains("mu_s must not be negative"));
    CHECK_THAT(refusal(model(box, on_floor("box", flat_surface, 0.5, 1.5))), Contains("restitution must be"));
    CHECK_THAT(refusal(model(body("box", 2, flat_box, Vec3(0, 0, 0.04)), on_floor("box", flat_surface, 0.5))),
               Contains("contact 'box-ground'") && Contains("must not overlap by more than"));
    CHECK_THAT(refusal(model(box, on_floor("box", flat_surface, 0.5))),
               Contains("does not support rigid contacts") && Contains("rA-moreau-1"));
    CHECK_THAT(
        refusal(model(box, R"({"body_i": "box", "body_j": "ground", "surface_i": )" + flat_surface +
                               R"(, "surface_j": {"type": "plane"}, "normal": {"type": "constraint"}})")),
        Contains("touches at several points"));
    CHECK_THAT(
        refusal(model(
            box,
            R"({"body_i": "box", "body_j": "ground", "surface_i": )" + flat_surface +
                R"(, "surface_j": {"type": "torus", "ring_radius": 2, "tube_radius": 1}, "normal": {"type": "dvi"}})")),
        Contains(
            "can be paired with a plane, sphere, box, capsule, polygon, convex, ellipsoid or superquadric"));
}

TEST_CASE("bodies that overlap at the start are moved apart if the initial state may be projected",
          "[contact][rigid]")
{
    // two boxes of 2 kg and 1 kg on a floor overlap by 3 mm, the lower one and the floor by 1 mm
    const std::string text = model(
        joined({body("a", 2, box_shape(Vec3(0.2, 0.2, 0.1)), Vec3(0, 0, 0.049)),
                body("b", 1, box_shape(Vec3(0.2, 0.2, 0.1)), Vec3(0.02, 0, 0.146), Vec3(1, 0, 0))}),
        joined(
            {on_floor("a", box_surface(Vec3(0.2, 0.2, 0.1)), 0.5),
             contact_of("b", "a", box_surface(Vec3(0.2, 0.2, 0.1)), box_surface(Vec3(0.2, 0.2, 0.1)), 0.5)}));
    dae::Description d = dae::read_model(text, "m.json");
    CHECK_THROWS_WITH(dae::start(d),
                      Catch::Contains("contact 'a-ground'") && Catch::Contains("--fix-initial"));
    const dae::StartReport report = dae::start(d, {.fix_initial = true});
    CHECK(report.projected);
    CHECK(d.x.body[0].r.z() == Approx(0.05).epsilon(1e-8));
    CHECK(d.x.body[1].r.z() == Approx(0.15).epsilon(1e-8));
    CHECK(d.x.body[1].r.x() == Approx(0.02));
    CHECK(d.x.body[1].rdot == Vec3(1, 0, 0));
}

}  // namespace rigid_tests
