// SPDX-License-Identifier: GPL-3.0-or-later
/// Sliding distance of a sphere whose rotation is locked.        Fang (2022), Sec. 7.1.2, Fig. 7.4
///
/// A rigid brick with Coulomb friction slides over v²/(2 μ g). The sphere has a tangential spring and damper,
/// whose force is at the Coulomb bound until the speed has fallen to 2 ζ μ g/ω. Below, the sphere performs a
/// free damped oscillation. The total distance is
///
///     d = v²/(2 μ g) + (2 ζ² - 1) μ m g/k - h v/2,    ω² = k/m,  ζ = c/2
///
/// where k and c are the stiffness and the damping of the tangential law; the last term is the discretisation
/// error of symplectic Euler.

#include "granular/validations/soft_sphere.hpp"
#include "granular/validations/validation.hpp"
#include "granular/world/double_world.hpp"
#include "io/message.hpp"

#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, v_i = 5, h = 2e-5, settle = 0.08;
constexpr double rest_speed = 1e-7;    // below this speed the sphere is at rest [m/s]
constexpr double restitution = 1e-7;   // smallest allowed value, in place of 0
constexpr long max_steps = 1'000'000;  // four times the number that is needed

std::vector<double> frictions()
{
    std::vector<double> all;
    for (int k = 2; k <= 10; ++k) all.push_back(k / 20.0);
    return all;
}

/// Static overlap under the weight of the sphere, from F = 4/3 E* √R δ^(3/2) [m]
double static_overlap()
{
    return std::pow(0.75 * g / (effective_modulus(soft(), soft()) * std::sqrt(0.5)), 2.0 / 3);
}

