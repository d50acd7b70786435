// SPDX-License-Identifier: GPL-3.0-or-later
// The tangential law mindlin-deresiewicz against the closed forms of the theory.
#include "granular/backend/cube_root.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::ContactPoint;
using granular::DoubleWorld;
using granular::Hertz;
using granular::History;
using granular::Hooke;
using granular::MindlinDeresiewicz;
using granular::MindlinIncremental;

namespace mindlin_deresiewicz_test {

namespace {

constexpr double R = 0.125, h = 0.0078125, K_0 = 512, mu = 0.5, overlap = 1. / 128, bound = 4;  // μ N = 4 N

PairLaw constant_force(float friction = mu)
{
    PairLaw law;
    law.normal = Hooke{.k_n = 1024};
    law.tangential = MindlinDeresiewicz{.spring = {.k_t = K_0}, .mu = friction};
    return law;
}

ContactPoint<double> at_rest(double delta)
{
    ContactPoint<double> contact{};
    contact.delta = delta, contact.R_i = contact.R_eff = R, contact.m_eff = 2, contact.h = h;
    contact.n = {0, 0, 1}, contact.v_t = contact.omega = {0, 0, 0};
    return contact;
}

/// A contact with a prescribed tangential displacement. `force` is that on the body that moves the contact.
struct Sheared {
    PairLaw law = constant_force();
    History<double> history{};
    ContactPoint<double> contact = at_rest(overlap);
    Vec3 at = {0, 0, 0};
    double work = 0;

