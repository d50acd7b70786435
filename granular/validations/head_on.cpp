// SPDX-License-Identifier: GPL-3.0-or-later
/// Head-on collision of two spheres with 1 m/s each: coefficient of restitution by integrator and step.
///                                                                       Fang (2022), Sec. 7.1.1, Fig. 7.2
///
/// Each collision is computed by World and in double precision. The error depends on the instant within a
/// step at which the contact begins. The order is therefore that of the largest error over several initial
/// distances and all restitutions.

#include "granular/validations/soft_sphere.hpp"
#include "granular/validations/straight_line.hpp"
#include "granular/validations/validation.hpp"
#include "granular/world/double_world.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

constexpr double R = 0.5, v_i = 1, end = 0.5, gap = 1e-3;
constexpr double step_of_text = 3e-5;

struct SchemeLimits {
    Scheme scheme;
    double tolerance;  ///< allowed error of the restitution at the step of the dissertation
    bool first_order;  ///< whether the fitted order is checked; the error of chung is too irregular

    const char* name() const { return scheme_names[static_cast<int>(scheme)]; }
};
constexpr SchemeLimits schemes[] = {{Scheme::symplectic_euler, 5e-4, true},
                                    {Scheme::velocity_verlet, 5e-4, true},
                                    {Scheme::chung, 1.5e-4, false},
                                    {Scheme::extended_taylor, 5e-3, true},
                                    {Scheme::forward_euler, 1e-2, true}};

std::vector<double> restitutions()
{
    std::vector<double> all;
    for (int k = 1; k <= 10; ++k) all.push_back(k / 10.0);
    return all;
}

struct Collision {
    double restitution;
    double offset = 0;  ///< additional initial distance [m]
    double drift = 0;   ///< velocity of the centre of mass [m/s]
};

WorldOptions options_without_gravity(double h, Scheme scheme, double wide, Device device = {})
{
    WorldOptions o;
    o.low = {-3, -3, -3}, o.high = {3, wide, 3};
    o.gravity = {0, 0, 0};
    o.h = h, o.scheme = scheme, o.device = device;
    return o;
}

std::array<Particle, 2> approaching(const Collision& m)
{
    std::array<Particle, 2> p = {soft_sphere(), soft_sphere()};
    p[0].r = {-(2 * R + gap) / 2 - m.offset, 0, 0}, p[1].r = {(2 * R + gap) / 2, 0, 0};
    p[0].v = {m.drift + v_i, 0, 0}, p[1].v = {m.drift - v_i, 0, 0};
    return p;
}

PairLaw law(double restitution, bool clamped)
{
    PairLaw law = hertz_mindlin(soft(), restitution);
    if (clamped) {
        Hertz hertz = Hertz::of_materials(soft(), soft(), restitution);
        hertz.clamped = 1;
        law.normal = hertz;
    }
    return law;
}

/// |v_end/v_i| of one collision, in double precision
double rebound(const Collision& m, Scheme scheme, double h, bool clamped = false)
{
    DoubleWorld world(options_without_gravity(h, scheme, 3), law(m.restitution, clamped));
    const auto start = approaching(m);
    world.particle.assign(start.begin(), start.end());
    const std::vector<Particle>& p = world.particle;
    for (double t = 0; t < end; t += h) {
        world.step();
        if (p[1].r.x - p[0].r.x > 2 * R && p[1].v.x > p[0].v.x) break;
    }
    world.step(2);  // chung uses the previous acceleration
    return (p[1].v.x - p[0].v.x) / (2 * v_i);
}

/// A world with several collisions side by side at a distance of 4 m, all with the restitution of the first
World world_of(const std::vector<Collision>& all, Scheme scheme, double h, const ValidationOptions& options)
{
    World world(options_without_gravity(h, scheme, 4 * static_cast<double>(all.size()), options.device),
                {soft()});
    world.set_law(0, 0, law(all[0].restitution, false));
    for (std::size_t k = 0; k < all.size(); ++k)
        for (Particle p : approaching(all[k])) {
            p.r.y = 4 * static_cast<double>(k);
            world.add(p);
        }
    return world;
}

