// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-moreau-1 against closed forms of impacts, sliding and rest.

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/lie/cones/contact_system.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

constexpr double g = 9.81;

std::unique_ptr<lie::Integrator> moreau(const lie::System& system)
{
    return lie::scheme("rA-moreau-1").make(system, {});
}

/// Marches `steps` steps
lie::State after(const lie::System& system, lie::State x, double h, int steps)
{
    const auto integrator = moreau(system);
    for (int n = 0; n < steps; ++n) integrator->step(x, h);
    return x;
}

/// A box of 0.2 × 0.2 × 0.1 m, 2 kg, on a slope of 20 degrees, whose axes are those of the frame
struct BoxOnSlope : tests::ContactSystem {
    static constexpr double m = 2;

    explicit BoxOnSlope(double speed, double mu = 0.5)
    {
        const double angle = 20 * std::numbers::pi / 180;
        gravity = g * Vec3(std::sin(angle), 0, -std::cos(angle));
        const Vec3 half(0.1, 0.1, 0.05);
        put_on(add_box(m, half, {0, 0, 0.05}), half, -1, 0, mu);
        initial.body[0].rdot = {speed, 0, 0};
        start();
    }
};

/// Force and moment about `origin` of the contact forces [first, first + count) on their bodies i
struct Resultant {
    Vec3 F = Vec3::Zero(), M = Vec3::Zero();
};
Resultant resultant(const lie::State& x, const tests::ContactSystem& of, size_t first, size_t count,
                    const Vec3& origin)
{
    Resultant sum;
    for (const lie::ConeForce& force : x.cone_forces) {
        if (force.key < first || force.key >= first + count) continue;
        const auto& contact = of.vertices[force.key];
        sum.F += force.F;
        sum.M += (tests::ContactSystem::point(x, contact.i, contact.s_bar) - origin).cross(force.F);
    }
    return sum;
}

}  // namespace

TEST_CASE("a box on a slope comes to rest after the distance of Coulomb's law, to first order",
          "[lie][cones][moreau]")
{
    const BoxOnSlope system(1.5);
    constexpr double distance = 0.8971472877, time = 1.1961964;
    double error_before = 0;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        lie::State x = system.initial;
        const auto integrator = moreau(system);
        double stopped = 0;
        for (int n = 0; n * h < 1.5; ++n) {
            integrator->step(x, h);
            if (stopped == 0 && x.body[0].rdot.norm() < 1e-8) stopped = x.t;
        }
        INFO("h " << h);
        const double error = distance - x.body[0].r.x();
        CHECK(stopped == Approx(time).margin(1.01 * h));
        CHECK(error == Approx(0.75 * h).epsilon(0.01));  // ½ h v_0
        if (error_before > 0) CHECK(error_before / error == Approx(2).epsilon(0.01));
        error_before = error;
        CHECK(std::abs(x.body[0].r.z() - 0.05) < 1e-12);
        CHECK(integrator->statistics().friction_relaxed == 0);
        CHECK(integrator->statistics().cone_residual < 1e-9);
    }
}

TEST_CASE("the forces of a sliding and of a resting box are those of its balance", "[lie][cones][moreau]")
{
    const BoxOnSlope system(1.5);
    const lie::State sliding = after(system, system.initial, 1e-3, 500),
                     resting = after(system, system.initial, 1e-3, 1500);
    const auto corners = [&](const lie::State& x, double side) {
        double N = 0;
        for (const lie::ConeForce& force : x.cone_forces)
            if (system.vertices[force.key].s_bar.x() * side > 0) N += force.F.z();
        return N;
    };
    CHECK(corners(sliding, 1) == Approx(11.52298).epsilon(1e-6));
    CHECK(corners(sliding, -1) == Approx(6.91379).epsilon(1e-6));
    CHECK(corners(resting, 1) == Approx(10.89599).epsilon(1e-6));
    CHECK(corners(resting, -1) == Approx(7.54078).epsilon(1e-6));
    double friction = 0;
    for (const lie::ConeForce& force : resting.cone_forces) {
        friction += force.F.x();
        CHECK(force.slips == 0);
    }
    CHECK(friction == Approx(-6.71044).epsilon(1e-6));
    for (const lie::ConeForce& force : sliding.cone_forces) CHECK(force.slips == 1);
}

