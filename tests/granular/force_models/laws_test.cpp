// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of force one by one, in double precision, at touches made by hand. What they do to what moves: laws_in_motion_test.cpp.
#include "granular/core/pair_law.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda::granular;

namespace {

using Vec3 = Vec<double>;

constexpr double R = 0.125, m = 2, h = 0.0078125;
constexpr double exact = 1e-12;  // sums of some hundred roundings; parameters are floats that are exact
const Vec3 n = {2. / 3, -1. / 3, 2. / 3}, across = {1 / std::sqrt(5.), 2 / std::sqrt(5.), 0};

/// A sphere that rests on a wall, pressed in by delta
ContactPoint<double> resting(double delta)
{
    ContactPoint<double> t{};
    t.delta = delta, t.R_i = t.R_eff = R, t.R_j = 0, t.m_eff = m, t.n = n, t.h = h;
    t.v_n = 0, t.v_t = t.omega = {0, 0, 0};
    return t;
}

ContactPoint<double> of_two(double delta, double R_j)
{
    ContactPoint<double> t = resting(delta);
    t.R_j = R_j, t.R_eff = R * R_j / (R + R_j), t.m_eff = m / 2;
    return t;
}

/// A spring of 1024 N/m with friction on 512 N/m: at an overlap of 1/128 m it presses with 8 N.
PairLaw springs(float gamma_t = 0)
{
    PairLaw law;
    law.normal = Hooke{.k_n = 1024};
    law.tangential = Mindlin{.spring = {.k_t = 512, .c = 0, .gamma_t = gamma_t}, .cap = {1, 1}};
    return law;
}
constexpr double delta = 1. / 128, N = 8, k_t = 512;

double pressing(const PairLaw& law, const ContactPoint<double>& t)
{
    History<double> none{};
    const Vec3 F = evaluate(law, t, none, false).F;
    CHECK((F - F.dot(n) * n).norm() <= exact * F.norm());
    return F.dot(n);
}

bool same(const Vec3& a, const Vec3& b) { return (a - b).norm() <= exact * b.norm(); }

}  // namespace

TEST_CASE("normal laws press with the force of their formulas", "[granular][laws]")
{
    constexpr double d = 1e-3;
    PairLaw law;
    law.normal = Hertz{.E_eff = 1e6f, .c = 0.5f};
    const auto hertz = [&](double of) { return 4. / 3 * 1e6 * std::sqrt(of) * std::pow(d, 1.5); };
    CHECK(pressing(law, resting(d)) == Approx(hertz(R)).epsilon(exact));
    CHECK(pressing(law, of_two(d, R)) == Approx(hertz(R / 2)).epsilon(exact));
    CHECK(pressing(law, of_two(d, 3 * R)) == Approx(hertz(0.75 * R)).epsilon(exact));

    law.normal = Hooke{.k_n = 1000, .gamma_n = 20};
    CHECK(pressing(law, resting(d)) == Approx(1).epsilon(exact));
    law.normal = ScaledHooke{.k_n = 1000, .gamma_n = 20};
    CHECK(pressing(law, resting(d)) == Approx(std::sqrt(d / R)).epsilon(exact));
    CHECK(pressing(law, of_two(d, R)) == Approx(std::sqrt(d / R)).epsilon(exact));
}

TEST_CASE("damping resists approach and pulls in retreat, but for a clamped law", "[granular][laws]")
{
    constexpr double d = 1e-3, v = 0.25;
    const double S = 2 * 1e6 * std::sqrt(R * d);
    struct Damped {
        NormalLaws law, clamped;
        double at_rest, gain;
    };
    const Damped all[] = {
        {Hooke{.k_n = 1000, .gamma_n = 20}, Hooke{.k_n = 1000, .gamma_n = 20, .clamped = 1}, 1, 20 * m * v},
        {ScaledHooke{.k_n = 1000, .gamma_n = 20}, ScaledHooke{.k_n = 1000, .gamma_n = 20, .clamped = 1},
         std::sqrt(d / R), std::sqrt(d / R) * 20 * m * v},
        {Hertz{.E_eff = 1e6f, .c = 1.5f}, Hertz{.E_eff = 1e6f, .c = 1.5f, .clamped = 1}, 2. / 3 * S * d,
         1.5 * std::sqrt(m * S) * v}};
    for (const Damped& of : all) {
        REQUIRE(of.gain > of.at_rest);
        PairLaw law, clamped;
        law.normal = of.law, clamped.normal = of.clamped;
        for (const double rate : {-v, 0., v}) {
            ContactPoint<double> t = resting(d);
            t.v_n = rate;
            const double F = of.at_rest + of.gain * rate / v;
            CHECK(pressing(law, t) == Approx(F).epsilon(exact));
            CHECK(pressing(clamped, t) == Approx(std::max(F, 0.)).epsilon(exact));
        }
    }
}