    Sheared() { move_to({0, 0, 0}); }
    Vec3 move_to(const Vec3& to)
    {
        const Vec3 before = last;
        contact.v_t = (1 / h) * (to - at), at = to;
        last = -evaluate(law, contact, history, false).F_t;
        work += 0.5 * (before + last).dot(h * contact.v_t);
        return last;
    }
    double along_x(double x) { return move_to({x, 0, 0}).x; }
    Vec3 last = {0, 0, 0};
};

/// Displacement of the first loading up to the force T, and its inverse, at constant normal force
double first_loading(double T) { return 1.5 * bound / K_0 * (1 - std::pow(1 - T / bound, 2. / 3)); }
double force_of(double u) { return bound * (1 - std::pow(1 - u / (1.5 * bound / K_0), 1.5)); }
/// Force after a reversal at `from`, at the distance u from it: the first loading with both axes doubled
double after_reversal(double from, double u)
{
    return from - std::copysign(2 * force_of(std::abs(u) / 2), u);
}

}  // namespace

TEST_CASE("the cube root has the accuracy of single precision", "[granular][laws]")
{
    double worst = 0;
    for (float x = 1e-19f; x < 4; x *= 1.013f)
        worst = std::max(worst, std::abs(double(granular::cube_root(x)) / std::cbrt(double(x)) - 1));
    CHECK(worst < 3e-7);
    CHECK(granular::cube_root(0.f) < 3e-7f);
    CHECK(granular::cube_root(27.) == Approx(3).epsilon(1e-15));
}

TEST_CASE("loading, unloading and reloading at constant normal force follow the theory", "[granular][laws]")
{
    const double t = GENERATE(0.1, 0.5, 0.9, 0.999), largest = first_loading(t * bound);
    const int n = GENERATE(7, 100);
    Sheared contact;
    for (int k = 1; k <= n; ++k)
        REQUIRE(contact.along_x(largest * k / n) == Approx(force_of(largest * k / n)).epsilon(1e-10));
    const double top = t * bound;
    for (int cycle = 0; cycle < 2; ++cycle) {
        for (int k = 1; k <= n; ++k) {
            const double u = 2 * largest * k / n;
            REQUIRE(contact.along_x(largest - u) == Approx(after_reversal(top, u)).margin(1e-9));
        }
        for (int k = 1; k <= n; ++k) {
            const double u = 2 * largest * k / n;
            REQUIRE(contact.along_x(-largest + u) == Approx(after_reversal(-top, -u)).margin(1e-9));
        }
    }
    // beyond the largest force the first loading continues, up to sliding
    const double beyond = first_loading((t + 0.5 * (1 - t)) * bound);
    CHECK(contact.along_x(beyond) == Approx(force_of(beyond)).epsilon(2e-2));
    contact.along_x(2 * first_loading(bound));
    CHECK(contact.along_x(3 * first_loading(bound)) == Approx(bound).epsilon(1e-12));
}

TEST_CASE("a loop within the largest loop returns to the first loading", "[granular][laws]")
{
    const auto check_loop = [&](int n) {
        Sheared contact;
        const double top = 0.8 * bound, u_top = first_loading(top), down = 0.9 * u_top,
                     low = after_reversal(top, down), u_end = first_loading(0.9 * bound);
        for (int k = 1; k <= n; ++k) contact.along_x(u_top * k / n);
        for (int k = 1; k <= n; ++k) contact.along_x(u_top - down * k / n);
        CHECK(contact.last.x == Approx(low).epsilon(1e-9));
        const double half = 0.5 * down;
        for (int k = 1; k <= n; ++k) contact.along_x(u_top - down + half * k / n);
        CHECK(contact.last.x == Approx(after_reversal(low, -half)).epsilon(1e-9));
        const double from = u_top - down + half;
        for (int k = 1; k <= n; ++k) contact.along_x(from + (u_end - from) * k / n);
        // The step over the end of the loop takes the stiffness of the loop for its whole length; that of the
        // first loading is smaller.
        const double step = (u_end - from) / n;
        CAPTURE(n);
        CHECK(contact.last.x >= 0.9 * bound * (1 - 1e-4));
        CHECK(contact.last.x < 0.9 * bound + 0.3 * K_0 * step);
    };
    for (const int n : {37, 100, 370, 1000}) check_loop(n);
}

TEST_CASE("the energy lost per cycle is that of Mindlin and Deresiewicz", "[granular][laws]")
{
    // Johnson, Contact Mechanics, Eq. 7.57 with K_0 = 8 G* a
    for (const double t : {0.2, 0.5, 0.9}) {
        const double lost = 7.2 * bound * bound / K_0 *
                            (1 - std::pow(1 - t, 5. / 3) - 5. / 6 * t * (1 + std::pow(1 - t, 2. / 3)));
        const double largest = first_loading(t * bound);
        const auto cycle = [&](int n) {
            Sheared contact;
            for (int k = 1; k <= n; ++k) contact.along_x(largest * k / n);
            contact.work = 0;
            for (int k = 1; k <= 2 * n; ++k) contact.along_x(largest * (1 - 1. * k / n));
            for (int k = 1; k <= 2 * n; ++k) contact.along_x(largest * (-1 + 1. * k / n));
            return contact.work / lost - 1;
        };
        CAPTURE(t, cycle(100), cycle(200));
        CHECK(std::abs(cycle(400)) < 1e-3);
        CHECK(std::log2(cycle(100) / cycle(200)) > 1);
    }
}

TEST_CASE("without slip the law is the incremental one, also while the contact is unloaded",
          "[granular][laws]")
{
    PairLaw slip, elastic;
    slip.normal = elastic.normal = Hertz{.E_eff = 1e6f};
    slip.tangential = MindlinDeresiewicz{.spring = {.k_t = 1e6f}, .mu = 1};
    elastic.tangential = MindlinIncremental{.spring = {.k_t = 1e6f}, .cap = {1, 1}};
    History<double> a{}, b{};
    const int n = 2000;
    for (int k = 1; k <= 2 * n; ++k) {
        const double d = overlap * (k <= n ? 1. * k / n : 1 - 0.75 * (k - n) / n);
        ContactPoint<double> contact = at_rest(d);
        contact.v_n = (k <= n ? 1 : -0.75) * overlap / n / h;
        contact.v_t = {2e-5 * std::cos(3. * k / n), 2e-5 * std::sin(2. * k / n), 0};
        const Vec3 F = evaluate(slip, contact, a, false).F_t, G = evaluate(elastic, contact, b, false).F_t;
        if (k % 500 == 0) CHECK((F - G).norm() < 2e-2 * G.norm());
    }
    // At rest the force of an unloaded contact decreases with its radius, T ∝ a.
    History<double> history{};
    ContactPoint<double> contact = at_rest(overlap);
    contact.v_t = {0.02, 0, 0};
    const double before = evaluate(slip, contact, history, false).F_t.norm();
    contact.v_t = {0, 0, 0};
    double now = 0;
    for (int k = 1; k <= 20000; ++k) {
        contact.delta = overlap * (1 - 0.75 * k / 20000);
        now = evaluate(slip, contact, history, false).F_t.norm();
    }
    CHECK(now == Approx(0.5 * before).epsilon(3e-2));
}

TEST_CASE("a sliding contact follows a varying normal force, and one at rest keeps its force",
          "[granular][laws]")
{
    Sheared contact;
    contact.along_x(3 * first_loading(bound));
    for (int k = 1; k <= 400; ++k) {
        contact.contact.delta = overlap * (1 + 0.5 * std::sin(0.03 * k));
        contact.along_x((3 + k) * first_loading(bound));
        REQUIRE(contact.last.x == Approx(mu * 1024 * contact.contact.delta).epsilon(1e-9));
    }
    Sheared resting;
    const double force = resting.along_x(0.5 * first_loading(bound));
    for (int k = 0; k < 100000; ++k) {
        resting.contact.delta = overlap * (1 + (k % 2 == 0 ? 1e-7 : -1e-7));
        resting.along_x(0.5 * first_loading(bound));
    }
    CHECK(resting.last.x == Approx(force).epsilon(1e-12));
}

TEST_CASE("the force depends on the direction of the displacement by rotation only", "[granular][laws]")
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> in(-1, 1);
    Sheared one, turned;
    const double c = std::cos(0.7), s = std::sin(0.7), size = 0.2 * first_loading(bound);
    const auto rotated = [&](const Vec3& a) { return Vec3{c * a.x - s * a.y, s * a.x + c * a.y, a.z}; };
    Vec3 at = {0, 0, 0};
    for (int k = 0; k < 2000; ++k) {
        at += Vec3{size * in(random), size * in(random), 0};
        at = 0.98 * at;
        one.contact.delta = turned.contact.delta = overlap * (1 + 0.3 * std::sin(0.1 * k));
        const Vec3 F = one.move_to(at), G = turned.move_to(rotated(at));
        REQUIRE((G - rotated(F)).norm() < 1e-8 * bound);
        REQUIRE(F.norm() <= mu * 1024 * one.contact.delta * (1 + 1e-12));
        REQUIRE(std::abs(F.z) < 1e-12);
    }
    CHECK(one.work > 0);
}

