// SPDX-License-Identifier: GPL-3.0-or-later
// Compliant contacts of bodies with edges.
#include <catch2/catch.hpp>

#include "contact/compliant/manifold_force.hpp"
#include "tests/contact/rigid/rigid_models.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

using namespace hilda;

namespace manifold_tests {

using namespace rigid_tests;

namespace {

constexpr double k = 2e5;  // stiffness [N/m]

std::string hooke(double mu, double e = 1, double K_E = 1e5)
{
    return R"("normal": {"type": "hooke", "stiffness": 2e5, "restitution": )" + number(e) + "}" +
           (mu > 0 ? R"(, "friction": {"mu_s": )" + number(mu) + R"(, "mu_k": )" + number(mu) +
                         R"(, "K_E": )" + number(K_E) + "}"
                   : "");
}

std::string contact(const std::string& i, const std::string& j, const std::string& surface_i,
                    const std::string& surface_j, const std::string& laws)
{
    return R"({"name": ")" + i + '-' + j + R"(", "body_i": ")" + i + R"(", "body_j": ")" + j +
           R"(", "surface_i": )" + surface_i + R"(, "surface_j": )" + surface_j + ", " + laws + '}';
}

const std::string plane = R"({"type": "plane"})";

class CompliantRun {
public:
    CompliantRun(const std::string& text, double h, const char* scheme = "rA-half-2")
        : of(dae::read_model(text, "m.json")), h(h)
    {
        dae::start(of);
        integrator = lie::scheme(scheme).make(*of.model, {});
        march = std::make_unique<lie::March>(of.x, *integrator, h);
    }
    void to(double t, const std::function<void()>& visit = {})
    {
        for (long n = std::lround((t - state().t) / h); n > 0; --n) {
            march->advance({});
            if (visit) visit();
        }
    }
    const State& state() const { return march->node(); }
    const lie::Motion& body(int b) const { return state().body[static_cast<std::size_t>(b)]; }
    const contact::ManifoldForce& force(int n = 0) const
    {
        return dynamic_cast<const contact::ManifoldForce&>(*of.model->forces()[static_cast<std::size_t>(n)]);
    }
    std::vector<contact::LoadedPoint> points(int n = 0) const
    {
        std::vector<contact::LoadedPoint> found;
        force(n).points(state(), found);
        return found;
    }
    double energy() const { return lie::energy(*of.model, state()); }
    const dae::Model& model() const { return *of.model; }
    void advance() { march->advance({}); }

private:
    dae::Description of;
    const double h;
    std::unique_ptr<lie::Integrator> integrator;
    std::unique_ptr<lie::March> march;
};

/// A prism of 1 kg with a regular base of n corners and the height 0.1 m
std::string prism(int n)
{
    std::string all = R"({"type": "convex", "vertices": [)";
    for (const double z : {-0.05, 0.05})
        for (int c = 0; c < n; ++c) {
            const double a = 2 * std::numbers::pi * c / n;
            all += (z < 0 && c == 0 ? "" : ", ") + list({0.2 * std::cos(a), 0.2 * std::sin(a), z});
        }
    return all + "]}";
}

}  // namespace

TEST_CASE("a body on its face sinks by its weight over the stiffness, with any number of corners",
          "[contact][compliant][manifold]")
{
    for (const int n : {3, 4, 5, 6, 7, 12, 40}) {
        CAPTURE(n);
        CompliantRun r(model(body("b", 1, box_shape({0.2, 0.2, 0.1}), {0, 0, 0.05 - g / k}),
                             contact("b", "ground", prism(n), plane, hooke(0))),
                       1e-4);
        double N = 0;
        for (const contact::LoadedPoint& p : r.points()) N += p.N;
        CHECK(N == Approx(g).epsilon(1e-12));
        r.to(0.05);
        CHECK(std::abs(r.body(0).r.z() - (0.05 - g / k)) < 1e-12);
        CHECK(r.body(0).omega_bar.norm() < 1e-10);
    }
}

