// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere that may not turn slides to rest as a brick does, over v²/(2 μ g).               Fang (2022), Sec. 7.1.2, Fig. 7.4
///
/// It goes a little further, because a spring stops it. Spring and dashpot together stay at the bound down to the speed
/// 2 ζ μ g/ω and then swing free, so that
///
///     d = v²/(2 μ g) + (2 ζ² - 1) μ m g/k - h v/2,    ω² = k/m,  ζ = c/2
///
/// where the last term is that of symplectic Euler.

#include "granular/validations/soft_sphere.hpp"
#include "granular/validations/validation.hpp"
#include "granular/world/double_world.hpp"

#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, v_i = 5, h = 2e-5, settle = 0.08;
constexpr double slow = 1e-7;           // at rest [m/s]
constexpr double restitution = 1e-7;    // what stands for 0
constexpr long most_steps = 1'000'000;  // four times what the slowest needs

std::vector<double> frictions()
{
    std::vector<double> all;
    for (int k = 2; k <= 10; ++k) all.push_back(k / 20.0);
    return all;
}

/// Overlap under its own weight [m]
double rest_overlap()
{
    return std::pow(0.75 * g / (effective_modulus(soft(), soft()) * std::sqrt(0.5)), 2.0 / 3);
}

Particle resting()
{
    Particle p = soft_sphere();
    p.r = {0, 0, p.radius - rest_overlap()};
    return p;
}

WorldOptions world_options(Device device = {})
{
    WorldOptions o;
    o.low = {-1, -1, -1}, o.high = {15, 1, 2};
    o.gravity = {0, 0, -g};
    o.h = h, o.device = device;
    return o;
}

PairLaw law(double mu, bool incremental)
{
    PairLaw law = hertz_mindlin(soft(), restitution, mu);
    if (incremental)
        law.tangential =
            MindlinIncremental{.spring = TangentialSpring::of_materials(soft(), soft(), restitution),
                               .cap = {static_cast<float>(mu), static_cast<float>(mu)}};
    return law;
}

double with_spring(double mu)
{
    const TangentialSpring spring = TangentialSpring::of_materials(soft(), soft(), restitution);
    const double k = spring.k_t * std::sqrt(0.5 * rest_overlap()), zeta = 0.5 * spring.c;
    return v_i * v_i / (2 * mu * g) + (2 * zeta * zeta - 1) * mu * g / k - 0.5 * h * v_i;
}

double in_double(double mu, bool incremental)
{
    DoubleWorld world(world_options(), law(mu, incremental));
    world.particle = {resting()};
    world.boundary = {Boundary{}};
    world.turns = false;
    world.step(std::lround(settle / h));
    Particle& p = world.particle[0];
    p.v = {v_i, 0, 0};
    const double start = p.r.x;
    for (long n = 0; n < most_steps && !(p.v.norm() < slow); ++n) world.step();
    return p.r.x - start;
}

struct Slide {
    double way = std::nan("");  ///< [m]
    double most_friction = 0;   ///< largest |F_t|/(μ |F_n|) of all steps
};

Slide slide(double mu, bool incremental, Device device, ValidationTable* motion)
{
    World world(world_options(device), {soft()});
    world.set_law(0, 0, law(mu, incremental));
    world.add(Boundary{});
    world.set_omega_locked(true);
    world.add(resting());
    world.step(std::lround(settle / h));
    world.set_velocity(0, {v_i, 0, 0}, {0, 0, 0});

    const double start = world.particles()[0].r.x;
    const long every = std::lround(0.02 / h);
    Slide out;
    for (long n = 0; n < most_steps && std::isnan(out.way); ++n) {
        if (n > 0) world.step();
        const Particle p = world.particles()[0];
        const double x = p.r.x - start;
        if (p.v.norm() < slow) out.way = x;
        if (motion != nullptr && (n % every == 0 || !std::isnan(out.way)))
            motion->rows.push_back({mu, static_cast<double>(n) * h, x, p.v.x});
        for (const ContactRecord& c : world.contacts())
            out.most_friction = worse(out.most_friction, std::hypot(c.F.x, c.F.y) / (mu * std::abs(c.F.z)));
    }
    return out;
}

ValidationResult run(const ValidationOptions& options)
{
    ValidationTable table = {"study",
                             {"law", "mu", "distance", "coulomb", "difference", "distance_double",
                              "difference_double", "with_spring", "difference_with_spring", "most_friction"},
                             {}};
    ValidationTable motion = {"motion", {"mu", "t", "x", "v"}, {}};
    ValidationResult result;
    double apart = 0, from_spring = 0, incremental = 0, friction = 0, done = 0;
    for (const bool by_increments : {false, true})
        for (const double mu : frictions()) {
            options.progress(done++ / 18);
            if (by_increments && !options.full && mu < 0.39) continue;  // the normal force rests: one law
            const Slide s = slide(mu, by_increments, options.device, by_increments ? nullptr : &motion);
            const double d = v_i * v_i / (2 * mu * g), of_double = in_double(mu, by_increments),
                         spring = with_spring(mu), difference = s.way / d - 1;
            table.rows.push_back({by_increments ? "mindlin-incremental" : "mindlin", mu, s.way, d, difference,
                                  of_double, of_double / d - 1, spring, s.way / spring - 1, s.most_friction});
            if (by_increments) {
                incremental = worse(incremental, std::abs(difference));
            } else {
                char what[64];
                std::snprintf(what, sizeof what, "distance over v^2/(2 mu g) - 1: mu = %.2f", mu);
                result.checks.push_back({what, difference, -3e-4, 3e-4});
            }
            apart = worse(apart, std::abs(s.way / of_double - 1));
            from_spring = worse(from_spring, std::abs(s.way / spring - 1));
            friction = worse(friction, s.most_friction);
        }
    result.checks.push_back({"largest of these, incremental law", incremental, 0, 3e-4});
    result.checks.push_back({"distance from the closed form with the spring", from_spring, 0, 1e-5});
    result.checks.push_back({"distance from double precision", apart, 0, 1e-5});
    result.checks.push_back({"largest |F_t|/(mu |F_n|) of all steps", friction, 0.9999, 1 + 1e-6});
    result.tables = {table, motion};
    return result;
}

const bool registered = register_validation(
    {.name = "brick", .answers = "how far a brick slides, over friction (Fig. 7.4)", .run = run});

}  // namespace

}  // namespace hilda::granular