TEST_CASE("a box at rest on a slope does not creep for 10 s", "[lie][cones][moreau]")
{
    const BoxOnSlope system(0);
    lie::State x = system.initial;
    const auto integrator = moreau(system);
    double fastest = 0;
    for (int n = 0; n < 10000; ++n) {
        integrator->step(x, 1e-3);
        fastest = std::max({fastest, x.body[0].rdot.norm(), x.body[0].omega_bar.norm()});
    }
    CHECK(fastest < 1e-10);
    CHECK((x.body[0].r - system.initial.body[0].r).norm() < 1e-11);
    CHECK(integrator->statistics().cone_factorizations <= 5);  // those of the first step
}

TEST_CASE("the friction coefficient of a contact that slips is mu_k", "[lie][cones][moreau]")
{
    BoxOnSlope system(1.5);
    system.mu_k_by_mu_s = 0.8;  // mu_k = 0.4: a = g (sin - 0.4 cos)
    const double angle = 20 * std::numbers::pi / 180, a = g * (std::sin(angle) - 0.4 * std::cos(angle));
    const lie::State x = after(system, system.initial, 1e-3, 501), y = after(system, x, 1e-3, 100);
    CHECK((y.body[0].rdot.x() - x.body[0].rdot.x()) == Approx(0.1 * a).epsilon(1e-6));
}

TEST_CASE("a sphere bounces obliquely as Newton's and Coulomb's laws require", "[lie][cones][moreau]")
{
    // R = 0.1, v_n = 2, e = 0.5: sticks with mu 0.4, slips with mu 0.1
    struct Case {
        double mu, v, omega, v_after, omega_after;
    };
    for (const Case& of : {Case{0.4, 1, 0, 5. / 7, 7.142857142857143}, Case{0.1, 3, -5, 2.7, 2.5}}) {
        tests::ContactSystem system;
        system.gravity.setZero();
        system.add_sphere(1, 0.1, {0, 0, 0.1});
        system.add_body(1e30, 1e30 * Vec3::Ones(), {0, 0, -1});
        system.spheres.push_back({0, 1, 0.1, 1, of.mu, 0.5});
        lie::State x = system.start();
        x.body[0].rdot = {of.v, 0, -2};
        x.body[0].omega_bar = {0, of.omega, 0};
        x = after(system, x, 1e-4, 1);
        INFO("mu " << of.mu);
        CHECK(x.body[0].rdot.x() == Approx(of.v_after).epsilon(1e-9));
        CHECK(x.body[0].rdot.z() == Approx(1).epsilon(1e-9));
        CHECK(x.body[0].omega_bar.y() == Approx(of.omega_after).epsilon(1e-9));
    }
}

TEST_CASE("a bouncing ball hits the ground at the times of the closed form and comes to rest",
          "[lie][cones][moreau]")
{
    constexpr double times[] = {0.4515236, 0.9030473, 1.1288091}, rest = 1.3545709;
    for (const double h : {1e-3, 5e-4}) {
        tests::ContactSystem system;
        system.add_sphere(1, 0.1, {0, 0, 1});
        system.vertices.push_back({0, -1, Vec3::Zero(), Vec3::UnitZ(), 0, 0, 0.5});
        lie::State x = system.start();
        const auto integrator = moreau(system);
        std::vector<double> impacts;
        double after_rest = 0, lowest = 0;
        for (int n = 0; n * h < 2; ++n) {
            const double before = x.body[0].rdot.z();
            integrator->step(x, h);
            if (before < 0 && x.body[0].rdot.z() > 0 && impacts.size() < 3) impacts.push_back(x.t);
            if (x.t > rest + 100 * h) after_rest = std::max(after_rest, system.kinetic_energy(x));
            lowest = std::min(lowest, x.body[0].r.z());
        }
        INFO("h " << h);
        REQUIRE(impacts.size() == 3);
        for (int k = 0; k < 3; ++k) CHECK(impacts[k] == Approx(times[k]).margin(6 * h));
        CHECK(after_rest < 1e-12);
        CHECK(lowest > -1e-9 * system.size);
    }
}

