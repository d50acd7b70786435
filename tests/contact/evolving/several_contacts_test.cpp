// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit friction where contacts act on each other, and where Coulomb's law has no solution.
#include "contact/evolving/unilateral.hpp"
#include "contact/soft_friction.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/torus.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/gravity.hpp"
#include "tests/support/watched_march.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::contact;
using lie::State;
using tests::g;

namespace {

double energy(const dae::Model& model, const State& x)
{
    double E = model.potential_energy(x);
    for (size_t b = 0; b < x.body.size(); ++b)
        E += 0.5 * model.mass().m[b] * x.body[b].rdot.squaredNorm() +
             0.5 * x.body[b].omega_bar.dot(model.mass().J_bar[b] * x.body[b].omega_bar);
    return E;
}

/// The state after t; on_node is called with every node.
State run_unilateral(const dae::Model& model, const State& x, const std::string& scheme, double t, double h,
                     const tests::NodeFunction& on_node)
{
    struct NodeObserver final : lie::Observer {
        explicit NodeObserver(const tests::NodeFunction& on_node) : on_node(on_node) {}
        void accepted(const State& node, long, int) override { on_node(node); }
        const tests::NodeFunction& on_node;
    } node_observer(on_node);
    const auto integrator = make_integrator(model, lie::scheme(scheme), {});
    lie::Observer* all[] = {&node_observer};
    return lie::march(x, *integrator, lie::TimeGrid::over(t, h, t), all).row.back();
}

/// Balls that are dropped into a spherical bowl, with implicit friction and rolling resistance everywhere
struct Pile {
    static constexpr double m = 0.5, R = 0.1, bowl = 1;
    dae::Model model;
    State x;

    Pile(const std::vector<Vec3>& r, double restitution)
    {
        const ImplicitFriction friction{
            .mu_s = 0.3, .mu_k = 0.3, .K_E = 1e4, .K_D = 2 * std::sqrt(0.5 * 1e4), .eta_r = 0.05};
        const Unilateral unilateral{.enabled = true, .restitution = restitution};
        const Shape ball{.surface = std::make_shared<Sphere>(R)};
        const auto add = [&](int i, int j, const Shape& of_j) {
            model.constrain(
                std::to_string(i) + "-" + std::to_string(j),
                std::make_unique<EvolvingContact>(i, ball, j, of_j, friction,
                                                  EvolvingContact::NormalRows::tangent, unilateral));
        };
        const int count = static_cast<int>(r.size());
        for (int i = 0; i < count; ++i)
            model.add(
                {.name = "ball " + std::to_string(i), .m = m, .J_bar = 0.4 * m * R * R * Mat3::Identity()});
        for (int i = 0; i < count; ++i) {
            add(i, dae::ground, {.surface = std::make_shared<Sphere>(bowl, true)});
            for (int j = 0; j < i; ++j) add(i, j, ball);
        }
        x.body.resize(r.size());
        for (size_t i = 0; i < r.size(); ++i) x.body[i].r = r[i];
        dae::start(model, x);
    }
};

/// A rod at 45 degrees that slides on the floor, its lower end ahead. The end is a ball of radius a.
struct Rod {
    static constexpr double m = 1, length = 1, a = 0.01, v = 3;
    dae::Model model;
    State x;

    explicit Rod(bool unilateral)
    {
        const double J = m * length * length / 12, across = 0.5 * length * std::sqrt(0.5);
        model.add({.name = "rod", .m = m, .J_bar = Vec3(J, J, 1e-3).asDiagonal()});
        model.constrain(
            "end", std::make_unique<EvolvingContact>(
                       0, Shape{.surface = std::make_shared<Sphere>(a), .position = {0, 0, -0.5 * length}},
                       dae::ground, Shape{.surface = std::make_shared<Plane>()},
                       ImplicitFriction{.mu_s = 2, .mu_k = 2, .K_E = 1e6, .K_D = 1e3},
                       EvolvingContact::NormalRows::tangent, Unilateral{.enabled = unilateral}));
        x.body.resize(1);
        x.body[0].A = lie::exp(Vec3(0, std::acos(std::sqrt(0.5)), 0));
        x.body[0].r.z() = across + a;
        x.body[0].rdot.x() = -v;
        dae::start(model, x);
    }
    /// After the impact that stops the end: the angular momentum about the contact point is conserved.
    double jammed_energy() const
    {
        const double height = x.body[0].r.z(), across = height - a,
                     I = m * length * length / 12 + m * (across * across + height * height);
        const double L = m * v * height;
        return 0.5 * L * L / I + m * g * height;
    }
};

}  // namespace

TEST_CASE("balls that touch each other in a bowl lose energy until the end of the run (long)",
          "[contact][unilateral][implicit]")
{
    const double restitution = GENERATE(0., 0.4);
    std::vector<Vec3> at{{0.176, -0.262, -0.5}, {0.1, 0.13, -0.25}};
    if (GENERATE(false, true)) at.emplace_back(-0.07, 0.31, 0);
    const Pile pile(at, restitution);
    INFO(at.size() << " balls, e = " << restitution);
    const double start = energy(pile.model, pile.x);
    double least = start, rise = 0;
    bool touched = false;
    const State end =
        run_unilateral(pile.model, pile.x, "rA-half-1-momentum", 1.5, 1e-3, [&](const State& x) {
            const double E = energy(pile.model, x);
            rise = std::max(rise, E - least), least = std::min(least, E);
            for (const auto& c : pile.model.general_constraints())
                touched = touched || (c->j != dae::ground && !dae::Model::inactive(*c, x));
        });
    CHECK(touched);
    CHECK(end.t == Approx(1.5));
    CHECK(rise < 1e-3 * (start - least));
}