Particle sphere_at_rest()
{
    Particle p = soft_sphere();
    p.r = {0, 0, p.radius - static_overlap()};
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

double distance_with_spring(double mu)
{
    const TangentialSpring spring = TangentialSpring::of_materials(soft(), soft(), restitution);
    const double k = spring.k_t * std::sqrt(0.5 * static_overlap()), zeta = 0.5 * spring.c;
    return v_i * v_i / (2 * mu * g) + (2 * zeta * zeta - 1) * mu * g / k - 0.5 * h * v_i;
}

double in_double(const PairLaw& law)
{
    DoubleWorld world(world_options(), law);
    world.particle = {sphere_at_rest()};
    world.boundary = {Boundary{}};
    world.turns = false;
    world.step(std::lround(settle / h));
    Particle& p = world.particle[0];
    p.v = {v_i, 0, 0};
    const double start = p.r.x;
    for (long n = 0; n < max_steps && !(p.v.norm() < rest_speed); ++n) world.step();
    return p.r.x - start;
}

struct Slide {
    double distance = std::nan("");  ///< [m]
    double friction_ratio = 0;       ///< largest |F_t|/(μ |F_n|) over all steps
    struct Sample {
        double t, x, v;  ///< [s, m, m/s]
    };
    std::vector<Sample> motion;
};

/// The law with the bound of the spring alone, as Eqs. 2.46 and 2.47 are printed
PairLaw printed_law(double mu)
{
    PairLaw law = soft_law(restitution, mu, false);
    const auto bound = static_cast<float>(mu);
    law.tangential = Mindlin{.spring = TangentialSpring::of_materials(soft(), soft(), restitution),
                             .cap = {bound, bound},
                             .spring_bound = 1};
    return law;
}

Slide slide(double mu, const PairLaw& law, const std::string& name, const ValidationOptions& options)
{
    World world(world_options(options.device), {soft()});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    world.set_omega_locked(true);
    world.add(sphere_at_rest());
    world.step(std::lround(settle / h));
    world.set_velocity(0, {v_i, 0, 0}, {0, 0, 0});

    const double start = world.particles()[0].r.x;
    const long interval = std::lround(0.02 / h);
    Slide out;
    for (long n = 0; n < max_steps && std::isnan(out.distance); ++n) {
        if (n > 0) world.step();
        const Particle p = world.particles()[0];
        const double x = p.r.x - start;
        if (p.v.norm() < rest_speed) out.distance = x;
        if (n % interval == 0 || !std::isnan(out.distance))
            out.motion.push_back({static_cast<double>(n) * h, x, p.v.x});
        for (const ContactRecord& c : world.contacts())
            out.friction_ratio =
                max_or_nan(out.friction_ratio, std::hypot(c.F.x, c.F.y) / (mu * std::abs(c.F.z)));
    }
    options.include(io::formatted("%s, mu = %g", name.c_str(), mu), world);
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
    double from_double = 0, from_spring = 0, incremental = 0, friction = 0, done = 0;
    const auto count = static_cast<double>(3 * frictions().size());
    for (const bool is_incremental : {false, true})
        for (const double mu : frictions()) {
            options.progress(done++ / count);
            // the normal force is constant, so both laws agree
            if (is_incremental && !options.full && mu < 0.39) continue;
            const std::string name = is_incremental ? "mindlin-incremental" : "mindlin";
            Slide s;
            double distance_double = 0;
            options.kept.part(
                [&] {
                    s = slide(mu, soft_law(restitution, mu, is_incremental), name, options);
                    distance_double = in_double(soft_law(restitution, mu, is_incremental));
                },
                [&](io::Archive& a) {
                    a.value(s.distance), a.value(s.friction_ratio), a.list(s.motion);
                    a.value(distance_double);
                });
            if (!is_incremental)
                for (const Slide::Sample& row : s.motion) motion.rows.push_back({mu, row.t, row.x, row.v});
            const double d = v_i * v_i / (2 * mu * g), spring = distance_with_spring(mu),
                         difference = s.distance / d - 1;
            table.rows.push_back({name, mu, s.distance, d, difference, distance_double,
                                  distance_double / d - 1, spring, s.distance / spring - 1,
                                  s.friction_ratio});
            if (is_incremental) {
                incremental = max_or_nan(incremental, std::abs(difference));
            } else {
                char what[64];
                std::snprintf(what, sizeof what, "distance over v^2/(2 mu g) - 1: mu = %.2f", mu);
                result.checks.push_back({what, difference, -3e-4, 3e-4});
            }
            from_double = max_or_nan(from_double, std::abs(s.distance / distance_double - 1));
            from_spring = max_or_nan(from_spring, std::abs(s.distance / spring - 1));
            friction = max_or_nan(friction, s.friction_ratio);
        }
    // The fault of the printed bound grows with the coefficient of friction.
    for (const double mu : frictions()) {
        options.progress(done++ / count);
        if (!options.full && mu > 0.11 && mu < 0.49) continue;
        Slide s;
        double distance_double = 0;
        options.kept.part(
            [&] {
                s = slide(mu, printed_law(mu), "mindlin, spring_bound", options);
                distance_double = in_double(printed_law(mu));
            },
            [&](io::Archive& a) {
                a.value(s.distance), a.value(s.friction_ratio), a.list(s.motion);
                a.value(distance_double);
            });
        const double d = v_i * v_i / (2 * mu * g), difference = s.distance / d - 1;
        table.rows.push_back({"mindlin, spring_bound", mu, s.distance, d, difference, distance_double,
                              distance_double / d - 1, "", "", s.friction_ratio});
        from_double = max_or_nan(from_double, std::abs(s.distance / distance_double - 1));
        if (mu < 0.11)
            result.checks.push_back(
                {"bound of the spring alone: too short at mu = 0.1", -difference, 0.003, 0.007});
        if (mu > 0.49)
            result.checks.push_back(
                {"bound of the spring alone: too short at mu = 0.5", -difference, 0.035, 0.05});
    }
    result.checks.push_back(
        {"distance over v^2/(2 mu g) - 1: largest, incremental law", incremental, 0, 3e-4});
    result.checks.push_back(
        {"relative difference from the closed form with the spring", from_spring, 0, 1e-5});
    result.checks.push_back({"relative difference from double precision", from_double, 0, 1e-5});
    result.checks.push_back({"largest |F_t|/(mu |F_n|) of all steps", friction, 0.9999, 1 + 1e-6});
    result.tables = {table, motion};
    return result;
}

const bool registered = io::Registry<Validation>::add(
    {.name = "brick",
     .description = "sliding distance over the coefficient of friction (Fig. 7.4)",
     .run = run});

}  // namespace

}  // namespace hilda::granular