TEST_CASE("Newton's cradle of touching balls: impacts are solved together", "[lie][cones][moreau]")
{
    for (const int n : {3, 5}) {
        tests::ContactSystem system;
        system.gravity.setZero();
        for (int k = 0; k < n; ++k) system.add_sphere(1, 0.1, {0.2 * k, 0, 0});
        for (int k = 1; k < n; ++k) system.spheres.push_back({k, k - 1, 0.1, 0.1, 0, 1});
        lie::State x = system.start();
        x.body[0].rdot = {1, 0, 0};
        x = after(system, x, 1e-4, 1);
        for (int k = 0; k < n; ++k) {
            INFO(n << " balls, ball " << k);
            CHECK(x.body[k].rdot.x() == Approx(2. / n - (k == 0 ? 1 : 0)).epsilon(1e-9));
        }
    }
}

TEST_CASE("a square of four hinged bars dropped on a vertex", "[lie][cones][moreau]")
{
    // side 0.4 m, 0.5 kg each, 3 m/s, e = 0. The vertices are B (below), R, T, L; bars BR, RT, TL, LB.
    constexpr double L = 0.4, m = 0.5, v = 3;
    tests::ContactSystem system;
    system.gravity.setZero();
    const double d = L / std::sqrt(2.);
    const Vec3 corner[] = {{0, 0, 0}, {d, 0, d}, {0, 0, 2 * d}, {-d, 0, d}};
    for (int k = 0; k < 4; ++k) {
        const Vec3 a = corner[k], c = corner[(k + 1) % 4], e = (c - a) / L;
        Mat3 A;
        A << e, Vec3::UnitY(), e.cross(Vec3::UnitY());
        const double J = m * L * L / 12;
        system.add_body(m, {1e-3 * J, J, J}, 0.5 * (a + c), A);
        system.initial.body[k].rdot = {0, 0, -v};
    }
    for (int k = 0; k < 4; ++k)
        for (const Vec3& e : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitZ())})
            system.pins.push_back({k, (k + 1) % 4, {L / 2, 0, 0}, {-L / 2, 0, 0}, e});
    // The bars remain in the plane y = 0.
    for (int k = 0; k < 4; ++k) {
        system.pins.push_back({k, -1, Vec3::Zero(), Vec3::Zero(), Vec3::UnitY()});
        system.perpendicular.push_back({k, Vec3::UnitX(), Vec3::UnitY()});
        system.perpendicular.push_back({k, Vec3::UnitZ(), Vec3::UnitY()});
    }
    system.vertices.push_back({0, -1, {-L / 2, 0, 0}, Vec3::UnitZ(), 0, 0, 0});
    const double h = 1e-9;  // the configuration does not change in the step
    const lie::State x = after(system, system.start(), h, 1);
    REQUIRE(x.cone_forces.size() == 1);
    CHECK(h * x.cone_forces[0].F.z() == Approx(2.4).epsilon(1e-7));
    for (const lie::Motion& body : x.body)
        CHECK(std::abs(body.omega_bar.y()) == Approx(6.3639610).epsilon(1e-7));
    const auto velocity = [&](int k, double end) {
        return Vec3(x.body[k].rdot + x.body[k].A * x.body[k].omega_bar.cross(Vec3(end * L / 2, 0, 0)));
    };
    CHECK((velocity(0, 1) - Vec3(1.8, 0, -1.8)).norm() < 1e-6);
    const Eigen::VectorXd Lambda = h * x.lambda.head(8);  // impulses of the hinges R, T, L, B
    const double expected[] = {0.3, 0.15, 0.15, 0, 0.3, 0.15, 0.75, 1.2};
    for (int k = 0; k < 8; ++k) CHECK(std::abs(Lambda[k]) == Approx(expected[k]).margin(1e-6));
    CHECK(system.kinetic_energy(x) / (0.5 * 4 * m * v * v) == Approx(0.6).epsilon(1e-7));
}