TEST_CASE("a box that lies on another one with a part of its face has the stiffness of the law",
          "[contact][compliant][manifold]")
{
    // the lower box is at rest; the upper one overhangs and is turned
    for (const double x : {0., 0.03, 0.07})
        for (const double turned : {0., 0.4}) {
            CAPTURE(x, turned);
            const std::string box = box_surface({0.2, 0.2, 0.1});
            CompliantRun r(
                model(body("a", 1, box_shape({0.2, 0.2, 0.1}), {x, 0.01, 0.05 - 1e-5}, Vec3::Zero(),
                           Vec3::Zero(), R"(, "axis_angle": [0, 0, 1, )" + number(turned) + "]"),
                      contact("a", "ground", box,
                              R"({"type": "box", "lengths": [0.2, 0.2, 0.1], "position": [0, 0, -0.05]})",
                              hooke(0))),
                1e-4);
            double N = 0;
            Vec3 C = Vec3::Zero();
            for (const contact::LoadedPoint& p : r.points()) {
                CHECK(p.at.gap == Approx(-1e-5).epsilon(1e-9));
                N += p.N, C += p.N * p.at.C();
            }
            CHECK(N == Approx(1e-5 * k).epsilon(1e-9));
            if (turned == 0) CHECK((C / N - Vec3(x / 2, 0.005, -5e-6)).norm() < 1e-12);
        }
}

TEST_CASE("a box that falls on its face moves like a ball with the same law",
          "[contact][compliant][manifold]")
{
    for (const double e : {1., 0.5}) {
        CompliantRun box(
            model(body("b", 1, box_shape({0.2, 0.2, 0.1}), {0, 0, 0.0501}, {0, 0, -1}),
                  contact("b", "ground", box_surface({0.2, 0.2, 0.1}), plane, hooke(0, e)), Vec3::Zero()),
            1e-5),
            ball(model(body("b", 1, box_shape({0.2, 0.2, 0.1}), {0, 0, 0.0501}, {0, 0, -1}),
                       contact("b", "ground", rigid_tests::ball_surface(0.05),
                               R"({"type": "box", "lengths": [1, 1, 1], )"
                               R"("position": [0, 0, -0.5]})",
                               hooke(0, e)),
                       Vec3::Zero()),
                 1e-5);
        box.to(0.02), ball.to(0.02);
        CHECK(std::abs(box.body(0).r.z() - ball.body(0).r.z()) < 1e-12);
        CHECK(box.body(0).rdot.z() == Approx(e).epsilon(0.01));
        CHECK(box.body(0).omega_bar.norm() < 1e-12);
    }
}

TEST_CASE("a box that tumbles on a plane without friction keeps its energy to second order",
          "[contact][compliant][manifold][order]")
{
    // The shares of all corners of a box are equal, so that the contact has a potential.
    std::vector<double> error;
    for (const double h : {4e-5, 2e-5, 1e-5}) {
        CompliantRun r(model(body("b", 1, box_shape({0.2, 0.15, 0.1}), {0, 0, 0.12}, Vec3::Zero(),
                                  {1, 2, 0.5}, R"(, "axis_angle": [0.6, 0.8, 0, 0.5])"),
                             contact("b", "ground", box_surface({0.2, 0.15, 0.1}), plane, hooke(0))),
                       h);
        const double before = r.energy();
        int touching = 0;
        double largest = 0;
        r.to(0.5, [&] {
            largest = std::max(largest, std::abs(r.energy() - before));
            touching += r.points().empty() ? 0 : 1;
        });
        CHECK(touching > 100);
        error.push_back(largest);
    }
    CAPTURE(error[0], error[1], error[2]);
    CHECK(error[2] < 1e-4);
    CHECK(std::log2(error[0] / error[2]) > 3);
}