TEST_CASE("oblique impacts with partial slip lose energy and agree with double precision", "[granular][laws]")
{
    for (const double angle : {10., 30., 45., 60., 80.})
        for (const double e : {0.6, 1.}) {
            PairLaw law = hertz_mindlin(soft(), e, 0.3);
            law.tangential = MindlinDeresiewicz{
                .spring = granular::TangentialSpring::of_materials(soft(), soft(), e), .mu = 0.3f};
            WorldOptions o;
            o.low = {-2, -2, -1}, o.high = {8, 2, 3};
            o.gravity = {0, 0, 0}, o.h = 2e-5;
            Particle p = granular::soft_sphere();
            const double v = 3, theta = angle * M_PI / 180;
            p.r = {0, 0, 0.5001}, p.v = {v * std::tan(theta), 0, -v}, p.omega = {2, 3, 0};
            DoubleWorld in_double(o, law);
            in_double.particle = {p}, in_double.boundary = {Boundary{}};
            World world(o, {soft()});
            world.set_law(0, 0, law);
            world.add(Boundary{});
            world.add(p);
            const auto energy = [](const Particle& q) {
                return 0.5 * (q.v.dot(q.v) + 0.4 * 0.25 * q.omega.dot(q.omega));
            };
            double last = energy(p);
            in_double.step(2500), world.step(2500);
            const Particle a = in_double.particle[0], b = world.particles()[0];
            CAPTURE(angle, e, a.v.x, a.omega.y);
            CHECK(energy(a) <= last * (1 + 1e-5));
            CHECK((a.v - b.v).norm() < 1e-3);
            CHECK((a.omega - b.omega).norm() < 3e-3);
        }
}

}  // namespace mindlin_deresiewicz_test