TEST_CASE("a sphere slides and then rolls", "[lie][cones][moreau]")
{
    // v_0 = 1 m/s, mu = 0.2: rolls from t = 2 v_0/(7 mu g) on with v = 5/7 v_0
    const double mu = 0.2, R = 0.1, t = 2 / (7 * mu * g);
    struct Rolling final : tests::ContactSystem {
        void cones(const lie::State& x, double h, lie::ConeRows& out) const override
        {
            out.cone.clear();
            const Vec3 P = x.body[0].r - 0.1 * Vec3::UnitZ();
            add_cone(x, h, {0, -1, 0.2, 0, P.z(), 0}, Vec3::UnitZ(), P, out);
        }
        bool has_cones() const override { return true; }
    } system;
    system.add_sphere(1, R, {0, 0, R});
    lie::State x = system.start();
    x.body[0].rdot = {1, 0, 0};
    const lie::State half = after(system, x, 1e-4, static_cast<int>(0.5 * t / 1e-4)),
                     rolls = after(system, x, 1e-4, static_cast<int>(1.5 * t / 1e-4));
    CHECK(half.body[0].rdot.x() == Approx(1 - mu * g * half.t).epsilon(1e-9));
    CHECK(half.cone_forces.at(0).slips == 1);
    CHECK(rolls.body[0].rdot.x() == Approx(5. / 7).epsilon(1e-9));
    CHECK(R * rolls.body[0].omega_bar.y() == Approx(5. / 7).epsilon(1e-9));
    CHECK(rolls.cone_forces.at(0).slips == 0);
}

TEST_CASE("the interfaces of a stack of ten boxes carry the weight above them", "[lie][cones][moreau]")
{
    constexpr int n = 10;
    tests::ContactSystem system;
    const Vec3 half(0.1, 0.1, 0.1);
    for (int k = 0; k < n; ++k) {
        system.add_box(1, half, {0, 0, 0.1 + 0.2 * k});
        system.put_on(k, half, k - 1, k == 0 ? 0 : 0.1, 0.5);
    }
    lie::State x = system.start();
    const auto integrator = moreau(system);
    integrator->step(x, 1e-3);
    const long first = integrator->statistics().cone_factorizations;
    CHECK(first <= 40);
    for (int s = 0; s < 500; ++s) integrator->step(x, 1e-3);
    CHECK(integrator->statistics().cone_factorizations <= first + 5);
    for (int k = 0; k < n; ++k) {
        const Resultant of = resultant(x, system, 4 * k, 4, {0, 0, 0.2 * k});
        INFO("interface " << k);
        CHECK((of.F - Vec3(0, 0, (n - k) * g)).norm() < 1e-5);
        CHECK(of.M.norm() < 1e-6);
        CHECK((x.body[k].r - system.initial.body[k].r).norm() < 1e-11);
    }
}

TEST_CASE("Painleve's rod without a solution jumps by the impact without collision", "[lie][cones][moreau]")
{
    // length 1, 1 kg, 30 degrees, mu = 3, tip -1 m/s, omega = 0: P = (0.8125, 0.3247595) as h goes to 0
    const double angle = std::numbers::pi / 6;
    tests::ContactSystem system;
    const double J = 1. / 12;
    system.add_body(1, {J, J, J}, {0.5 * std::cos(angle), 0, 0.5 * std::sin(angle)},
                    lie::exp(Vec3(0, -angle, 0)));
    system.vertices.push_back({0, -1, {-0.5, 0, 0}, Vec3::UnitZ(), 0, 3, 0});
    system.initial.body[0].rdot = {-1, 0, 0};
    double error_before = 0;
    for (const double h : {1e-3, 1e-4, 1e-5}) {
        const lie::State x = after(system, system.start(), h, 1);
        REQUIRE(x.cone_forces.size() == 1);
        const Vec3 P = h * x.cone_forces[0].F;
        INFO("h " << h << " P " << P.transpose());
        const double error = (P - Vec3(0.8125, 0, 0.3247595264)).norm();
        CHECK(error < 10 * h);
        if (error_before > 0) CHECK(error_before / error == Approx(10).epsilon(0.05));
        error_before = error;
        if (h == 1e-3) CHECK(P.x() == Approx(0.81569).margin(1e-5));
    }
}