/// Name of a run with this collision
std::string name_of(const Collision& m, Scheme scheme, double h)
{
    std::string name = io::formatted("%s, h = %g s, restitution %g", scheme_names[static_cast<int>(scheme)],
                                     h, m.restitution);
    if (m.drift != 0) name += io::formatted(", drift %g m/s", m.drift);
    return name;
}

/// |v_end/v_i| of each collision, computed by World
std::vector<double> rebounds(const std::vector<Collision>& all, Scheme scheme, double h,
                             const ValidationOptions& options)
{
    World world = world_of(all, scheme, h, options);
    std::vector<double> out(all.size());
    for (bool separated = false; !separated && world.t() < end;) {
        world.step(std::lround(0.01 / h));
        const std::vector<Particle> p = world.particles();
        for (std::size_t k = 0; k < all.size(); ++k) out[k] = (p[2 * k + 1].v.x - p[2 * k].v.x) / (2 * v_i);
        separated =
            world.contacts().empty() && std::all_of(out.begin(), out.end(), [](double v) { return v > 0; });
    }
    options.include(name_of(all[0], scheme, h), world);
    return out;
}

/// Largest change of the momentum of a pair in one step and since the first step, in units of the last place
/// of a float at 1 m/s
struct MomentumChange {
    double of_step = 0, of_all = 0;
};
MomentumChange momentum_change(double drift, const ValidationOptions& options)
{
    const double ulp = std::ldexp(1, -23);
    MomentumChange momentum_change;
    for (const double e : restitutions()) {
        MomentumChange of_pair;
        const auto compute = [&] {
            World world = world_of({{.restitution = e, .drift = drift}}, Scheme::symplectic_euler,
                                   step_of_text, options);
            double start = std::nan(""), last = start;
            while (world.t() < 0.1) {
                world.step();
                const double now = world.momentum().x;
                // after the first step, when the velocities are rounded to single precision
                if (std::isnan(start)) start = last = now;
                of_pair.of_step = max_or_nan(of_pair.of_step, std::abs(now - last) / ulp);
                of_pair.of_all = max_or_nan(of_pair.of_all, std::abs(now - start) / ulp);
                last = now;
            }
            options.include(
                name_of({.restitution = e, .drift = drift}, Scheme::symplectic_euler, step_of_text), world);
        };
        options.kept.part(compute,
                          [&](io::Archive& a) { a.value(of_pair.of_step), a.value(of_pair.of_all); });
        momentum_change.of_step = max_or_nan(momentum_change.of_step, of_pair.of_step);
        momentum_change.of_all = max_or_nan(momentum_change.of_all, of_pair.of_all);
    }
    return momentum_change;
}

/// Largest errors of one scheme at one step over all collisions: of World, in double precision, and the
/// largest difference between the two
struct SchemeErrors {
    double world = 0, in_double = 0, difference = 0;

    void include(const SchemeErrors& other)
    {
        world = max_or_nan(world, other.world), in_double = max_or_nan(in_double, other.in_double);
        difference = max_or_nan(difference, other.difference);
    }
};

/// Those of the collisions with the restitution e
SchemeErrors errors_at(double e, Scheme scheme, double h, int offsets, bool in_world,
                       const ValidationOptions& options)
{
    SchemeErrors out;
    if (!in_world) out.world = std::nan("");
    std::vector<Collision> all;
    all.reserve(offsets);
    for (int k = 0; k < offsets; ++k) all.push_back({.restitution = e, .offset = 2 * h * v_i * k / offsets});
    std::vector<double> in_double;
    for (const Collision& m : all) {
        in_double.push_back(rebound(m, scheme, h));
        out.in_double = max_or_nan(out.in_double, std::abs(in_double.back() - e));
    }
    if (!in_world) return out;
    const std::vector<double> v = rebounds(all, scheme, h, options);
    for (std::size_t k = 0; k < all.size(); ++k) {
        out.world = max_or_nan(out.world, std::abs(v[k] - e));
        out.difference = max_or_nan(out.difference, std::abs(v[k] - in_double[k]));
    }
    return out;
}

