// SPDX-License-Identifier: GPL-3.0-or-later
// A small particle that rolls in the groove between two large ones, against closed forms.
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <utility>

using namespace hilda::tests;
using hilda::granular::DoubleWorld;
using hilda::granular::Hertz;
using hilda::granular::Hooke;
using hilda::granular::Mindlin;
using hilda::granular::Scheme;
using hilda::granular::scheme_names;
using hilda::granular::TangentialSpring;

namespace wedge_test {

namespace {

constexpr double g = 9.81, large = 5e-3;  // radius of the large particles [m]
constexpr Scheme schemes[] = {Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::forward_euler,
                              Scheme::extended_taylor, Scheme::chung};

/// The large particles touch at the origin and are on the x axis. The small one is at the distance rho from
/// the x axis, at the angle phi from the vertical; n_r and n_x are the components of the normals along rho
/// and x.
struct Wedge {
    double ratio;        ///< of the radii
    bool hertz;          ///< Hertz and Mindlin with the stiffness of the materials, or Hooke
    double mu;           ///< coefficient of friction
    double phi_0;        ///< at the start, at rest with the overlap that holds the weight [rad]
    bool drops = false;  ///< starts without overlap

    double a = large / ratio, rho = std::sqrt((large + a) * (large + a) - large * large);
    double n_r = rho / (large + a), n_x = large / (large + a);
    double m = 2500 * 4. / 3 * M_PI * a * a * a;
    double effective = 1 + 0.4 / (n_r * n_r);  ///< inertia of rolling in the groove over m
    double R_eff = a * large / (a + large);
    double time = std::sqrt(rho * effective / g);  ///< of the motion [s]
    /// Overlap at the start [m], for which `time` is 6000 steps of 1/45 of the collision time of Hooke's law
    double delta_0 = rho * effective * std::pow(45 / (M_PI * 6000), 2) / (2 * n_r) * std::cos(phi_0);
    double load_0 = m * g * std::cos(phi_0);  ///< radial load on both contacts [N]
    /// Stiffness k_n of Hooke, or 4/3 E* √R* of Hertz
    double k = load_0 / (2 * n_r * (hertz ? std::pow(delta_0, 1.5) : delta_0));
    double collision_time =
        M_PI * std::sqrt(m / (hertz ? 1.5 * k * std::sqrt(delta_0) : k));  ///< of small oscillations [s]

    PairLaw law() const
    {
        PairLaw l;
        const auto bound = static_cast<float>(mu);
        if (hertz) {
            const double E_eff = 0.75 * k / std::sqrt(R_eff);
            const Material material{"g", 2500, 2 * E_eff * (1 - 0.09), 0.3};
            l.normal = Hertz::of_materials(material, material, 0.5);
            l.tangential = Mindlin{.spring = TangentialSpring::of_materials(material, material, 0.5),
                                   .cap = {bound, bound}};
        } else {
            const double gamma = 0.43 * std::sqrt(k / m);
            l.normal = Hooke{.k_n = static_cast<float>(k), .gamma_n = static_cast<float>(gamma)};
            l.tangential = Mindlin{
                .spring = {.k_t = static_cast<float>(0.8 * k), .c = 0, .gamma_t = static_cast<float>(gamma)},
                .cap = {bound, bound}};
        }
        return l;
    }
    double normal_force(double delta) const { return k * (hertz ? std::pow(delta, 1.5) : delta); }
    /// Stiffness of the tangential spring: 8 G* a over 2 E* a is 4 (1 - nu)/(2 - nu).
    double tangential_stiffness(double delta) const
    {
        return hertz ? 1.5 * k * std::sqrt(delta) * 4 * (1 - 0.3) / (2 - 0.3) / 2 : 0.8 * k;
    }

    /// Friction of a contact along the groove: it accelerates the rotation. [N]
    double friction(double phi) const { return m * g * std::sin(phi) / (5 * n_r * n_r * effective); }

    /// The overlap at this radial load while nothing slips. Normal and tangential springs of the plane x-rho
    /// share the load: the particle has moved by s along rho since the start. `carried`: tangential
    /// displacement in this plane that the motion along the groove has caused
    double overlap(double load, double carried) const
    {
        double low = -delta_0 / n_r * 0.999, high = delta_0 / n_r;
        for (int n = 0; n < 60; ++n) {
            const double s = (low + high) / 2, delta = delta_0 + n_r * s;
            const double held =
                2 * (normal_force(delta) * n_r + tangential_stiffness(delta) * (s * n_x + carried) * n_x);
            (held < load ? low : high) = s;
        }
        return delta_0 + n_r * low;
    }

