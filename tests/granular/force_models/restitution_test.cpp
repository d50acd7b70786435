// SPDX-License-Identifier: GPL-3.0-or-later
// Coefficient of restitution of the normal laws as a function of the impact velocity, against closed forms.
#include "granular/core/pair_law.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::tests;
using namespace hilda::granular;

namespace restitution_test {

namespace {

constexpr double R = 0.125, m = 2, E = 1e6;

double force(const PairLaw& law, double delta, double rate)
{
    ContactPoint<double> contact{};
    contact.delta = delta, contact.R_i = contact.R_eff = R, contact.m_eff = m, contact.n = {0, 0, 1};
    contact.v_n = rate;
    History<double> none{};
    return delta > 0 ? evaluate(law, contact, none, false).F.z : 0;
}

struct Rebound {
    double e, deepest, least_force, time;
};

/// Collision of a sphere with a plane at the velocity v: Runge-Kutta of order 4 with the step h. The last
/// step ends at δ = 0 by linear interpolation.
Rebound rebound(const PairLaw& law, double v, double h)
{
    Rebound out{0, 0, 0, 0};
    double d = 0, u = v;
    const auto acc = [&](double delta, double rate) { return -force(law, delta, rate) / m; };
    while (true) {
        const double a1 = acc(d, u), u2 = u + h / 2 * a1, a2 = acc(d + h / 2 * u, u2), u3 = u + h / 2 * a2,
                     a3 = acc(d + h / 2 * u2, u3), u4 = u + h * a3, a4 = acc(d + h * u3, u4);
        const double d_next = d + h / 6 * (u + 2 * u2 + 2 * u3 + u4),
                     u_next = u + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        out.least_force = std::min(out.least_force, force(law, d_next, u_next));
        out.deepest = std::max(out.deepest, d_next), out.time += h;
        if (d_next <= 0) {
            const double part = d / (d - d_next);
            out.e = -(u + part * (u_next - u)) / v;
            return out;
        }
        d = d_next, u = u_next;
    }
}

/// Duration of the undamped collision of Hertz's theory [s]
double hertz_time(double v) { return 2.87 * std::pow(m * m / (R * E * E * v), 0.2); }

}  // namespace

TEST_CASE("the restitution of hunt-crossley decreases with the velocity as its closed form does",
          "[granular][laws]")
{
    // β v - ln(1 + β v) = -β e v - ln(1 - β e v)
    const auto closed_form = [](double beta_v) {
        const double in = beta_v - std::log1p(beta_v);
        double low = 0, high = 1;  // of e; the right-hand side increases with e and is infinite at 1/(β v)
        for (int k = 0; k < 200; ++k) {
            const double e = (low + high) / 2, x = e * beta_v;
            (x < 1 && -x - std::log1p(-x) < in ? low : high) = e;
        }
        return low;
    };
    const float alpha = 0.25;
    PairLaw law;
    law.normal = HuntCrossley{.E_eff = float(E), .alpha = alpha};
    for (const double v : {0.01, 0.1, 1., 5., 40.}) {
        const Rebound of = rebound(law, v, hertz_time(v) / 5000);
        INFO(v << " m/s: e = " << of.e);
        CHECK(of.e == Approx(closed_form(1.5 * alpha * v)).epsilon(1e-6));
        CHECK(of.least_force == 0);
    }
    // 1 - e = α v + O(α² v²)
    const double slow = (1 - rebound(law, 0.01, hertz_time(0.01) / 5000).e) / (alpha * 0.01),
                 slower = (1 - rebound(law, 0.005, hertz_time(0.005) / 5000).e) / (alpha * 0.005);
    CHECK(slow == Approx(1).epsilon(0.005));
    CHECK(2 * slower - slow == Approx(1).epsilon(1e-4));

    ContactPoint<double> leaving{};  // a separation that is faster than that of a free collision
    leaving.delta = 1e-3, leaving.R_eff = R, leaving.m_eff = m, leaving.v_n = -100;
    CHECK(HuntCrossley{.E_eff = float(E), .alpha = alpha}(leaving).F == 0);
}

TEST_CASE("the restitution of kuwabara-kono differs from 1 by the fifth root of the velocity",
          "[granular][laws]")
{
    PairLaw law;
    const double A = std::ldexp(1., -17);  // 7.6e-6 s
    law.normal = KuwabaraKono{.E_eff = float(E), .A = float(A)};
    const double k = 4. / 3 * E * std::sqrt(R), B = std::beta(0.6, 1.5);
    const auto loss = [&](double v) { return 1 - rebound(law, v, hertz_time(v) / 20000).e; };
    const auto leading = [&](double v) { return 1.5 * A * B * v / std::pow(5 * m * v * v / (4 * k), 0.4); };
    for (const double v : {1e-3, 1e-1, 10.}) {
        const double x = loss(v);
        INFO(v << " m/s: 1 - e = " << x);
        CHECK(x < leading(v));  // the next term of the series is negative
        CHECK(x == Approx(leading(v)).epsilon(leading(v)));
        CHECK(std::log2(loss(2 * v) / x) == Approx(0.2).epsilon(leading(v)));
    }
    CHECK(rebound(law, 0.1, hertz_time(0.1) / 5000).least_force < 0);
    const double with_tension = rebound(law, 10, hertz_time(10) / 5000).e;
    law.normal = KuwabaraKono{.E_eff = float(E), .A = float(A), .clamped = 1};
    const Rebound clamped = rebound(law, 10, hertz_time(10) / 5000);
    CHECK(clamped.e > with_tension);
    CHECK(clamped.least_force == 0);
}

TEST_CASE("laws with the stiffness of hertz have its forces at rest and its energy", "[granular][laws]")
{
    const Hertz hertz{.E_eff = float(E)};
    ContactPoint<double> contact{};
    contact.delta = 1e-3, contact.R_i = contact.R_eff = R, contact.m_eff = m, contact.n = {0, 0, 1};
    for (const NormalLaws& normal : {NormalLaws(HuntCrossley{.E_eff = float(E), .alpha = 1}),
                                     NormalLaws(KuwabaraKono{.E_eff = float(E), .A = 1e-3f})})
        normal.visit([&](const auto& law) {
            History<double> none{};
            const NormalForce<double> F = normal_force(law, contact, none), expected = hertz(contact);
            CHECK(F.F == Approx(expected.F).epsilon(1e-14));
            CHECK(F.scale == expected.scale);
            CHECK(F.power == expected.power);
            if constexpr (requires { law.energy(contact); })
                CHECK(law.energy(contact) == Approx(hertz.energy(contact)).epsilon(1e-14));
        });
}

TEST_CASE("the collision times of the normal laws are not above those of their collisions",
          "[granular][laws]")
{
    for (const double v : {0.01, 1., 20.}) {
        INFO(v << " m/s");
        const HuntCrossley hunt_crossley{.E_eff = float(E), .alpha = 0.5f};
        const KuwabaraKono viscous{.E_eff = float(E), .A = 2e-2f}, elastic{.E_eff = float(E), .A = 1e-8f};
        PairLaw law;
        law.normal = hunt_crossley;
        CHECK(hunt_crossley.collision_time(m, R, v) <= 1.001 * rebound(law, v, hertz_time(v) / 5000).time);
        law.normal = elastic;
        CHECK(elastic.collision_time(m, R, v) ==
              Approx(rebound(law, v, hertz_time(v) / 5000).time).epsilon(1e-3));
        CHECK(viscous.collision_time(m, R, v) < hertz_time(v));
    }
}

}  // namespace restitution_test
