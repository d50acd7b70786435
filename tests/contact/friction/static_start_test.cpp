// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that friction holds from the start: springs in static equilibrium.
#include "contact/friction/tracked_force.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "tests/support/watched_march.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <Eigen/LU>

#include <cmath>
#include <random>

using namespace hilda;
using Catch::Contains;

namespace {

constexpr double m = 2, R = 0.05, g = 9.81, k_n = 1e6, K_E = 1e4;
const double I = 0.4 * m * R * R;

/// A ball on the plane z = 0 with gravity inclined by the angle theta towards the direction phi. `guide`: its
/// orientation is constrained. `normal`: hooke, in equilibrium, or constraint.
std::string ball(double theta, const std::string& normal, const std::string& friction, bool guide,
                 double phi = 0)
{
    const bool is_compliant = normal == "hooke";
    const std::string fixed =
        R"("constraints": [)"
        R"({"type": "DP1", "body_i": "ground", "body_j": "b", "a_bar_i": [1, 0, 0], "a_bar_j": [0, 0, 1]}, )"
        R"({"type": "DP1", "body_i": "ground", "body_j": "b", "a_bar_i": [1, 0, 0], "a_bar_j": [0, 1, 0]}, )"
        R"({"type": "DP1", "body_i": "ground", "body_j": "b", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 0, 1]}], )";
    return fmt::format(
        R"({{"hilda_model": 1, "name": "ball", "gravity": [{:.17g}, {:.17g}, {:.17g}], )"
        R"("bodies": [{{"name": "b", "mass": {}, "inertia": [{}, {}, {}], "r": [0, 0, {:.17g}]}}], {})"
        R"("contacts": [{{"name": "c", "body_i": "b", "body_j": "ground", )"
        R"("surface_i": {{"type": "sphere", "radius": {}}}, "surface_j": {{"type": "plane"}}, )"
        R"("normal": {}, "friction": {}}}]}})",
        g * std::sin(theta) * std::cos(phi), g * std::sin(theta) * std::sin(phi), -g * std::cos(theta), m, I,
        I, I, R - (is_compliant ? m * g * std::cos(theta) / k_n : 0), guide ? fixed : "", R,
        is_compliant ? fmt::format(R"({{"type": "hooke", "stiffness": {}, "restitution": 0.5}})", k_n)
                     : R"({"type": "constraint"})",
        friction);
}

dae::Description started(const std::string& text, dae::StartReport* report = nullptr)
{
    dae::Description d = dae::read_model(text, "m.json");
    const dae::StartReport of = dae::start(d);
    if (report != nullptr) *report = of;
    return d;
}

/// The largest distance of body 0 from its place in the horizontal directions, over a run
double largest_motion(const dae::Description& d, const std::string& scheme, double end, double h)
{
    double largest = 0;
    tests::march(*d.model, d.x, scheme, end, h, [&](const lie::State& node) {
        largest = std::max(largest, (node.body[0].r - d.x.body[0].r).head<2>().norm());
    });
    return largest;
}

struct Case {
    std::string law, normal;
    double limit;  ///< tan of the largest angle at which the body is held
};

const std::string slide = R"("mu_s": 0.5, "mu_k": 0.2, "K_E": 1e4)";
const double deflection = m * g / K_E;  ///< of a spring that carries the weight

std::vector<std::string> schemes_of(const Case& of)
{
    if (of.law.find("implicit") != std::string::npos)
        return {"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"};
    if (of.normal == "constraint") return {"rA-half-1", "rA-half-1-kick", "rA-half-2", "rA-half-1-momentum"};
    return {"rA-half-1", "rA-half-1-kick", "rA-half-2", "rA-dop853"};
}

void check_held(const Case& of, bool guide, double end)
{
    for (const double part : {0.5, 0.8, 0.95, 0.99})
        for (const std::string& scheme : schemes_of(of))
            for (const double h : {1e-3, 3e-4, 1e-4}) {
                if (end > 1 && h < 1e-3) continue;
                const dae::Description d =
                    started(ball(std::atan(part * of.limit), of.normal, of.law, guide, 0.7));
                CAPTURE(of.law, of.normal, part, scheme, h);
                CHECK(d.warnings.empty());
                CHECK(largest_motion(d, scheme, end, h) < 1e-6 * deflection);
            }
}

const Case sliding[] = {{"{" + slide + "}", "hooke", 0.5},
                        {"{" + slide + "}", "constraint", 0.5},
                        {R"({"law": "epsd", )" + slide + "}", "hooke", 0.5},
                        {R"({"law": "constant-torque", )" + slide + "}", "hooke", 0.5},
                        {R"({"law": "implicit", )" + slide + "}", "constraint", 0.5},
                        {R"({"law": "implicit", "D_slide": 0, )" + slide + "}", "constraint", 0.5}};
// the torque m g sin(theta) R against 2 eta_r mu_s N R, and mu_r N R
const Case rolling[] = {{R"({"eta_r": 0.2, "eta_psi": 0.1, )" + slide + "}", "hooke", 0.2},
                        {R"({"eta_r": 0.2, )" + slide + "}", "constraint", 0.2},
                        {R"({"law": "epsd", "mu_r": 0.15, )" + slide + "}", "hooke", 0.15},
                        {R"({"law": "implicit", "eta_r": 0.2, )" + slide + "}", "constraint", 0.2}};

}  // namespace

