// SPDX-License-Identifier: GPL-3.0-or-later
// Force laws in double precision, at contacts with given kinematics. laws_in_motion_test.cpp tests the motion
// under them.
#include "granular/core/pair_law.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda::granular;

namespace laws_test {

namespace {

using Vec3 = Vec<double>;

constexpr double R = 0.125, m = 2, h = 0.0078125;
constexpr double exact =
    1e-12;  // a few hundred rounding errors; all parameters are exact in single precision
const Vec3 n = {2. / 3, -1. / 3, 2. / 3}, tangent = {1 / std::sqrt(5.), 2 / std::sqrt(5.), 0};

/// Contact of a sphere at rest with a plane, with the overlap delta
ContactPoint<double> resting(double delta)
{
    ContactPoint<double> contact{};
    contact.delta = delta, contact.R_i = contact.R_eff = R, contact.R_j = 0, contact.m_eff = m, contact.n = n,
    contact.h = h;
    contact.v_n = 0, contact.v_t = contact.omega = {0, 0, 0};
    return contact;
}

ContactPoint<double> of_two(double delta, double R_j)
{
    ContactPoint<double> contact = resting(delta);
    contact.R_j = R_j, contact.R_eff = R * R_j / (R + R_j), contact.m_eff = m / 2;
    return contact;
}

/// k_n = 1024 N/m, k_t = 512 N/m; the normal force is 8 N at an overlap of 1/128 m.
PairLaw springs(float gamma_t = 0)
{
    PairLaw law;
    law.normal = Hooke{.k_n = 1024};
    law.tangential = Mindlin{.spring = {.k_t = 512, .c = 0, .gamma_t = gamma_t}, .cap = {1, 1}};
    return law;
}
constexpr double delta = 1. / 128, N = 8, k_t = 512;

double normal_force(const PairLaw& law, const ContactPoint<double>& contact)
{
    History<double> none{};
    const Vec3 F = evaluate(law, contact, none, false).F;
    CHECK((F - F.dot(n) * n).norm() <= exact * F.norm());
    return F.dot(n);
}

bool same(const Vec3& a, const Vec3& b) { return (a - b).norm() <= exact * b.norm(); }

}  // namespace

TEST_CASE("normal laws give the force of their formulas", "[granular][laws]")
{
    constexpr double d = 1e-3;
    PairLaw law;
    law.normal = Hertz{.E_eff = 1e6f, .c = 0.5f};
    const auto hertz = [&](double of) { return 4. / 3 * 1e6 * std::sqrt(of) * std::pow(d, 1.5); };
    CHECK(normal_force(law, resting(d)) == Approx(hertz(R)).epsilon(exact));
    CHECK(normal_force(law, of_two(d, R)) == Approx(hertz(R / 2)).epsilon(exact));
    CHECK(normal_force(law, of_two(d, 3 * R)) == Approx(hertz(0.75 * R)).epsilon(exact));

    law.normal = Hooke{.k_n = 1000, .gamma_n = 20};
    CHECK(normal_force(law, resting(d)) == Approx(1).epsilon(exact));
    law.normal = ScaledHooke{.k_n = 1000, .gamma_n = 20};
    CHECK(normal_force(law, resting(d)) == Approx(std::sqrt(d / R)).epsilon(exact));
    CHECK(normal_force(law, of_two(d, R)) == Approx(std::sqrt(d / R)).epsilon(exact));
}

TEST_CASE("normal damping opposes the rate of the overlap; a clamped law has no tension", "[granular][laws]")
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
            ContactPoint<double> contact = resting(d);
            contact.v_n = rate;
            const double F = of.at_rest + of.gain * rate / v;
            CHECK(normal_force(law, contact) == Approx(F).epsilon(exact));
            CHECK(normal_force(clamped, contact) == Approx(std::max(F, 0.)).epsilon(exact));
        }
    }
}