    std::vector<Particle> particles() const
    {
        const double distance = drops ? rho : rho - delta_0 / n_r;
        const auto mass = [](double R) { return 2500 * 4. / 3 * M_PI * R * R * R; };
        std::vector<Particle> all(3);
        all[0] = {.r = {0, distance * std::sin(phi_0), distance * std::cos(phi_0)}, .radius = a};
        all[1] = {.r = {large, 0, 0}, .radius = large, .fixed = true};
        all[2] = {.r = {-large, 0, 0}, .radius = large, .fixed = true};
        for (Particle& p : all) p.mass = mass(p.radius);
        return all;
    }
    WorldOptions options(Scheme scheme, double h) const
    {
        WorldOptions o;
        o.low = {-0.04, -0.04, -0.04}, o.high = {0.04, 0.04, 0.04};
        o.gravity = {0, 0, -g}, o.h = h, o.scheme = scheme;
        return o;
    }
};

double angle_of(const Vec3& r) { return std::atan2(r.y, r.z); }

}  // namespace

TEST_CASE("the normal force of a particle that rolls between two others is that of its weight",
          "[granular][wedge]")
{
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const double ratio = GENERATE(2., 10., 30., 100.);
    const bool hertz = GENERATE(false, true);
    // It sticks to the large ones until the load has fallen to a third.
    const Wedge w{.ratio = ratio, .hertz = hertz, .mu = 50, .phi_0 = 0.7};
    CAPTURE(scheme_names[static_cast<int>(scheme)], ratio, hertz);
    World world(w.options(scheme, w.collision_time / 45), {{"g", 2500, 1e7, 0.3}});
    world.set_law(0, 0, w.law());
    for (const Particle& p : w.particles()) world.add(p);
    double worst = 0, load = w.load_0, phi = w.phi_0, delta = w.delta_0, carried = 0;
    int compared = 0;
    for (long n = 0; n < 400'000 && load > 0.3 * w.load_0; n += 40) {
        world.step(40);
        const double before = std::exchange(phi, angle_of(world.particles()[0].r));
        // Energy gives the speed of rolling.
        const double v2 = 2 * g * w.rho * (std::cos(w.phi_0) - std::cos(phi)) / w.effective;
        load = w.m * (g * std::cos(phi) - v2 / w.rho);
        // The displacement is carried into the tangent planes without a rotation about the normal. The
        // direction of the groove rotates about the normal by n_x dphi.
        carried -= w.n_x * w.friction(phi) / w.tangential_stiffness(delta) * (phi - before);
        delta = w.overlap(load, carried);
        // The start of the rotation makes the springs oscillate.
        if (load > 0.9 * w.load_0) continue;
        double N = 0;
        for (const auto& c : world.contacts()) N += c.F.dot(c.n) / 2;
        worst = std::max(worst, std::abs(N / w.normal_force(delta) - 1)), ++compared;
    }
    CHECK(compared > 10);
    CHECK(worst < 0.05);
}

TEST_CASE("a particle leaves the groove between two others when no force can hold it", "[granular][wedge]")
{
    // Little friction does not hold the particle in a narrow groove; with more it must have slipped at the
    // start.
    struct Start {
        double ratio, mu;
        bool drops;
    };
    const Start start = GENERATE(Start{2, 0.1, false}, Start{10, 0.1, false}, Start{30, 0.1, false},
                                 Start{100, 0.1, false}, Start{10, 0.5, true}, Start{20, 0.5, true});
    const double ratio = start.ratio;
    const bool hertz = GENERATE(false, true);
    const Wedge w{.ratio = ratio, .hertz = hertz, .mu = start.mu, .phi_0 = 0.7, .drops = start.drops};
    const auto steps_of = [&](double h) { return std::lround(4 * w.time / h); };
    // With synchronous velocities and a quarter of the step, in double precision
    const double fine = w.collision_time / 180, clear = w.rho * 1.002;
    DoubleWorld exact(w.options(Scheme::chung, fine), w.law());
    exact.particle = w.particles();
    double left = 0, angle = 0;
    for (long n = 0; n < steps_of(fine) && left == 0; ++n) {
        exact.step();
        if (exact.particle[0].r.norm() > clear)
            left = static_cast<double>(n) * fine, angle = angle_of(exact.particle[0].r);
    }
    CAPTURE(ratio, hertz, start.mu);
    REQUIRE(left > 0);
    // Unless friction holds it longer, between rolling and sliding: g cos(phi) = v²/rho with v² = 2 g rho
    // (cos(phi_0) - cos(phi))/effective
    const auto leaves_at = [&](double inertia) { return std::acos(2 * std::cos(w.phi_0) / (2 + inertia)); };
    CHECK(angle > 0.98 * leaves_at(1));
    if (!start.drops) CHECK(angle < 1.1 * leaves_at(w.effective));
    for (const Scheme scheme : schemes) {
        CAPTURE(scheme_names[static_cast<int>(scheme)], ratio, hertz, start.mu);
        const double h = w.collision_time / 45;
        World world(w.options(scheme, h), {{"g", 2500, 1e7, 0.3}});
        world.set_law(0, 0, w.law());
        for (const Particle& p : w.particles()) world.add(p);
        double t = 0;
        for (long n = 0; n < steps_of(h) && t == 0; n += 20) {
            world.step(20);
            const Particle p = world.particles()[0];
            if (p.r.norm() > clear) t = world.t();
        }
        CHECK(t == Approx(left).epsilon(0.02));
    }
}

}  // namespace wedge_test