TEST_CASE("a box falls on an edge that sticks or slips", "[lie][cones][moreau]")
{
    // 0.4 x 0.2 m, 3 kg, 25 degrees, 2 m/s downwards, e = 0.3
    struct Case {
        double mu, v_x, v_x_after, v_z_after, omega_after, energy_ratio;
    };
    for (const Case& of : {Case{0.8, 0, 0.9495103, -0.1535161, -5.4209895, 0.3537306},
                           Case{0.1, 1, 1.1291491, -0.7085090, -9.4137520, 0.6507883}}) {
        const double angle = 25 * std::numbers::pi / 180, a = 0.2, b = 0.1;
        const Mat3 A = lie::exp(Vec3(0, -angle, 0));
        tests::ContactSystem system;
        system.gravity.setZero();
        const Vec3 low = A * Vec3(-a, 0, -b);
        system.add_box(3, {a, 0.1, b}, {0, 0, -low.z()}, A);
        for (const double side : {-0.1, 0.1})
            system.vertices.push_back({0, -1, {-a, side, -b}, Vec3::UnitZ(), 0, of.mu, 0.3});
        lie::State x = system.start();
        x.body[0].rdot = {of.v_x, 0, -2};
        const double E = system.kinetic_energy(x);
        x = after(system, x, 1e-6, 1);
        INFO("mu " << of.mu);
        CHECK(x.body[0].rdot.x() == Approx(of.v_x_after).margin(1e-7));
        CHECK(x.body[0].rdot.z() == Approx(of.v_z_after).margin(1e-7));
        CHECK(std::abs(x.body[0].omega_bar.y()) == Approx(-of.omega_after).margin(1e-7));
        CHECK(system.kinetic_energy(x) / E == Approx(of.energy_ratio).margin(1e-7));
    }
}

TEST_CASE("a rocking block loses energy by Housner's law", "[lie][cones][moreau]")
{
    // 0.2 x 0.8 m, starts at 0.6 alpha, e = 0: impacts at 0.3713976, 0.9442576, 1.4198282 s
    constexpr double impacts[] = {0.3713976, 0.9442576, 1.4198282};
    const double a = 0.1, b = 0.4, start = 0.6 * std::atan(a / b);
    double error_before = 0;
    for (const double h : {1e-3, 5e-4}) {
        const Mat3 A = lie::exp(Vec3(0, start, 0));
        tests::ContactSystem system;
        system.add_box(1, {a, 0.1, b}, {0, 0, a * std::sin(start) + b * std::cos(start)}, A);
        system.put_on(0, {a, 0.1, b}, -1, 0, 0.6);
        lie::State x = system.start();
        const auto integrator = moreau(system);
        std::vector<double> found;
        double before = start, energy = lie::energy(system, x), gain = 0;
        while (x.t < 1.6 && found.size() < 3) {
            integrator->step(x, h);
            const double angle = std::atan2(x.body[0].A(0, 2), x.body[0].A(2, 2));
            if (angle * before < 0)
                found.push_back(x.t - h * std::abs(angle) / (std::abs(angle) + std::abs(before)));
            before = angle;
            gain = std::max(gain, lie::energy(system, x) - energy);
            energy = lie::energy(system, x);
        }
        REQUIRE(found.size() == 3);
        double error = 0;
        for (int k = 0; k < 3; ++k) error = std::max(error, std::abs(found[k] - impacts[k]));
        INFO("h " << h << ", error " << error);
        CHECK(error < 40 * h);
        if (error_before > 0) CHECK(error < 0.7 * error_before);
        error_before = error;
        CHECK(gain < 1e-6);
    }
}