TEST_CASE("cohesion is a constant attraction or proportional to the contact area", "[granular][laws]")
{
    PairLaw law;
    law.normal = Hooke{.k_n = 1000};
    law.cohesion = ConstantCohesion{.F_c = 3};
    for (const double d : {1e-6, 1e-3, 5e-3})
        CHECK(normal_force(law, resting(d)) == Approx(1000 * d - 3).epsilon(exact));

    // with Hertz the net attraction is largest at sqrt(δ) = π k sqrt(R*)/(2 E*), and is then π³ k³ R*²/(12
    // E*²)
    constexpr double E = 1e5, k = 16000, pi = std::numbers::pi;
    law.normal = Hertz{.E_eff = float(E)};
    law.cohesion = Sjkr{.k = float(k)};
    const double R_eff = R / 2, at = std::pow(pi * k / (2 * E), 2) * R_eff,
                 most = std::pow(pi * k, 3) * R_eff * R_eff / (12 * E * E);
    CHECK(normal_force(law, of_two(at, R)) == Approx(-most).epsilon(exact));
    for (const double off : {0.5, 0.9, 1.1, 2.})
        CHECK(normal_force(law, of_two(off * at, R)) > -most * (1 - 1e-6));
    CHECK(normal_force(law, of_two(2.25 * at, R)) == Approx(0).margin(exact * most));
}

TEST_CASE("friction without history is viscous and bounded", "[granular][laws]")
{
    PairLaw law = springs();
    law.tangential = Coulomb{.spring = {.k_t = 0, .c = 0, .gamma_t = 16}, .mu_k = 0.25};
    History<double> history{};
    ContactPoint<double> contact = resting(delta);
    for (const double v : {0., 0.01, 0.06}) {  // up to μ N/(γ m) = 1/16 m/s
        contact.v_t = v * tangent;
        CHECK(same(evaluate(law, contact, history, false).F_t, (-16 * m * v) * tangent));
    }
    for (const double v : {0.065, 3.}) {
        contact.v_t = v * tangent;
        CHECK(same(evaluate(law, contact, history, false).F_t, (-0.25 * N) * tangent));
    }
    CHECK(history.u == Vec3{0, 0, 0});
}

TEST_CASE("the constant torque opposes the rotation and does not depend on its magnitude", "[granular][laws]")
{
    PairLaw law = springs();
    ContactPoint<double> wall = resting(delta), two = of_two(delta, 3 * R);
    const auto torque = [&](ContactPoint<double> contact, const Vec3& omega, double age, double step = 1e-6) {
        History<double> history{};
        history.age = age, contact.omega = omega, contact.h = step;
        return evaluate(law, contact, history, true).T;
    };
    law.rolling = ConstantTorque{.mu_r = 0.5, .slow = 0.25};
    for (const double omega : {0.25, 7.}) {
        CHECK(same(torque(wall, omega * tangent, 0), (-0.5 * R * N) * tangent));
        CHECK(same(torque(two, omega * tangent, 0), (-0.5 * 0.75 * R * N) * tangent));
    }
    CHECK(same(torque(wall, 0.125 * tangent, 0), (-0.25 * R * N) * tangent));  // half of `slow`
    CHECK(torque(wall, {0, 0, 0}, 0) == Vec3{0, 0, 0});
    // one step reduces the angular momentum 2/5 m R² ω by a twentieth at most
    for (const double omega : {0.5, 6.25})
        CHECK(same(torque(wall, omega * tangent, 0, h), (-0.02 * m * R * R * omega / h) * tangent));
    CHECK(same(torque(wall, 6.5 * tangent, 0, h), (-0.5 * R * N) * tangent));

    law.rolling = ConstantTorque{.mu_r = 0.5, .slow = 0.25, .after = 0.5, .half_radius = 1};
    CHECK(same(torque(wall, tangent, 0.5), (-0.5 * R / 2 * N) * tangent));
    CHECK(same(torque(of_two(delta, R), tangent, 1), (-0.5 * R / 2 * N) * tangent));
    CHECK(torque(wall, tangent, 0.49).norm() == 0);
}