TEST_CASE("many corners have the force, the moment and the energy of all springs",
          "[contact][compliant][manifold]")
{
    // a tilted prism, of which some corners overlap
    const std::string slab = R"({"type": "box", "lengths": [2, 2, 1], "position": [0, 0, -0.5]})";
    for (const int n : {5, 8, 9, 12, 40})
        for (const double tilt : {0., 1e-3, 0.03})
            for (const double depth : {1e-4, 3e-4})
                for (const std::string& floor : {plane, slab}) {
                    CAPTURE(n, tilt, depth, floor);
                    std::vector<Vec3> corner;
                    for (int c = 0; c < n; ++c) {
                        const double a = 2 * std::numbers::pi * c / n;
                        corner.push_back({0.2 * std::cos(a), 0.2 * std::sin(a), -0.05});
                    }
                    const lie::Mat3 A = lie::exp(Vec3(0, tilt, 0));
                    double lowest = 0;
                    for (const Vec3& x : corner) lowest = std::min(lowest, (A * x).z());
                    const double z = -lowest - depth;
                    CompliantRun r(model(body("b", 1, box_shape({0.2, 0.2, 0.1}), {0, 0, z}, Vec3::Zero(),
                                              Vec3::Zero(), about_y(tilt)),
                                         contact("b", "ground", prism(n), floor, hooke(0))),
                                   1e-4);
                    Vec3 moment = Vec3::Zero(), exact_moment = Vec3::Zero();
                    double N = 0, exact = 0, energy = 0;
                    for (const contact::LoadedPoint& p : r.points()) {
                        N += p.N, moment += Vec3(p.at.C().x(), p.at.C().y(), 0).cross(p.N * p.at.n);
                    }
                    for (const Vec3& x : corner) {
                        const Vec3 at = A * x + Vec3(0, 0, z);
                        const double overlap = std::max(0., -at.z()), of_one = k * overlap / n;
                        exact += of_one, energy += 0.5 * of_one * overlap;
                        exact_moment += at.cross(Vec3(0, 0, of_one));
                    }
                    // On a plane the sides of the prism have a small weight. On a box the normal is that of
                    // the plate or of the prism.
                    const double shares = n != 4 && tilt > 0 ? 1e-2 : 1e-9;
                    CHECK(N == Approx(exact).epsilon(shares));
                    CHECK((moment - exact_moment).norm() < 0.2 * shares * exact + 1e-2 * tilt * exact);
                    CHECK(r.force().potential_energy(r.state()) == Approx(energy).epsilon(shares));
                }
}

TEST_CASE("the energy of a tumbling prism with many corners is kept (long)", "[contact][compliant][manifold]")
{
    for (const int n : {12, 40}) {
        CAPTURE(n);
        std::vector<double> error;
        for (const double h : {2e-5, 1e-5}) {
            CompliantRun r(model(body("b", 1, R"({"cylinder": [0.2, 0.1]})", {0, 0, 0.12}, Vec3::Zero(),
                                      {0.5, 1, 0.3}, R"(, "axis_angle": [0.6, 0.8, 0, 0.2])"),
                                 contact("b", "ground", prism(n), plane, hooke(0))),
                           h);
            const double before = r.energy();
            double largest = 0;
            int most = 0;
            r.to(0.5, [&] {
                largest = std::max(largest, std::abs(r.energy() - before));
                most = std::max(most, static_cast<int>(r.points().size()));
            });
            CHECK(most > 1);
            error.push_back(largest / before);
        }
        CAPTURE(error[0], error[1]);
        CHECK(error[1] < 2e-3);
    }
}

TEST_CASE("a capsule that stands on one end has half of the stiffness", "[contact][compliant][manifold]")
{
    CompliantRun r(model(body("b", 1, box_shape({0.1, 0.1, 0.3}), {0, 0, 0.15 - 2 * g / k}),
                         contact("b", "ground", R"({"type": "capsule", "length": 0.2, "radius": 0.05})",
                                 plane, hooke(0))),
                   1e-4);
    REQUIRE(r.points().size() == 1);
    CHECK(r.points()[0].N == Approx(g).epsilon(1e-9));
}