TEST_CASE("cohesion pulls: a constant force, or one that goes by the area", "[granular][laws]")
{
    PairLaw law;
    law.normal = Hooke{.k_n = 1000};
    law.cohesion = ConstantCohesion{.F_c = 3};
    for (const double d : {1e-6, 1e-3, 5e-3})
        CHECK(pressing(law, resting(d)) == Approx(1000 * d - 3).epsilon(exact));

    // with Hertz the pull is largest at sqrt(δ) = π k sqrt(R*)/(2 E*), and is then π³ k³ R*²/(12 E*²)
    constexpr double E = 1e5, k = 16000, pi = std::numbers::pi;
    law.normal = Hertz{.E_eff = float(E)};
    law.cohesion = Sjkr{.k = float(k)};
    const double R_eff = R / 2, at = std::pow(pi * k / (2 * E), 2) * R_eff,
                 most = std::pow(pi * k, 3) * R_eff * R_eff / (12 * E * E);
    CHECK(pressing(law, of_two(at, R)) == Approx(-most).epsilon(exact));
    for (const double off : {0.5, 0.9, 1.1, 2.})
        CHECK(pressing(law, of_two(off * at, R)) > -most * (1 - 1e-6));
    CHECK(pressing(law, of_two(2.25 * at, R)) == Approx(0).margin(exact * most));
}

TEST_CASE("friction without a history is viscous and bounded", "[granular][laws]")
{
    PairLaw law = springs();
    law.tangential = Coulomb{.spring = {.k_t = 0, .c = 0, .gamma_t = 16}, .mu_k = 0.25};
    History<double> history{};
    ContactPoint<double> t = resting(delta);
    for (const double v : {0., 0.01, 0.06}) {  // up to μ N/(γ m) = 1/16 m/s
        t.v_t = v * across;
        CHECK(same(evaluate(law, t, history, false).F_t, (-16 * m * v) * across));
    }
    for (const double v : {0.065, 3.}) {
        t.v_t = v * across;
        CHECK(same(evaluate(law, t, history, false).F_t, (-0.25 * N) * across));
    }
    CHECK(history.u == Vec3{0, 0, 0});
}

TEST_CASE("the constant torque is against the turning, however fast", "[granular][laws]")
{
    PairLaw law = springs();
    ContactPoint<double> wall = resting(delta), two = of_two(delta, 3 * R);
    const auto torque = [&](ContactPoint<double> t, const Vec3& omega, double age, double step = 1e-6) {
        History<double> history{};
        history.age = age, t.omega = omega, t.h = step;
        return evaluate(law, t, history, true).T;
    };
    law.rolling = ConstantTorque{.mu_r = 0.5, .slow = 0.25};
    for (const double omega : {0.25, 7.}) {
        CHECK(same(torque(wall, omega * across, 0), (-0.5 * R * N) * across));
        CHECK(same(torque(two, omega * across, 0), (-0.5 * 0.75 * R * N) * across));
    }
    CHECK(same(torque(wall, 0.125 * across, 0), (-0.25 * R * N) * across));  // half as fast as `slow`
    CHECK(torque(wall, {0, 0, 0}, 0) == Vec3{0, 0, 0});
    // in one step it takes no more than a twentieth of the turning, 2/5 m R² ω
    for (const double omega : {0.5, 6.25})
        CHECK(same(torque(wall, omega * across, 0, h), (-0.02 * m * R * R * omega / h) * across));
    CHECK(same(torque(wall, 6.5 * across, 0, h), (-0.5 * R * N) * across));

    law.rolling = ConstantTorque{.mu_r = 0.5, .slow = 0.25, .after = 0.5, .half_radius = 1};
    CHECK(same(torque(wall, across, 0.5), (-0.5 * R / 2 * N) * across));
    CHECK(same(torque(of_two(delta, R), across, 1), (-0.5 * R / 2 * N) * across));
    CHECK(torque(wall, across, 0.49).norm() == 0);
}

TEST_CASE("rolling is resisted by a spring up to a bound and turns back from there", "[granular][laws]")
{
    // both with the stiffness k_t R*² and the bound μ_r R* N; the dashpots are another
    struct Spring {
        const char* name;
        RollingLaws law;
        double damping;     // [N m s]
        bool damped_bound;  // whether the bound is on spring and dashpot together
    };
    const double k_r = k_t * R * R, I_r = 1.4 * m * R * R, bound = 0.125 * R * N;
    const Spring all[] = {{"epsd", Epsd{.mu_r = 0.125, .eta_r = 0.25}, 0.5 * std::sqrt(I_r * k_r), false},
                          {"pseudo-force", PseudoForce{.mu_r = 0.125, .k_r = 1, .eta_r = 0.25},
                           0.5 * std::sqrt(m * k_t) * R * R, true},
                          {"epsd without dashpot", Epsd{.mu_r = 0.125}, 0, false},
                          {"pseudo-force without dashpot", PseudoForce{.mu_r = 0.125, .k_r = 1}, 0, true}};
    for (const Spring& s : all) {
        INFO(s.name);
        PairLaw law = springs();
        law.rolling = s.law;
        History<double> history{};
        ContactPoint<double> t = resting(delta);
        const double omega = 0.0625;
        t.omega = omega * across + 3. * n;  // what is along n is not rolling
        double psi = 0;
        const auto turn = [&](double way) {
            t.omega = way * across + 3. * n, psi += h * way;
            return evaluate(law, t, history, true).T;
        };
        for (int k = 0; k < 20; ++k) {
            const Vec3 T = turn(omega);
            REQUIRE(same(T, (-k_r * psi - s.damping * omega) * across));
        }
        REQUIRE(k_r * psi < bound);
        for (int k = 0; k < 100; ++k)
            REQUIRE(turn(4 * omega).norm() <=
                    (1 + exact) * (bound + (s.damped_bound ? 0 : s.damping * 4 * omega)));
        CHECK(same(turn(4 * omega), -bound * across));
        // at rest the dashpot is silent, and what is left is the spring as it was kept
        const double kept = s.damped_bound ? bound - s.damping * 4 * omega : bound;
        CHECK(same(turn(0), -kept * across));
        CHECK(same(turn(-omega), (-(kept - k_r * h * omega) + s.damping * omega) * across));
    }
}