TEST_CASE("a body below the limit of friction does not move (long)", "[contact][friction]")
{
    for (const Case& of : sliding) check_held(of, true, 0.2);
}

TEST_CASE("a ball below the limit of rolling resistance does not roll (long)", "[contact][friction]")
{
    for (const Case& of : rolling) check_held(of, false, 0.2);
}

TEST_CASE("a body held by friction does not creep in 10 s (long)", "[contact][friction]")
{
    for (const Case& of : sliding) check_held(of, true, 10);
    for (const Case& of : rolling) check_held(of, false, 10);
}

TEST_CASE("a body above the limit slides from the start, with a warning", "[contact][friction]")
{
    const double theta = std::atan(0.6), a = g * (std::sin(theta) - 0.2 * std::cos(theta)), t = 0.3;
    for (const Case& of : sliding) {
        if (of.law.find("implicit") != std::string::npos) continue;
        CAPTURE(of.law, of.normal);
        const dae::Description d = started(ball(theta, of.normal, of.law, true));
        REQUIRE(d.warnings.size() == 1);
        CHECK_THAT(d.warnings[0],
                   Contains("contact 'c': its bodies are at rest, and sliding friction of 10.1 "
                            "would hold them, more than the largest, 8.41; they begin to slip"));
        CHECK(d.x.body[0].rddot.x() == Approx(a).epsilon(1e-9));
        const lie::State x = tests::march(*d.model, d.x, "rA-half-1-kick", t, 1e-4);
        CHECK(x.body[0].r.x() == Approx(0.5 * a * t * t).epsilon(1e-6));
    }
}

TEST_CASE("implicit friction above the limit slides from the start", "[contact][friction]")
{
    const double theta = std::atan(0.6), a = g * (std::sin(theta) - 0.2 * std::cos(theta)), t = 0.3;
    for (const Case& of : sliding) {
        if (of.law.find("implicit") == std::string::npos) continue;
        const dae::Description d = started(ball(theta, of.normal, of.law, true));
        const lie::State x = tests::march(*d.model, d.x, "rA-half-1-kick", t, 1e-4);
        CHECK(x.body[0].r.x() == Approx(0.5 * a * t * t).epsilon(1e-3));
    }
}