TEST_CASE("the angular momentum of a free body is constant, and that of its nodes to rounding",
          "[lie][cones][moreau]")
{
    tests::ContactSystem system;
    system.gravity.setZero();
    system.add_body(2, {0.05, 0.08, 0.06}, Vec3::Zero());
    lie::State x = system.start();
    x.body[0].omega_bar = {1, -2, 6};
    const double h = 2e-3;
    const auto integrator = lie::scheme("rA-moreau-1").make(system, {.tolerance = 1e-15});
    const auto of_node = [&] {  // A_n J_r(-θ)⁻¹ J̄ ω̄_n
        const Vec3& omega = x.body[0].omega_bar;
        return Vec3(x.body[0].A *
                    (lie::right_jacobian_inverse(-h * omega) * (system.inertia.J_bar[0] * omega)));
    };
    const Vec3 H = of_node();
    double worst = 0, worst_energy = 0;
    const double E = system.kinetic_energy(x);
    for (int n = 0; n < 2000; ++n) {
        integrator->step(x, h);
        worst = std::max(worst, (of_node() - H).norm());
        worst_energy = std::max(worst_energy, std::abs(system.kinetic_energy(x) - E));
    }
    CHECK(worst < 2e-12 * H.norm());
    CHECK(worst_energy < 0.01 * E);
}

TEST_CASE(
    "joints remain closed in impacts with friction, without allocations, and a continued run has the "
    "same digits",
    "[lie][cones][moreau][allocation]")
{
    // A chain of three boxes on ball joints falls on the ground.
    tests::ContactSystem system;
    const Vec3 half(0.1, 0.03, 0.02);
    for (int k = 0; k < 3; ++k) {
        system.add_box(k == 2 ? 10 : 1, half, {0.2 * k, 0, 0.1});
        system.put_on(k, half, -1, 0, 0.5, 0.2);
        if (k == 0) continue;
        for (int c = 0; c < 3; ++c)
            system.pins.push_back({k, k - 1, {-0.1, 0, 0}, {0.1, 0, 0}, Vec3::Unit(c)});
    }
    lie::State x = system.start();
    for (int k = 0; k < 3; ++k) {
        const Vec3 omega(0.5, -1, 2);
        x.body[k].omega_bar = omega;
        x.body[k].rdot = Vec3(0.3, 0, -0.5) + omega.cross(x.body[k].r - x.body[0].r);
    }
    const auto integrator = moreau(system);
    Eigen::VectorXd Phi(system.rows());
    double open = 0, overlap = 0;
    lie::ConeRows found;
    lie::State saved;
    for (int n = 0; n < 1000; ++n) {
        integrator->step(x, 1e-3);
        system.phi(x, Phi);
        open = std::max(open, Phi.cwiseAbs().maxCoeff());
        system.cones(x, 0, found);
        for (const auto& cone : found.cone) overlap = std::max(overlap, -cone.gap);
        if (n == 499) saved = x;
    }
    CHECK(open < 1e-10);
    CHECK(overlap < 1e-9 * system.size);
    CHECK(integrator->statistics().overlap < 1e-9);
    CHECK(integrator->statistics().friction_relaxed == 0);
    const lie::State y = after(system, saved, 1e-3, 500);
    for (int k = 0; k < 3; ++k) {
        CHECK(y.body[k].r == x.body[k].r);
        CHECK(y.body[k].A == x.body[k].A);
        CHECK(y.body[k].rdot == x.body[k].rdot);
    }
    CHECK(y.lambda == x.lambda);
    if (!tests::counts_allocations) return;
    CHECK(tests::allocations_during([&] {
              for (int n = 0; n < 100; ++n) integrator->step(x, 1e-3);
          }) == 0);
}