TEST_CASE("a rod that jams on the floor takes the impact that stops its end and gains no energy (long)",
          "[contact][evolving][implicit]")
{
    const bool unilateral = GENERATE(true, false);
    const char* scheme = GENERATE("rA-half-1-momentum", "rA-half-1-kick", "rA-half-1");
    const double h = GENERATE(1e-3, 1e-4);
    const Rod rod(unilateral);
    INFO(scheme << ", h = " << h << ", unilateral " << unilateral);
    const double start = energy(rod.model, rod.x), jammed = rod.jammed_energy();
    CHECK(rod.x.lambda.norm() < 10 * Rod::m * g);  // the start has no force of Coulomb's law; 1e6 N without
    double most = 0;
    const State end = run_unilateral(rod.model, rod.x, scheme, 0.1, h,
                                     [&](const State& x) { most = std::max(most, energy(rod.model, x)); });
    CHECK(most < start * (1 + 1e-9));
    // The spring and damper stop the end within 1 mm, not at once.
    CHECK(energy(rod.model, end) == Approx(jammed).epsilon(1e-2));
}

TEST_CASE("a bilateral contact under tension has no implicit friction", "[contact][evolving][implicit]")
{
    dae::Model model;
    model.gravity = {0, 0, g};
    model.add({.name = "ball", .m = 1, .J_bar = 0.1 * Mat3::Identity()});
    model.constrain("ball-floor", std::make_unique<EvolvingContact>(
                                      0, Shape{.surface = std::make_shared<Sphere>(0.5)}, dae::ground,
                                      Shape{.surface = std::make_shared<Plane>()},
                                      ImplicitFriction{.mu_s = 0.5, .mu_k = 0.5, .K_E = 1e6, .K_D = 1e3}));
    State x;
    x.body.resize(1);
    x.body[0].r.z() = 0.5;
    x.body[0].rdot.x() = 2;
    dae::start(model, x);
    const State end = run_unilateral(model, x, "rA-half-1-momentum", 0.5, 1e-3, [](const State&) {});
    const auto& c = dynamic_cast<const EvolvingContact&>(*model.general_constraints()[0]);
    CHECK(c.multipliers(model.arguments(c, end), end.lambda).F_N == Approx(-g));
    CHECK(end.body[0].rdot.x() == Approx(2).epsilon(1e-5));
}

TEST_CASE("the lag of the friction force is named for a sliding contact that spins", "[contact][friction]")
{
    CHECK(friction_lag(-150, 0.06, 200, 0.5) == Approx(150 * 0.06 / 200 / 0.5));
    CHECK(friction_lag(150, 0.06, 200, 0) == 0);
    // the start of a tippe top that turns over in 0.6 s with the soft spring, and after 3.5 s with stiffer
    // ones
    constexpr double m = 0.006, R = 0.015;
    for (const double K_E : {200., 2e3}) {
        dae::Model model;
        model.add({.name = "top", .m = m, .J_bar = 0.4 * m * R * R * Mat3::Identity()});
        model.constrain("top-table", std::make_unique<EvolvingContact>(
                                         0, Shape{.surface = std::make_shared<Sphere>(R)}, dae::ground,
                                         Shape{.surface = std::make_shared<Plane>()},
                                         ImplicitFriction{.mu_s = 0.3, .mu_k = 0.3, .K_E = K_E}));
        State x;
        x.body.resize(1);
        x.body[0].r.z() = R;
        x.body[0].rdot.x() = 0.045;
        x.body[0].omega_bar.z() = 150;
        dae::start(model, x);
        const std::vector<std::string> found = soft_friction_warnings(model, x);
        REQUIRE(found.size() == (K_E < 1e3 ? 1 : 0));
        if (!found.empty())
            CHECK(found[0].find(
                      "contact 'top-table': the friction spring is too soft for a spin of 150 rad/s") == 0);
    }
}

TEST_CASE("a singular step names the contacts that are active", "[contact][unilateral]")
{
    // The torus falls flat into a wide cylinder, where its contact point moves by any amount.
    dae::Model model;
    model.add({"torus", 0.5, Vec3(1.8112e-3, 1.9695e-3, 1.8530e-3).asDiagonal()});
    model.constrain("landing", std::make_unique<EvolvingContact>(
                                   0, Shape{std::make_shared<Torus>(0.1068956, 0.04577268)}, dae::ground,
                                   Shape{.surface = std::make_shared<Cylinder>(2, true),
                                         .position = Vec3::Zero(),
                                         .orientation = lie::exp(Vec3(-M_PI / 2, 0, 0))},
                                   EvolvingContact::Friction::none, EvolvingContact::NormalRows::tangent,
                                   Unilateral{.enabled = true}));
    State x;
    x.body.resize(1);
    x.body[0].r = {0.031473, -0.00138394, -0.9};
    x.body[0].A =
        Eigen::Quaterniond(-0.114385, -0.495156, 0.485691, 0.711225).normalized().toRotationMatrix();
    x.body[0].rdot = {0.3445284, 0.90133, 0};
    x.body[0].omega_bar = {-2.6604, 0.28882672, 2.6184339};
    dae::start(model, x);
    std::string what;
    try {
        run_unilateral(model, x, "rA-half-1-momentum", 0.5, 5e-4, [](const State&) {});
    } catch (const lie::SingularMatrix& e) {
        what = e.what();
    }
    CHECK_THAT(what, Catch::EndsWith("do not determine its contact points; active contacts: 'landing'"));
}