TEST_CASE("rolling springs resist up to their bound and unload elastically from it", "[granular][laws]")
{
    // both laws have the stiffness k_t R*² and the bound μ_r R* N; their dashpots differ
    struct Spring {
        const char* name;
        RollingLaws law;
        double damping;     // [N m s]
        bool damped_bound;  // whether the bound holds for the sum of spring and dashpot
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
        ContactPoint<double> contact = resting(delta);
        const double omega = 0.0625;
        contact.omega = omega * tangent + 3. * n;  // the component along n is not rolling
        double psi = 0;
        const auto turn = [&](double rate) {
            contact.omega = rate * tangent + 3. * n, psi += h * rate;
            return evaluate(law, contact, history, true).T;
        };
        for (int k = 0; k < 20; ++k) {
            const Vec3 T = turn(omega);
            REQUIRE(same(T, (-k_r * psi - s.damping * omega) * tangent));
        }
        REQUIRE(k_r * psi < bound);
        for (int k = 0; k < 100; ++k)
            REQUIRE(turn(4 * omega).norm() <=
                    (1 + exact) * (bound + (s.damped_bound ? 0 : s.damping * 4 * omega)));
        CHECK(same(turn(4 * omega), -bound * tangent));
        // at ω = 0 the torque is that of the spring alone
        const double elastic = s.damped_bound ? bound - s.damping * 4 * omega : bound;
        CHECK(same(turn(0), -elastic * tangent));
        CHECK(same(turn(-omega), (-(elastic - k_r * h * omega) + s.damping * omega) * tangent));
    }
}

TEST_CASE("the rolling torque rotates with the contact normal", "[granular][laws]")
{
    // the spring is loaded about one tangent; then n rotates about the other tangent
    const Vec3 other = n.cross(tangent);
    for (const RollingLaws& of :
         {RollingLaws(Epsd{.mu_r = 1}), RollingLaws(PseudoForce{.mu_r = 1, .k_r = 1})}) {
        PairLaw law = springs();
        law.rolling = of;
        History<double> history{};
        ContactPoint<double> contact = resting(delta);
        contact.omega = 0.5 * tangent;
        const double wound = evaluate(law, contact, history, true).T.norm();
        contact.omega = {0, 0, 0}, contact.n = std::cos(0.3) * n + std::sin(0.3) * tangent;
        const Vec3 T = evaluate(law, contact, history, true).T;
        CHECK(std::abs(T.dot(contact.n)) < exact * wound);
        CHECK(T.norm() == Approx(wound).epsilon(exact));
        CHECK(std::abs(T.dot(other)) < exact * wound);
    }
}

TEST_CASE("with spring_bound Coulomb's bound holds for the spring alone", "[granular][laws]")
{
    const float gamma_t = 16;
    PairLaw law = springs(gamma_t);
    law.tangential =
        Mindlin{.spring = {.k_t = 512, .c = 0, .gamma_t = gamma_t}, .cap = {0.78125, 0.5}, .spring_bound = 1};
    History<double> history{};
    ContactPoint<double> contact = resting(delta);
    const double v = 1. / 8, damping = gamma_t * m * v;
    contact.v_t = v * tangent;
    const auto friction = [&] {
        const ContactForce<double> out = evaluate(law, contact, history, false);
        return out.F_t;
    };
    const double step = k_t * h * v;  // growth of the force of the spring [N]
    for (int k = 1; k * step <= 0.78125 * N; ++k) REQUIRE(same(friction(), -(k * step + damping) * tangent));
    REQUIRE(0.78125 * N > 5 * step);
    for (int k = 0; k < 5; ++k) CHECK(same(friction(), -0.5 * N * tangent));
    CHECK(same(history.u, 0.5 * N / k_t * tangent));
    contact.v_t = -v * tangent;  // sticks at once
    CHECK(same(friction(), -(0.5 * N - step - damping) * tangent));
}