TEST_CASE("bodies that exchange their names have opposite loads", "[contact][compliant][manifold]")
{
    tests::Random random(11);
    const std::string a = box_surface({0.2, 0.15, 0.1}), b = prism(5), shape = box_shape({0.2, 0.2, 0.1});
    int touching = 0;
    for (int n = 0; n < 10; ++n) {
        const Vec3 at = 0.35 * random.unit();
        const std::string bodies = body("a", 1, shape, Vec3::Zero(), random.vector(0.1), random.vector()) +
                                   ", " +
                                   body("b", 2, shape, at, -6 * at + random.vector(0.1), random.vector());
        CompliantRun of(model(bodies, contact("a", "b", a, b, hooke(0.3)), Vec3::Zero()), 1e-4),
            exchanged(model(bodies, contact("b", "a", b, a, hooke(0.3)), Vec3::Zero()), 1e-4);
        lie::Loads x(2), y(2);
        of.to(0.02);
        while (of.points().empty() && of.state().t < 0.1) of.advance();
        exchanged.to(of.state().t);
        of.force().add(of.state(), x), exchanged.force().add(exchanged.state(), y);
        touching += of.points().empty() ? 0 : 1;
        for (int body = 0; body < 2; ++body) {
            CHECK((x.F[body] - y.F[body]).norm() <= 1e-9 * (1 + x.F[body].norm()));
            CHECK((x.n_bar[body] - y.n_bar[body]).norm() <= 1e-9 * (1 + x.F[body].norm()));
        }
        CHECK((x.F[0] + x.F[1]).norm() <= 1e-12 * (1 + x.F[0].norm()));
    }
    CHECK(touching == 10);
}

TEST_CASE("a box on a slope is held by friction below the angle of friction and slides above it",
          "[contact][compliant][manifold]")
{
    for (const double angle : {25., 35.}) {
        const double a = angle * degree, mu = std::tan(30 * degree), N = g * std::cos(a);
        CompliantRun r(model(body("b", 1, box_shape({0.2, 0.2, 0.1}), {0, 0, 0.05 - N / k}),
                             contact("b", "ground", box_surface({0.2, 0.2, 0.1}), plane, hooke(mu, 0.2)),
                             g * Vec3(std::sin(a), 0, -std::cos(a))),
                       1e-4);
        r.to(0.3);
        const double speed = r.body(0).rdot.x();
        r.to(0.5);
        Vec3 F = Vec3::Zero();
        for (const contact::LoadedPoint& p : r.points()) F += p.F;
        CAPTURE(angle, r.body(0).r.x());
        if (angle < 30) {
            CHECK(std::abs(r.body(0).r.x()) < 1e-3 * 0.25);
            CHECK(r.body(0).rdot.norm() < 1e-8);
            CHECK((F - Vec3(-g * std::sin(a), 0, 0)).norm() < 1e-6);
        } else {
            const double sliding = g * (std::sin(a) - mu * std::cos(a));
            CHECK((r.body(0).rdot.x() - speed) / 0.2 == Approx(sliding).epsilon(1e-4));
            CHECK((F - Vec3(-mu * N, 0, 0)).norm() < 1e-3);
        }
    }
}

TEST_CASE("friction and normal force are continuous where a box slides over the edge of another one",
          "[contact][compliant][manifold]")
{
    const std::string box = box_surface({0.2, 0.2, 0.1});
    CompliantRun r(
        model(body("a", 1, box_shape({0.2, 0.2, 0.1}), {-0.002, 0.013, 0.05 - g / k}, {0.05, 0, 0}),
              contact("a", "ground", box,
                      R"({"type": "box", "lengths": [0.2, 0.2, 0.1], "position": [0, 0, -0.05]})",
                      hooke(0.01, 0.2))),
        1e-4);
    double before = g;
    int features = 0;
    std::uint32_t last = r.points().front().feature;
    r.to(0.2, [&] {
        double N = 0;
        for (const contact::LoadedPoint& p : r.points()) N += p.N;
        CHECK(std::abs(N - before) < 0.02 * g);
        before = N;
        features += r.points().front().feature != last ? 1 : 0;
        last = r.points().front().feature;
    });
    CHECK(features > 0);
    CHECK(std::abs(r.body(0).r.z() - (0.05 - g / k)) < 1e-6);
}

TEST_CASE("a step of compliant contacts with several points allocates nothing",
          "[contact][compliant][manifold]")
{
    if (!tests::counts_allocations) return;
    CompliantRun r(model(body("b", 1, box_shape({0.2, 0.15, 0.1}), {0, 0, 0.06}, {0.2, 0, 0}, {1, 2, 0.5}),
                         contact("b", "ground", box_surface({0.2, 0.15, 0.1}), plane, hooke(0.3, 0.5))),
                   1e-4);
    r.to(0.1);
    CHECK(tests::allocations_during([&] { r.to(0.2); }) == 0);
}

