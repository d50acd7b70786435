// SPDX-License-Identifier: GPL-3.0-or-later
/// Springs and dampers that half-implicit schemes evaluate implicitly: the recursion of an oscillator, the
/// order of the schemes, stability at any step, and the same motion with both linear solvers.

#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

#include <array>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;

namespace {

/// A body of mass 2 kg on a spring-damper along x, without gravity
struct Oscillator {
    static constexpr double m = 2, l_0 = 1;
    Model model;
    State x;

    Oscillator(double k, double c, double stretch, double speed, bool implicit = true)
    {
        model.gravity.setZero();
        model.add({.name = "body", .m = m, .J_bar = Vec3(1, 1, 1).asDiagonal()});
        x.body.resize(1);
        x.body[0].r = (l_0 + stretch) * X;
        x.body[0].rdot = speed * X;
        SpringDamper spring(ground, O, 0, O, k, c, l_0);
        spring.implicit = implicit;
        model.load(std::move(spring));
        start(model, x);
    }
    double energy() const { return lie::energy(model, x); }
};

double fitted(double x) { return x == 0 ? 0.5 : 1 / (1 - std::exp(-x)) - 1 / x; }

}  // namespace

TEST_CASE("the implicit oscillator follows the recursion of its scheme", "[dae][forces][implicit]")
{
    const auto [k, c] = GENERATE(std::pair(1e3, 0.), std::pair(1e3, 20.), std::pair(0., 300.),
                                 std::pair(1e8, 0.), std::pair(1e6, 1e6), std::pair(10., 4e6));
    constexpr double h = 1e-2, m = Oscillator::m, S_0 = 0.01, v_0 = 0.3;
    CAPTURE(k, c);
    const double scale = S_0 + h * v_0;

    SECTION("backward Euler in rA-half-1")
    {
        Oscillator o(k, c, S_0, v_0);
        const auto integrator = lie::scheme("rA-half-1").make(o.model, {});
        double S = S_0, v = v_0;
        for (int n = 0; n < 40; ++n) {
            integrator->step(o.x, h);
            v = (v - h / m * k * S) / (1 + h / m * (h * k + c));
            S += h * v;
            REQUIRE(o.x.body[0].r.x() - Oscillator::l_0 == Approx(S).margin(1e-10 * scale));
        }
    }
    SECTION("midpoint rule in the leapfrogs")
    {
        const std::string scheme = GENERATE(std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
        Oscillator o(k, c, S_0, v_0);
        const auto integrator = lie::scheme(scheme).make(o.model, {});
        const double theta = fitted(h * c / m), y = h * h * k / (4 * m), z = h * c / m;
        const double a_0 = -(k * S_0 + c * v_0) / m / (1 + y + theta * z);
        double S = S_0, u = v_0 / (1 + y) - h / 2 * a_0;
        for (int n = 0; n < 40; ++n) {
            integrator->step(o.x, h);
            u = (u * (1 + y - (1 - theta) * z) - h / m * k * S) / (1 + y + theta * z);
            S += h * u;
            REQUIRE(o.x.body[0].r.x() - Oscillator::l_0 == Approx(S).margin(1e-10 * scale));
        }
    }
}

TEST_CASE("an undamped implicit oscillator of the leapfrogs follows the trapezoidal rule",
          "[dae][forces][implicit]")
{
    const std::string scheme = GENERATE(std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
    const double k = GENERATE(1e3, 1e5, 1e8);
    constexpr double h = 1e-2, m = Oscillator::m, S_0 = 0.01, v_0 = 0.3;
    Oscillator o(k, 0, S_0, v_0);
    const auto integrator = lie::scheme(scheme).make(o.model, {});
    const double y = h * h * k / (4 * m), energy = o.energy();
    double S = S_0, v = v_0;
    for (int n = 0; n < 40; ++n) {
        lie::State node = o.x;
        integrator->step(o.x, h);
        if (n > 0) {
            integrator->fill_node(node, o.x);
            CHECK(node.body[0].rdot.x() == Approx(v).epsilon(1e-7));
            CHECK(lie::energy(o.model, node) == Approx(energy).epsilon(1e-7));
        }
        const double next = ((1 - y) * S + h * v) / (1 + y);
        v = 2 * (next - S) / h - v;
        S = next;
        CAPTURE(scheme, k, n);
        REQUIRE(o.x.body[0].r.x() - Oscillator::l_0 == Approx(S).margin(1e-9 * (S_0 + h * v_0)));
    }
}

TEST_CASE("the energy of an implicit oscillator does not grow at any step", "[dae][forces][implicit]")
{
    const std::string scheme =
        GENERATE(std::string("rA-half-1"), std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
    const auto [k, c] = GENERATE(std::pair(1e4, 0.), std::pair(1e8, 0.), std::pair(1e6, 10.),
                                 std::pair(1e6, 1e5), std::pair(1., 4e5));
    for (const double h : {1e-3, 1e-2, 1e-1}) {
        Oscillator o(k, c, 0.01, 0.1);
        const auto integrator = lie::scheme(scheme).make(o.model, {});
        const double before = o.energy();
        double largest = 0;
        for (int n = 0; n < 300; ++n) {
            integrator->step(o.x, h);
            largest = std::max(largest, std::abs(o.x.body[0].r.x() - Oscillator::l_0));
        }
        CAPTURE(scheme, k, c, h);
        CHECK(0.5 * k * largest * largest < before * (1 + 1e-9));
    }
}

TEST_CASE("a strong implicit damper does not make the velocity oscillate", "[dae][forces][implicit]")
{
    const std::string scheme =
        GENERATE(std::string("rA-half-1"), std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
    Oscillator o(0, 4e5, 0, 1);  // h c/m = 200
    const auto integrator = lie::scheme(scheme).make(o.model, {});
    double r = o.x.body[0].r.x();
    for (int n = 0; n < 20; ++n) {
        integrator->step(o.x, 1e-3);
        CAPTURE(scheme, n);
        CHECK(o.x.body[0].r.x() >= r - 1e-15);
        r = o.x.body[0].r.x();
    }
    CHECK(r - Oscillator::l_0 < 1e-3);
}

namespace {

/// A spinning bar on a ball joint, with a spring-damper, a torsion spring to a second bar and a bushing
struct Spatial {
    Model model;
    State x;

    explicit Spatial(bool implicit)
    {
        const auto set = [&](auto force) {
            force.implicit = implicit;
            model.load(std::move(force));
        };
        x.body.resize(2);
        model.add({.name = "bar", .m = 1.5, .J_bar = Vec3(0.02, 0.11, 0.1).asDiagonal()});
        model.add({.name = "arm", .m = 0.7, .J_bar = Vec3(0.01, 0.03, 0.03).asDiagonal()});
        const Vec3 half(0.4, 0, 0);
        x.body[0].A = lie::exp(Vec3(0.2, 0.5, -0.1));
        x.body[0].omega_bar = Vec3(1.5, -0.5, 0.8);
        x.body[0].r = x.body[0].A * half;
        x.body[0].rdot = x.body[0].A * x.body[0].omega_bar.cross(half);
        const Vec3 hinge = 2 * x.body[0].r, arm(0.2, 0, 0);
        x.body[1].A = x.body[0].A * lie::exp(Vec3(0, 0, 0.4));
        x.body[1].omega_bar = x.body[1].A.transpose() * x.body[0].A * (x.body[0].omega_bar + Vec3(0, 0, 0.7));
        x.body[1].r = hinge + x.body[1].A * arm;
        x.body[1].rdot = 2 * x.body[0].rdot + x.body[1].A * x.body[1].omega_bar.cross(arm);
        model.constrain("ball", spherical(ground, O, 0, -half));
        model.constrain("hinge", revolute(0, half, Z, 1, -arm, Z));
        set(SpringDamper(ground, Vec3(0.3, 0.2, 0.9), 0, half, 40, 2, 0.5));
        set(TorsionSpring(0, Z, 1, Z, 3, 0.05, 0.2, x));
        set(Bushing(ground, hinge + Vec3(0.05, 0.1, 0), 1, arm,
                    {.stiffness = Vec3(20, 10, 15),
                     .damping = Vec3(0.3, 0.4, 0.2),
                     .rotational_stiffness = Vec3(0.2, 0.3, 0.1),
                     .rotational_damping = Vec3(0.02, 0.01, 0.01)},
                    x));
        start(model, x);
    }
    Eigen::VectorXd after(const std::string& scheme, double h, double end, const lie::Settings& settings = {})
    {
        const auto integrator = lie::scheme(scheme).make(model, settings);
        State at = x;
        const int steps = static_cast<int>(std::lround(end / h));
        for (int n = 0; n < steps; ++n) integrator->step(at, h);
        Eigen::VectorXd q(24);
        for (int i = 0; i < 2; ++i) q.segment<12>(12 * i) << at.body[i].r, at.body[i].A.reshaped();
        return q;
    }
};

}  // namespace

TEST_CASE("implicit springs keep the order of the schemes (long)", "[dae][forces][implicit]")
{
    constexpr double end = 0.4;
    const auto [scheme, order] = GENERATE(std::pair("rA-half-1", 1), std::pair("rA-half-1-kick", 2),
                                          std::pair("rA-half-1-momentum", 2));
    CAPTURE(scheme);
    Spatial implicit(true), explicitly(false);
    const Eigen::VectorXd reference = explicitly.after("rA-rkmk-4", 2.5e-4, end);
    CHECK((implicit.after("rA-rkmk-4", 2.5e-4, end) - reference).norm() < 1e-14);
    std::array<double, 3> error;
    for (size_t n = 0; n < error.size(); ++n)
        error[n] = (implicit.after(scheme, 4e-3 / (1 << n), end) - reference).norm();
    CAPTURE(error);
    CHECK(error[0] > 1e-7);
    for (size_t n = 0; n + 1 < error.size(); ++n)
        CHECK(std::log2(error[n] / error[n + 1]) == Approx(order).margin(0.1));
}

TEST_CASE("implicit springs give the same motion with both linear solvers", "[dae][forces][implicit]")
{
    Spatial model(true);
    for (const char* scheme : {"rA-half-1", "rA-half-1-momentum"}) {
        const Eigen::VectorXd klu = model.after(scheme, 1e-3, 0.2, {.linear_solver = lie::LinearSolver::klu}),
                              condensed = model.after(scheme, 1e-3, 0.2,
                                                      {.linear_solver = lie::LinearSolver::condensed});
        CHECK((klu - condensed).norm() < 1e-11);
    }
}

TEST_CASE("a step with implicit springs does not allocate memory", "[dae][forces][implicit][allocation]")
{
    if (!tests::counts_allocations) return;
    const std::string scheme =
        GENERATE(std::string("rA-half-1"), std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
    Spatial s(true);
    const auto integrator = lie::scheme(scheme).make(s.model, {});
    lie::State x = s.x, node = x;
    const auto steps = [&](int n) {
        for (int k = 0; k < n; ++k) {
            node = x;
            integrator->step(x, 1e-3);
            integrator->fill_node(node, x);
            s.model.accepted(node, x);
        }
    };
    steps(3);
    CHECK(tests::allocations_during([&] { steps(50); }) == 0);
}

TEST_CASE("the rate of a spring row and its change at constant velocities are those of the deflection",
          "[dae][forces][implicit]")
{
    Spatial s(true);
    s.x.body[1].rdot += Vec3(0.3, -0.2, 0.5);
    s.x.body[1].omega_bar += Vec3(-0.4, 0.9, 0.2);
    s.x.body[0].omega_bar += Vec3(0.7, 0.1, -0.3);
    const auto moved = [&](double time) {
        State x = s.x;
        for (auto& body : x.body) {
            body.r += time * body.rdot;
            body.A = body.A * lie::exp(time * body.omega_bar);
        }
        return x;
    };
    const auto rates = [&](const State& x) {
        lie::Springs springs = s.model.spring_pattern();
        s.model.update_springs(x, springs);
        Eigen::VectorXd v(12), rate(springs.rows.rows());
        for (int i = 0; i < 2; ++i) v.segment<6>(6 * i) << x.body[i].rdot, x.body[i].omega_bar;
        for (int n = 0; n < rate.size(); ++n) rate[n] = springs.rows.dot(n, v);
        return rate;
    };
    lie::Springs springs = s.model.spring_pattern();
    s.model.update_springs(s.x, springs);
    constexpr double dt = 1e-5;
    const Eigen::VectorXd differences = (rates(moved(dt)) - rates(moved(-dt))) / (2 * dt), now = rates(s.x);
    REQUIRE(differences.size() == 8);
    for (int n = 0; n < differences.size(); ++n) {
        CAPTURE(n);
        // the axes of the torsion spring are no longer parallel, so that only its own definition is tested
        CHECK(springs.gamma[static_cast<size_t>(n)] == Approx(differences[n]).margin(1e-7));
    }
    const auto value = [&](const State& x, size_t force, int quantity) {
        double out[6];
        s.model.forces()[force]->values(x, out);
        return out[quantity];
    };
    CHECK(now[0] == Approx((value(moved(dt), 0, 0) - value(moved(-dt), 0, 0)) / (2 * dt)).margin(1e-8));
    for (int q = 0; q < 6; ++q)
        CHECK(now[2 + q] ==
              Approx((value(moved(dt), 2, q) - value(moved(-dt), 2, q)) / (2 * dt)).margin(1e-8));
}

TEST_CASE("the mean force of a stiff implicit spring that turns is the centripetal force",
          "[dae][forces][implicit]")
{
    const auto [scheme, k] = GENERATE(table<std::string, double>({{"rA-half-1", 1e6},
                                                                  {"rA-half-1", 1e8},
                                                                  {"rA-half-1-kick", 1e6},
                                                                  {"rA-half-1-kick", 1e8},
                                                                  {"rA-half-1-kick", 1e9},
                                                                  {"rA-half-1-momentum", 1e8},
                                                                  {"rA-half-1-momentum", 1e9}}));
    constexpr double omega = 10, h = 1e-3;
    Oscillator o(k, 0, Oscillator::m * omega * omega / k, 0);  // l = 1 m + F/k, F = m omega^2 to first order
    o.x.body[0].rdot = omega * o.x.body[0].r.x() * Y;
    start(o.model, o.x);
    const double energy = o.energy(), force = Oscillator::m * omega * omega;
    const auto integrator = lie::scheme(scheme).make(o.model, {});
    double sum = 0, largest_rise = 0;
    int nodes = 0;
    for (int n = 0; n < 500; ++n) {
        State node = o.x;
        integrator->step(o.x, h);
        if (n == 0) continue;
        integrator->fill_node(node, o.x);
        double spring[3];
        o.model.forces()[0]->values(node, spring);
        sum += spring[2], ++nodes;
        largest_rise = std::max(largest_rise, lie::energy(o.model, node) / energy - 1);
    }
    CAPTURE(scheme, k, largest_rise);
    CHECK(sum / nodes == Approx(force).epsilon(0.02));
    CHECK(largest_rise < 0.01);
}

TEST_CASE("implicit springs without stiffness or damping do not act on a step", "[dae][forces][implicit]")
{
    const std::string scheme =
        GENERATE(std::string("rA-half-1"), std::string("rA-half-1-kick"), std::string("rA-half-1-momentum"));
    const auto solver = GENERATE(lie::LinearSolver::klu, lie::LinearSolver::condensed);
    const std::optional<std::string> law =
        GENERATE(std::optional<std::string>(), "-300*(l-1)", "1e4*max(l-1.2,0)", "10*sqrt(l-1)");
    Oscillator o(0, 0, 0.01, 0.1, false);
    SpringDamper spring(ground, 0.3 * Y, 0, O, 0, 0, 1);
    if (law) spring.set_law(io::Expression(*law, {"l", "ldot", "t"}));
    Oscillator with(0, 0, 0.01, 0.1, false);
    o.model.load(spring);
    spring.implicit = true;
    with.model.load(spring);
    start(o.model, o.x), start(with.model, with.x);
    const auto a = lie::scheme(scheme).make(o.model, {.linear_solver = solver});
    const auto b = lie::scheme(scheme).make(with.model, {.linear_solver = solver});
    for (int n = 0; n < 20; ++n) a->step(o.x, 1e-3), b->step(with.x, 1e-3);
    CAPTURE(scheme, law.value_or(""));
    CHECK((o.x.body[0].r - with.x.body[0].r).norm() < 1e-6);
}

TEST_CASE("a force that is not a spring in all states cannot be implicit", "[dae][forces][implicit]")
{
    Oscillator o(1, 0, 0, 0);
    DistanceLimit limit(ground, O, 0, O, {.maximum = 2, .stiffness = 10});
    limit.implicit = true;
    limit.name = "stop";
    CHECK_THROWS_WITH(o.model.load(limit), Catch::Contains("force 'stop'") && Catch::Contains("implicit"));
}