TEST_CASE("implicit and other friction hold bodies of one model", "[contact][friction]")
{
    const double theta = std::atan(0.45);
    const auto part = [](const char* name, int y, const std::string& friction) {
        return std::pair(
            fmt::format(R"({{"name": "{}", "mass": 2, "inertia": [1, 1, 1], "r": [0, {}, 0.05]}})", name, y),
            fmt::format(R"({{"name": "c-{0}", "body_i": "{0}", "body_j": "ground", )"
                        R"("surface_i": {{"type": "sphere", "radius": 0.05}}, "surface_j": {{"type": )"
                        R"("plane"}}, "normal": {{"type": "constraint"}}, "friction": {1}}})",
                        name, friction));
    };
    // Balls that neither slide nor roll
    const std::string resists = R"("eta_r": 0.5, )" + slide + "}";
    const auto implicit = part("implicit", 0, R"({"law": "implicit", )" + resists),
               tracked = part("tracked", 1, "{" + resists);
    const dae::Description d = started(fmt::format(
        R"({{"hilda_model": 1, "name": "two", "gravity": [{:.17g}, 0, {:.17g}], "bodies": [{}, {}], "contacts": [{}, {}]}})",
        g * std::sin(theta), -g * std::cos(theta), implicit.first, tracked.first, implicit.second,
        tracked.second));
    CHECK(d.warnings.empty());
    double largest = 0;
    tests::march(*d.model, d.x, "rA-half-1-kick", 0.2, 1e-4, [&](const lie::State& node) {
        for (std::size_t b = 0; b < 2; ++b)
            largest = std::max(largest, (node.body[b].r - d.x.body[b].r).norm());
    });
    CHECK(largest < 1e-6 * deflection);
}

TEST_CASE("a ball released on a slope has the force of rolling from the start", "[contact][friction]")
{
    const double theta = std::atan(0.9), t = 0.2;
    for (const auto& [normal, scheme] :
         {std::pair{"constraint", "rA-half-1-kick"}, std::pair{"hooke", "rA-dop853"}}) {
        CAPTURE(normal);
        // The friction acts in the middle of the overlap; the slip is that at the surface.
        const double overlap = normal == std::string("hooke") ? m * g * std::cos(theta) / k_n : 0,
                     a = g * std::sin(theta) / (1 + I / (m * R * (R - overlap / 2)));
        const dae::Description d = started(ball(theta, normal, "{" + slide + "}", false));
        CHECK(d.warnings.empty());
        double largest = 0;
        tests::march(*d.model, d.x, scheme, t, 1e-4, [&](const lie::State& node) {
            largest = std::max(largest, std::abs(node.body[0].r.x() - 0.5 * a * node.t * node.t));
        });
        CHECK(largest < 1e-4 * deflection);
        // without the static start the spring is stretched by 2/7 m g sin(theta)/K_E first
        const dae::Description jump =
            started(ball(theta, normal, R"({"start": "unstretched", )" + slide + "}", false));
        CHECK(std::abs(jump.x.body[0].rddot.x() - a) > 0.1 * a);
    }
}

TEST_CASE("springs below the points of a body have the forces of smallest energy", "[contact][friction]")
{
    // A plate that may slide and turn on the floor, on four points with given normal forces. Springs that a
    // displacement (d, phi) stretches have the smallest energy: f_k = -K (d + phi e_z × s_k).
    const Eigen::Vector2d s[] = {{1, 0.5}, {-1, 0.7}, {-0.2, -0.6}, {0.9, -0.4}};
    const double weight = 3 * 9.81, phi = 0.4;
    std::string contacts;
    for (const Eigen::Vector2d& at : s)
        contacts +=
            fmt::format(R"({}{{"body_i": "plate", "body_j": "ground", "surface_i": {{"type": "sphere", )"
                        R"("radius": 0.1, "position": [{}, {}, 0]}}, "surface_j": {{"type": "plane"}}, )"
                        R"("normal": {{"type": "given", "force": 50}}, "friction": {{{}}}}})",
                        contacts.empty() ? "" : ", ", at.x(), at.y(), slide);
    dae::Description d = started(
        fmt::format(R"({{"hilda_model": 1, "name": "plate", "gravity": [{:.17g}, {:.17g}, 0], )"
                    R"("bodies": [{{"name": "plate", "mass": 3, "inertia": [1, 1, 1], "r": [0, 0, 0.1]}}], )"
                    R"("constraints": [{{"type": "planar", "body_i": "ground", "body_j": "plate", )"
                    R"("s_bar_p_i": [0, 0, 0.1], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}}], )"
                    R"("contacts": [{}]}})",
                    9.81 * std::cos(phi), 9.81 * std::sin(phi), contacts));
    CHECK(d.warnings.empty());
    CHECK(d.x.body[0].rddot.norm() < 1e-9);
    CHECK(d.x.body[0].omegadot_bar.norm() < 1e-9);
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector2d& at : s) {
        Eigen::Matrix<double, 2, 3> B;
        B << 1, 0, -at.y(), 0, 1, at.x();
        A += B.transpose() * B;
    }
    const Eigen::Vector3d load(weight * std::cos(phi), weight * std::sin(phi), 0);
    const Eigen::Vector3d moved = A.inverse() * load;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto& force = dynamic_cast<const contact::TrackedForce&>(*d.model->forces()[k]);
        const lie::Vec3 F = force.friction(d.x).F_E;
        CAPTURE(k);
        CHECK(F.x() == Approx(-(moved[0] - s[k].y() * moved[2])).epsilon(1e-8));
        CHECK(F.y() == Approx(-(moved[1] + s[k].x() * moved[2])).epsilon(1e-8));
    }
}