TEST_CASE("laws that need the curvature of an edge are refused", "[contact][compliant][manifold]")
{
    const auto error = [](const std::string& laws, const std::string& other) -> std::string {
        try {
            const std::string text =
                model(body("b", 1, box_shape({0.2, 0.2, 0.2}), {0, 0, 0.5}),
                      contact("b", "ground", other, R"({"type": "box", "lengths": [1, 1, 0.1]})", laws));
            dae::read_model(text, "m.json");
        } catch (const std::exception& e) {
            return e.what();
        }
        return "";
    };
    const std::string hertz = R"("normal": {"type": "hertz", "E_star": 1e6})",
                      rolling = R"("normal": {"type": "hooke", "stiffness": 1e5}, )"
                                R"("friction": {"mu_s": 0.3, "K_E": 1e4, "eta_r": 0.1})",
                      box = box_surface({0.2, 0.2, 0.2});
    CHECK(error(hertz, box).find("m.json") == 0);
    CHECK(error(hertz, box).find("use hooke, got a box and a box") != std::string::npos);
    CHECK(error(rolling, box).find("leave them out, got a box and a box") != std::string::npos);
    CHECK(error(hertz, rigid_tests::ball_surface(0.1)) == "");
}

TEST_CASE("a ball on a face, an edge and a corner of a box has the curvature of its surface",
          "[contact][compliant][manifold]")
{
    const std::string hertz = R"("normal": {"type": "hertz", "E_star": 1e6})",
                      box = R"({"type": "box", "lengths": [0.2, 0.2, 0.2]})";
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, 1, 1).normalized(), Vec3(1, 1, 1).normalized()}) {
        const Vec3 on_box = 0.1 * n / n.maxCoeff();
        for (const bool box_first : {false, true}) {
            const std::string ball = rigid_tests::ball_surface(0.05);
            CompliantRun r(model(body("b", 1, ball_shape(0.05), on_box + (0.05 - 1e-4) * n),
                                 box_first ? contact("ground", "b", box, ball, hertz)
                                           : contact("b", "ground", ball, box, hertz),
                                 Vec3::Zero()),
                           1e-4);
            CAPTURE(n.transpose(), box_first);
            REQUIRE(r.points().size() == 1);
            CHECK(r.points()[0].N == Approx(4. / 3 * 1e6 * std::sqrt(0.05) * std::pow(1e-4, 1.5)));
        }
    }
}

TEST_CASE("boxes of a group move as those of single contacts (long)",
          "[contact][compliant][manifold][neighbours]")
{
    const std::string box = box_surface({0.1, 0.1, 0.1});
    std::vector<std::string> bodies, single;
    for (int b = 0; b < 9; ++b) {
        const int column = b % 3, row = b / 3;
        bodies.push_back(body("b" + std::to_string(b), 1, box_shape({0.1, 0.1, 0.1}),
                              {0.13 * column, 0.13 * row, 0.1 + 0.02 * b}, {0.3 * (1 - b % 3), 0, -1},
                              {1, 0.5 * b, 0}));
        for (int other = 0; other < b; ++other)
            single.push_back(
                contact("b" + std::to_string(other), "b" + std::to_string(b), box, box, hooke(0.3, 0.5)));
    }
    const std::string floor = R"({"name": "floor", "body_i": "all", "body_j": "ground", "surface_i": )" +
                              box + R"(, "surface_j": {"type": "plane"}, )" + hooke(0.3, 0.5) + '}',
                      group = R"({"name": "boxes", "bodies": "all", "surface": )" + box + ", " +
                              hooke(0.3, 0.5) + '}';
    CompliantRun a(model(joined(bodies), floor + ", " + joined(single)), 1e-4),
        b(model(joined(bodies), floor + ", " + group), 1e-4);
    REQUIRE(a.model().forces().size() == 9 + 36);
    REQUIRE(b.model().near_forces().pairs() == 36);
    bool have_met = false;
    a.to(0.3, [&] {
        for (int n = 9; n < 45; ++n) have_met = have_met || a.force(n).overlap(a.state()) > 0;
    });
    b.to(0.3);
    CHECK(have_met);
    for (int n = 0; n < 9; ++n) {
        CHECK((a.body(n).r - b.body(n).r).norm() == 0);
        CHECK((a.body(n).A - b.body(n).A).norm() == 0);
    }
}

}  // namespace manifold_tests