TEST_CASE("the torques of rolling follow the normal", "[granular][laws]")
{
    // a spring that is wound up about an axis in the plane across n; then n turns about that plane's other axis
    const Vec3 other = n.cross(across);
    for (const RollingLaws& of :
         {RollingLaws(Epsd{.mu_r = 1}), RollingLaws(PseudoForce{.mu_r = 1, .k_r = 1})}) {
        PairLaw law = springs();
        law.rolling = of;
        History<double> history{};
        ContactPoint<double> t = resting(delta);
        t.omega = 0.5 * across;
        const double wound = evaluate(law, t, history, true).T.norm();
        t.omega = {0, 0, 0}, t.n = std::cos(0.3) * n + std::sin(0.3) * across;
        const Vec3 T = evaluate(law, t, history, true).T;
        CHECK(std::abs(T.dot(t.n)) < exact * wound);
        CHECK(T.norm() == Approx(wound).epsilon(exact));
        CHECK(std::abs(T.dot(other)) < exact * wound);
    }
}

TEST_CASE("spin about the normal is resisted by a spring up to a bound", "[granular][laws]")
{
    PairLaw law = springs(16);
    law.spin = TorsionalSpring{.mu = 0.375};
    const double a = std::sqrt(R * delta), K = k_t * a * a / 2, D = 16 * m * a * a / 2,
                 bound = 2. / 3 * 0.375 * N * a;
    History<double> history{};
    ContactPoint<double> t = resting(delta);
    double angle = 0;
    const auto spin = [&](double way) {
        t.omega = way * n + 3. * across, angle += h * way;  // what is across n is no spin
        return evaluate(law, t, history, true).T;
    };
    const double omega = 0.5;
    for (int k = 0; k < 8; ++k) {
        const Vec3 T = spin(omega);
        REQUIRE(same(T, (-K * angle - D * omega) * n));
    }
    REQUIRE(K * angle + D * omega < bound);
    for (int k = 0; k < 200; ++k) REQUIRE(spin(2 * omega).norm() < (1 + exact) * bound);
    CHECK(same(spin(2 * omega), -bound * n));
    const double kept = bound - D * 2 * omega;
    CHECK(same(spin(0), -kept * n));
    CHECK(same(spin(-omega), (-(kept - K * h * omega) + D * omega) * n));
}

TEST_CASE("what resists turning takes energy over every cycle", "[granular][laws]")
{
    struct Named {
        const char* name;
        RollingLaws rolling;
        SpinLaws spin;
    };
    const Named all[] = {{"constant torque", ConstantTorque{.mu_r = 0.125, .slow = 0.01f}, {}},
                         {"epsd", Epsd{.mu_r = 0.125, .eta_r = 0.1f}, {}},
                         {"pseudo-force", PseudoForce{.mu_r = 0.125, .k_r = 0.5, .eta_r = 0.1f}, {}},
                         {"torsional spring", {}, TorsionalSpring{.mu = 0.25}}};
    for (const Named& of : all)
        for (const double amplitude : {1e-3, 0.1}) {  // [rad]: within the bound and far beyond it
            INFO(of.name << ", " << amplitude << " rad");
            PairLaw law = springs(16);
            law.rolling = of.rolling, law.spin = of.spin;
            History<double> history{};
            ContactPoint<double> t = resting(delta);
            t.h = 1e-3;
            double work = 0;
            for (int k = 0; k < 2000; ++k) {  // two cycles of 1 s
                t.omega = amplitude * 2 * std::numbers::pi *
                          std::cos(2 * std::numbers::pi * 1e-3 * (k + 0.5)) * (across + n);
                work += t.h * evaluate(law, t, history, true).T.dot(t.omega);
            }
            CHECK(work < 0);
            CHECK(work > -10 * amplitude * 0.25 * R * N * 2);  // no more than the bounds over the way
        }
}
