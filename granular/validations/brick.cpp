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

/// A slide of the study: the law and the coefficient of friction
struct BrickTest {
    enum Law { mindlin, incremental, spring_bound } law;
    double mu;

    std::string name() const
    {
        return law == mindlin       ? "mindlin"
               : law == incremental ? "mindlin-incremental"
                                    : "mindlin, spring_bound";
    }
    PairLaw pair_law() const
    {
        return law == spring_bound ? printed_law(mu) : soft_law(restitution, mu, law == incremental);
    }
};

std::vector<BrickTest> tests(bool full)
{
    std::vector<BrickTest> all;
    for (const double mu : frictions()) all.push_back({BrickTest::mindlin, mu});
    // The normal force is constant, so both laws agree.
    for (const double mu : frictions())
        if (full || mu > 0.39) all.push_back({BrickTest::incremental, mu});
    // The fault of the printed bound grows with the coefficient of friction.
    for (const double mu : frictions())
        if (full || mu < 0.11 || mu > 0.49) all.push_back({BrickTest::spring_bound, mu});
    return all;
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<BrickTest> all = tests(options.full);
    struct Part {
        Slide slide;
        double distance_double = 0;
    };
    std::vector<Part> slides(all.size());
    double done = 0;
    const auto compute = [&](long k) {
        const BrickTest& test = all[static_cast<std::size_t>(k)];
        slides[static_cast<std::size_t>(k)] = {slide(test.mu, test.pair_law(), test.name(), options),
                                               in_double(test.pair_law())};
        options.progress(++done / static_cast<double>(all.size()));
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        auto& [s, distance_double] = slides[static_cast<std::size_t>(k)];
        a.value(s.distance), a.value(s.friction_ratio), a.list(s.motion), a.value(distance_double);
    });

    ValidationTable table = {"study",
                             {"law", "mu", "distance", "coulomb", "difference", "distance_double",
                              "difference_double", "with_spring", "difference_with_spring", "most_friction"},
                             {}};
    ValidationTable motion = {"motion", {"mu", "t", "x", "v"}, {}};
    ValidationResult result;
    double from_double = 0, from_spring = 0, incremental = 0, friction = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const auto& [law, mu] = all[k];
        const auto& [s, distance_double] = slides[k];
        const double d = v_i * v_i / (2 * mu * g), spring = distance_with_spring(mu),
                     difference = s.distance / d - 1;
        std::vector<ValidationTable::Cell> row = {
            all[k].name(), mu, s.distance, d, difference, distance_double, distance_double / d - 1};
        from_double = max_or_nan(from_double, std::abs(s.distance / distance_double - 1));
        if (law == BrickTest::spring_bound) {
            row.insert(row.end(), {"", "", s.friction_ratio});
            if (mu < 0.11)
                result.checks.push_back(
                    {"bound of the spring alone: too short at mu = 0.1", -difference, 0.003, 0.007});
            if (mu > 0.49)
                result.checks.push_back(
                    {"bound of the spring alone: too short at mu = 0.5", -difference, 0.035, 0.05});
        } else {
            row.insert(row.end(), {spring, s.distance / spring - 1, s.friction_ratio});
            from_spring = max_or_nan(from_spring, std::abs(s.distance / spring - 1));
            friction = max_or_nan(friction, s.friction_ratio);
        }
        table.rows.push_back(row);
        if (law == BrickTest::incremental) incremental = max_or_nan(incremental, std::abs(difference));
        if (law != BrickTest::mindlin) continue;
        result.checks.push_back(
            {io::formatted("distance over v^2/(2 mu g) - 1: mu = %.2f", mu), difference, -3e-4, 3e-4});
        for (const Slide::Sample& sample : s.motion)
            motion.rows.push_back({mu, sample.t, sample.x, sample.v});
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

const bool registered_brick = io::Registry<Validation>::add(
    {.name = "brick",
     .description = "sliding distance over the coefficient of friction (Fig. 7.4)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