TEST_CASE("a body on a platform that begins to accelerate is held by friction", "[contact][friction]")
{
    for (const auto& [a, is_held] : {std::pair{0.45 * g, true}, std::pair{0.55 * g, false}}) {
        CAPTURE(a);
        dae::Description d = started(fmt::format(
            R"({{"hilda_model": 1, "name": "platform", "gravity": [0, 0, -{}], "bodies": [)"
            R"({{"name": "box", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0.1], "r_dot": [0.3, 0, 0]}}, )"
            R"({{"name": "platform", "mass": 5, "inertia": [1, 1, 1], "r": [0, 0, 0], "r_dot": [0.3, 0, 0]}}], )"
            R"("constraints": [{{"type": "translational", "name": "rail", "body_i": "ground", "body_j": "platform", )"
            R"("axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}}, )"
            R"({{"type": "CD", "name": "drive", "body_i": "ground", "body_j": "platform", "c": [1, 0, 0], )"
            R"("f": "0.3*t + {:.17g}*t^2"}}, )"
            R"({{"type": "translational", "body_i": "platform", "body_j": "box", "axis_bar_i": [1, 0, 0], )"
            R"("s_bar_p_i": [0, 0, 0.1], "axis_bar_j": [1, 0, 0]}}], )"
            R"("contacts": [{{"name": "c", "body_i": "box", "body_j": "platform", )"
            R"("surface_i": {{"type": "sphere", "radius": 0.1}}, "surface_j": {{"type": "plane"}}, )"
            R"("normal": {{"type": "given", "force": {}}}, "friction": {{{}}}}}]}})",
            g, 0.5 * a, g, slide));
        CHECK(d.warnings.empty() == is_held);
        CHECK(d.x.body[0].rddot.x() == Approx(is_held ? a : 0.2 * g).epsilon(1e-9));
    }
}

TEST_CASE("the static start holds bodies of all sizes", "[contact][friction]")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int k = 0; k < 60; ++k) {
        const double size = std::pow(10, 8 * uniform(random) - 5),
                     mass = std::pow(10, 12 * uniform(random) - 6), part = 0.5 + 0.49 * uniform(random),
                     theta = std::atan(0.4 * part), phi = 6.28 * uniform(random),
                     inertia = 0.4 * mass * size * size,
                     stiffness = mass * g / size * std::pow(10, 2 + 4 * uniform(random));
        CAPTURE(k, size, mass, part);
        const bool is_compliant = k % 2 == 0;
        const dae::Description d = started(fmt::format(
            R"({{"hilda_model": 1, "name": "ball", "gravity": [{:.17g}, {:.17g}, {:.17g}], )"
            R"("bodies": [{{"name": "b", "mass": {:.17g}, "inertia": [{:.17g}, {:.17g}, {:.17g}], )"
            R"("r": [0, 0, {:.17g}]}}], "contacts": [{{"name": "c", "body_i": "b", "body_j": "ground", )"
            R"("surface_i": {{"type": "sphere", "radius": {:.17g}}}, "surface_j": {{"type": "plane"}}, )"
            R"("normal": {}, "friction": {{"mu_s": 0.5, "mu_k": 0.1, "K_E": {:.17g}, "eta_r": 0.4}}}}]}})",
            g * std::sin(theta) * std::cos(phi), g * std::sin(theta) * std::sin(phi), -g * std::cos(theta),
            mass, inertia, inertia, inertia,
            size - (is_compliant ? mass * g * std::cos(theta) / stiffness : 0), size,
            is_compliant ? fmt::format(R"({{"type": "hooke", "stiffness": {:.17g}}})", stiffness)
                         : R"({"type": "constraint"})",
            stiffness));
        CHECK(d.warnings.empty());
        CHECK(d.x.body[0].rddot.head<2>().norm() < 1e-8 * g);
        CHECK(d.x.body[0].omegadot_bar.norm() < 1e-8 * g / size);
    }
}