TEST_CASE("rescale reduces the displacement with the contact radius of an unloaded contact",
          "[granular][laws]")
{
    PairLaw law;
    law.normal = Hertz{.E_eff = 1e6f};
    const double u = 1e-4, deep = delta, shallow = delta / 4;
    // a ∝ √δ: the displacement is halved. The factor of a step is exact to second order in h.
    const auto unloaded = [&](bool rescale, int steps) {
        law.tangential = Mindlin{.spring = {.k_t = 512}, .cap = {100, 100}, .rescale = rescale ? 1 : 0};
        History<double> history{};
        history.u = u * tangent;
        for (int k = 1; k <= steps; ++k) {
            ContactPoint<double> contact = resting(deep + (shallow - deep) * k / steps);
            contact.v_n = (shallow - deep) / (steps * h);
            evaluate(law, contact, history, false);
        }
        ContactPoint<double> loading = resting(deep);
        loading.v_n = (deep - shallow) / h;
        evaluate(law, loading, history, false);  // loading changes nothing
        return history.u.dot(tangent) / u;
    };
    CHECK(unloaded(false, 100) == Approx(1).epsilon(1e-12));
    const double coarse = unloaded(true, 1000) - 0.5, fine = unloaded(true, 2000) - 0.5;
    CHECK(std::abs(fine) < 1e-3);
    CHECK(coarse / fine == Approx(2).epsilon(0.02));  // first order
}

TEST_CASE("the torsional spring resists spin about the normal up to its bound", "[granular][laws]")
{
    PairLaw law = springs(16);
    law.spin = TorsionalSpring{.mu = 0.375};
    const double a = std::sqrt(R * delta), K = k_t * a * a / 2, D = 16 * m * a * a / 2,
                 bound = 2. / 3 * 0.375 * N * a;
    History<double> history{};
    ContactPoint<double> contact = resting(delta);
    double angle = 0;
    const auto spin = [&](double rate) {
        contact.omega = rate * n + 3. * tangent, angle += h * rate;  // the component normal to n is not spin
        return evaluate(law, contact, history, true).T;
    };
    const double omega = 0.5;
    for (int k = 0; k < 8; ++k) {
        const Vec3 T = spin(omega);
        REQUIRE(same(T, (-K * angle - D * omega) * n));
    }
    REQUIRE(K * angle + D * omega < bound);
    for (int k = 0; k < 200; ++k) REQUIRE(spin(2 * omega).norm() < (1 + exact) * bound);
    CHECK(same(spin(2 * omega), -bound * n));
    const double elastic = bound - D * 2 * omega;
    CHECK(same(spin(0), -elastic * n));
    CHECK(same(spin(-omega), (-(elastic - K * h * omega) + D * omega) * n));

    law.spin = TorsionalSpring{.mu = 0.375, .critical = 1};
    for (int k = 0; k < 200; ++k) spin(2 * omega);
    CHECK(same(spin(2 * omega), -3 * std::numbers::pi / 16 * 0.375 * N * a * n));
}

TEST_CASE("laws of rolling and spin dissipate energy in every cycle", "[granular][laws]")
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
        for (const double amplitude : {1e-3, 0.1}) {  // [rad]: below the bound and far above it
            INFO(of.name << ", " << amplitude << " rad");
            PairLaw law = springs(16);
            law.rolling = of.rolling, law.spin = of.spin;
            History<double> history{};
            ContactPoint<double> contact = resting(delta);
            contact.h = 1e-3;
            double work = 0;
            for (int k = 0; k < 2000; ++k) {  // two cycles of 1 s
                contact.omega = amplitude * 2 * std::numbers::pi *
                                std::cos(2 * std::numbers::pi * 1e-3 * (k + 0.5)) * (tangent + n);
                work += contact.h * evaluate(law, contact, history, true).T.dot(contact.omega);
            }
            CHECK(work < 0);
            CHECK(work > -10 * amplitude * 0.25 * R * N * 2);  // at most the bounds times the path
        }
}

}  // namespace laws_test