SchemeErrors scheme_errors(Scheme scheme, double h, int offsets, bool in_world,
                           const ValidationOptions& options)
{
    SchemeErrors out;
    for (const double e : restitutions()) {
        SchemeErrors at;
        options.kept.part(
            [&] { at = errors_at(e, scheme, h, offsets, in_world, options); },
            [&](io::Archive& a) { a.value(at.world), a.value(at.in_double), a.value(at.difference); });
        out.include(at);
    }
    return out;
}

ValidationResult run(const ValidationOptions& options)
{
    const int offsets = options.full ? 16 : 4;
    const std::vector<double> steps = {3e-5, 1e-5, 3e-6, 1e-6};
    ValidationTable at_text = {
        "study",
        {"integrator", "h", "restitution", "rebound", "difference", "rebound_double", "difference_double"},
        {}};
    ValidationTable refinement = {
        "refinement", {"integrator", "h", "worst", "worst_double", "order_double"}, {}};
    ValidationTable clamped = {"clamped", {"restitution", "rebound", "difference"}, {}};
    ValidationResult result;
    double difference = 0, progress = 0;
    for (const SchemeLimits& s : schemes) {
        for (const double e : restitutions()) {
            double v = 0, in_double = 0;
            options.kept.part(
                [&] {
                    v = rebounds({{e}}, s.scheme, step_of_text, options)[0];
                    in_double = rebound({e}, s.scheme, step_of_text);
                },
                [&](io::Archive& a) { a.value(v), a.value(in_double); });
            at_text.rows.push_back({s.name(), step_of_text, e, v, v - e, in_double, in_double - e});
        }
        std::vector<double> errors;
        for (const double h : steps) {
            const bool in_world = options.full || h > 2e-6 || s.scheme == Scheme::symplectic_euler;
            const SchemeErrors w = scheme_errors(s.scheme, h, offsets, in_world, options);
            const auto n = errors.size();
            const double order =
                n == 0 ? std::nan("") : std::log(w.in_double / errors[n - 1]) / std::log(h / steps[n - 1]);
            errors.push_back(w.in_double);
            difference = max_or_nan(difference, w.difference);
            refinement.rows.push_back({s.name(), h, w.world, w.in_double, order});
            if (h == step_of_text)
                result.checks.push_back({std::string("largest |v_end/v_i| - COR at 3e-5 s: ") + s.name(),
                                         w.world, 0, s.tolerance});
            options.progress(progress += 1.0 / static_cast<double>(std::size(schemes) * steps.size()));
        }
        if (s.first_order)
            result.checks.push_back(
                {std::string("order in double precision: ") + s.name(), exponent(steps, errors), 0.85, 1.15});
    }
    result.checks.push_back({"largest difference of World from double precision", difference, 0, 1e-4});

    for (const double e : restitutions()) {
        double v = 0;
        options.kept.part([&] { v = rebound({e}, Scheme::symplectic_euler, step_of_text, true); },
                          [&](io::Archive& a) { a.value(v); });
        clamped.rows.push_back({e, v, v - e});
        for (const auto& [of, gain] : {std::pair(0.1, 0.1526), std::pair(0.5, 0.050)})
            if (e == of)
                result.checks.push_back(
                    {"clamped law: rebound less COR, COR " + std::to_string(e).substr(0, 3), v - e,
                     gain - 1e-3, gain + 1e-3});
    }
    const MomentumChange still = momentum_change(0, options), drifting = momentum_change(0.37, options);
    result.checks.push_back({"momentum of a pair, largest change in one step [ulp]", drifting.of_step, 0, 1});
    result.checks.push_back({"momentum of a pair, largest change in a run [ulp]", drifting.of_all, 0, 1});
    result.checks.push_back(
        {"momentum of a symmetric pair, largest change in a run [ulp]", still.of_all, 0, 0});
    result.tables = {at_text, refinement, clamped};
    return result;
}

const bool registered_head_on = io::Registry<Validation>::add(
    {.name = "head-on",
     .description = "restitution of a head-on collision, by integrator and step (Fig. 7.2)",
     .run = run});

}  // namespace

}  // namespace hilda::granular