TEST_CASE("friction does not hold a body whose motion is prescribed", "[contact][friction]")
{
    // A driver accelerates the box along the floor from rest; a second box beside it is held by friction.
    const std::string
        box = R"({{"name": "{0}", "mass": 1, "inertia": [1, 1, 1], "r": [0, {1}, 0.1]}})",
        contact = R"({{"name": "c-{0}", "body_i": "{0}", "body_j": "ground", )"
                  R"("surface_i": {{"type": "sphere", "radius": 0.1}}, "surface_j": {{"type": "plane"}}, )"
                  R"("normal": {{"type": "given", "force": 10}}, "friction": {{{1}}}}})",
        rail = R"({{"type": "translational", "name": "rail-{0}", "body_i": "ground", "body_j": "{0}", )"
               R"("s_bar_p_i": [0, {1}, 0.1], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}})";
    const dae::Description d = started(
        R"({"hilda_model": 1, "name": "boxes", "gravity": [2, 0, -9.81], "bodies": [)" +
        fmt::format(fmt::runtime(box), "driven", 0) + ", " + fmt::format(fmt::runtime(box), "held", 1) +
        R"(], "constraints": [)" + fmt::format(fmt::runtime(rail), "driven", 0) + ", " +
        fmt::format(fmt::runtime(rail), "held", 1) +
        R"(, {"type": "CD", "name": "drive", "body_i": "ground", "body_j": "driven", "c": [1, 0, 0], "s_bar_p_i": [0, 0, 0.1], )"
        R"("f": "1.5*t^2"}], "contacts": [)" +
        fmt::format(fmt::runtime(contact), "driven", slide) + ", " +
        fmt::format(fmt::runtime(contact), "held", slide) + "]}");
    CHECK(d.warnings.empty());
    CHECK(d.x.body[0].rddot.x() == Approx(3));
    CHECK(std::abs(d.x.body[1].rddot.x()) < 1e-9);
    const auto friction = [&](std::size_t k) {
        return dynamic_cast<const contact::TrackedForce&>(*d.model->forces()[k]).friction(d.x).F_E;
    };
    CHECK(friction(0).norm() < 1e-9);
    CHECK(friction(1).x() == Approx(-2));
}

TEST_CASE("a ball at rest on a floor has no friction and no warning", "[contact][friction]")
{
    for (const double turn : {0., 0.3, 1.1})
        for (const char* const normal : {"hooke", "constraint"}) {
            // Gravity is along the normal up to rounding errors.
            const dae::Description d =
                started(ball(1e-17, normal, R"({"eta_r": 0.2, "eta_psi": 0.1, )" + slide + "}", false, turn));
            CAPTURE(turn, normal);
            CHECK(d.warnings.empty());
            const auto& force = dynamic_cast<const contact::TrackedForce&>(*d.model->forces().back());
            CHECK(force.friction(d.x).F.norm() < 1e-12 * m * g);
        }
}

TEST_CASE("springs of the dissertation preset start unstretched", "[contact][friction]")
{
    const dae::Description d =
        started(ball(0.3, "hooke", R"({"preset": "dissertation", )" + slide + "}", true));
    CHECK(d.warnings.empty());
    CHECK(d.x.body[0].rddot.x() == Approx(g * std::sin(0.3)));
    const dae::Description held =
        started(ball(0.3, "hooke", R"({"preset": "dissertation", "start": "static", )" + slide + "}", true));
    CHECK(std::abs(held.x.body[0].rddot.x()) < 1e-9);
}
