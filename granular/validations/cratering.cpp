// SPDX-License-Identifier: GPL-3.0-or-later
/// Penetration of a ball that falls on a bed of grains (Fang 2022, Sec. 7.2.3).
///
/// Uehara et al. (2003, Phys. Rev. Lett. 90, 194301) measured the depth d of the crater
///
///     d = c/μ (ρ_b/ρ_g)^(1/2) D^(2/3) H^(1/3),    c = 0.14,  H = h + d
///
/// of a ball of density ρ_b and diameter D that falls from the height h on grains of bulk density ρ_g.

#include "granular/validations/cratering.hpp"

#include "granular/backend/split_mix.hpp"
#include "granular/validations/bed_geometry.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "io/error.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, mu = 0.3, restitution = 0.5, width = 0.09, diameter = 0.0254, bed_height = 0.1;
constexpr double rest_speed = 0.01;                           ///< the ball has come to rest [m/s]
constexpr double longest_impact = 0.2, longest_settling = 1;  // [s]
constexpr const char* run_id = "cratering";

Material glass() { return {"glass", 2500, 7e7, 0.24}; }

/// A fixed fraction of the Rayleigh time of the grains: 5e-6 s for R = 1 mm
double step_of(double R) { return 5e-3 * R; }

/// The bed and the ball, which is boundary number `ball`
struct Bed {
    World world;
    int ball = 0;

    Bed(double R, Device device) : world(options(R, device), {glass()})
    {
        world.set_law(0, 0, hertz_mindlin(glass(), restitution, mu));
        for (const Boundary& b : open_box({0, 0, 0}, {width, width, 0})) world.add(b);
        Boundary sphere;
        sphere.shape = Boundary::Shape::sphere, sphere.radius = diameter / 2;
        sphere.r = {width / 2, width / 2, 0.4};
        ball = world.add(sphere);
    }

    static WorldOptions options(double R, Device device)
    {
        WorldOptions o;
        o.low = {-0.002, -0.002, -0.002}, o.high = {width + 0.002, width + 0.002, 0.45};
        o.gravity = {0, 0, -g}, o.h = step_of(R), o.device = device;
        o.delete_lost = true;  // a grain may be thrown out of the box
        return o;
    }

    /// A loose lattice with random displacements and velocities; at rest it fills the box to about
    /// bed_height.
    void fill(double R)
    {
        constexpr double packing = 0.6;
        const double spacing = 2.1 * R;
        const int row = static_cast<int>((width - 2 * R) / spacing) + 1;
        const double pitch = (width - 2 * R) / (row - 1), of_grain = sphere_volume(R);
        const auto count =
            static_cast<std::size_t>(std::lround(packing * width * width * bed_height / of_grain));
        Random random(1);
        const auto in = [&](double most) { return random.number(-most, most); };
        for (std::size_t k = 0; k < count; ++k) {
            const auto a = static_cast<int>(k) % row, b = static_cast<int>(k) / row % row,
                       layer = static_cast<int>(k) / (row * row);
            const double free = 0.02 * R;
            Particle p;
            p.radius = R;
            p.r = {std::clamp(R + a * pitch + in(free), R, width - R),
                   std::clamp(R + b * pitch + in(free), R, width - R), 1.05 * R + layer * spacing + in(free)};
            p.v = {in(0.1), in(0.1), in(0.1)};
            world.add(p);
        }
    }

    /// Largest kinetic energy of the settled bed, per grain [m g R]
    static constexpr double settled_energy = 1e-3;

    void settle(double R, const std::function<void(double)>& progress)
    {
        granular::settle(world,
                         {.what = io::formatted("the bed of grains of R = %g m", R),
                          .interval = std::lround(0.01 / step_of(R)),
                          .longest = longest_settling,
                          .energy = settled_energy},
                         progress);
    }

    /// Mean height of the surface: of the highest point in each square of edge 4 R, without those at the
    /// walls [m]
    double surface(double R) const
    {
        const auto squares = static_cast<std::size_t>(width / (4 * R));
        const double edge = width / static_cast<double>(squares);
        std::vector<double> top(squares * squares, 0);
        const auto index = [&](double x) {
            return std::min(static_cast<std::size_t>(std::max(x, 0.) / edge), squares - 1);
        };
        for (const Particle& p : world.particles()) {
            double& highest = top[index(p.r.y) * squares + index(p.r.x)];
            highest = std::max(highest, p.r.z + R);
        }
        double sum = 0;
        for (std::size_t b = 1; b < squares - 1; ++b)
            for (std::size_t a = 1; a < squares - 1; ++a) sum += top[b * squares + a];
        return sum / static_cast<double>((squares - 2) * (squares - 2));
    }
};

}  // namespace

BedCase bed_case(double R)
{
    return {"cratering",
            {{"R", R},
             {"h", step_of(R)},
             {"density", glass().density},
             {"E", glass().E},
             {"nu", glass().nu},
             {"restitution", restitution},
             {"mu", mu},
             {"g", g},
             {"width", width},
             {"height", bed_height},
             {"settled energy", Bed::settled_energy}}};
}

SettledBed settled_bed(double R, const ValidationOptions& options,
                       const std::function<void(double)>& progress)
{
    SettledBed bed;
    options.beds.bed(
        bed_case(R),
        [&] {
            Bed now(R, options.device);
            now.fill(R);
            now.settle(R, progress);
            bed.surface = now.surface(R), bed.density = bulk_density(equal_spheres(now.world, R), bed.surface,
                                                                     width * width, glass().density);
            bed.bytes = now.world.to_bytes(run_id);
        },
        [&](io::Archive& a) { a.value(bed.surface), a.value(bed.density), a.list(bed.bytes); });
    return bed;
}

Crater impact(const Impact& of, const SettledBed& bed, const ValidationOptions& options)
{
    Bed now(of.R, options.device);
    now.world.from_bytes(bed.bytes, run_id, "settled bed");
    World& world = now.world;
    const double r = diameter / 2,
                 start = first_contact(
                             equal_spheres(world, of.R), r,
                             [](const Vec3&s) { return std::hypot(s.x - width / 2, s.y - width / 2); }) -
                         r;
    Boundary& ball = world.boundary(now.ball);
    ball.mass = sphere_mass(r, of.density);
    ball.inertia = 0.4 * ball.mass * r * r;
    ball.r = {width / 2, width / 2, start + r};
    ball.v = {0, 0, -std::sqrt(2 * g * std::max(of.height + bed.surface - start, 0.))};
    Crater out;
    const double h = step_of(of.R), begin = world.t();
    const long interval = std::lround(5e-4 / h);
    while (true) {
        const Boundary& b = world.all_boundaries()[static_cast<std::size_t>(now.ball)];
        out.time = world.t() - begin, out.depth = bed.surface - (b.r.z - r);
        out.motion.push_back({out.time, out.depth, -b.v.z});
        if (out.time > 0 && -b.v.z < rest_speed) break;
        if (out.time > longest_impact)
            throw io::NumericalFailure(
                "not_settled", io::formatted("the ball of %g kg/m^3 still moves at %.3g m/s after %g s",
                                             of.density, b.v.norm(), longest_impact));
        world.step(interval);
    }
    options.include(io::formatted("R = %g mm, %g kg/m^3 from %g cm", 1e3 * of.R, of.density, 100 * of.height),
                    world);
    return out;
}

namespace {

std::vector<Impact> impacts(bool full)
{
    constexpr double light = 280, medium = 700, heavy = 2200;
    std::vector<Impact> all;
    const double R = full ? 1e-3 : 2e-3;
    if (full) {
        for (const double density : {light, medium, heavy})
            for (const double height : {0.05, 0.1, 0.2}) all.push_back({R, density, height});
        all.push_back({2e-3, heavy, 0.1});
    } else {
        // The light ball sinks by less than two of these grains.
        all = {{R, medium, 0.1}, {R, heavy, 0.05}, {R, heavy, 0.1}, {R, heavy, 0.2}};
    }
    all.push_back({3e-3, heavy, 0.1});
    return all;
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<Impact> all = impacts(options.full);
    std::set<double> sizes;
    for (const Impact& of : all) sizes.insert(of.R);
    struct Part {
        double surface = 0, density = 0;  ///< of the bed
        Crater crater;
    };
    std::vector<Part> craters(all.size());
    std::map<double, SettledBed> beds;  // by the radius of the grains
    double done = 0;
    const auto parts = static_cast<double>(all.size() + 4 * sizes.size());
    const auto compute = [&](long k) {
        const Impact& of = all[static_cast<std::size_t>(k)];
        const auto [bed, is_new] = beds.try_emplace(of.R);
        if (is_new) {
            bed->second = settled_bed(of.R, options,
                                      [&](double share) { options.progress((done + 4 * share) / parts); });
            options.progress((done += 4) / parts);
        }
        const SettledBed& b = bed->second;
        craters[static_cast<std::size_t>(k)] = {b.surface, b.density, impact(of, b, options)};
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        auto& [surface, density, c] = craters[static_cast<std::size_t>(k)];
        a.value(surface), a.value(density), a.value(c.depth), a.value(c.time), a.list(c.motion);
    });

    ValidationTable table{
        "study",
        {"R", "density", "height", "depth", "time", "H", "scale", "slope", "bulk_density", "surface"},
        {}},
        motion{"motion", {"R", "density", "height", "t", "depth", "speed"}, {}};
    const double R = all.front().R;
    std::vector<double> densities, of_density, heights, of_height, slopes;
    std::map<double, double> slope_of_size;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Impact& of = all[n];
        const auto& [surface, density, c] = craters[n];
        const double H = of.height + c.depth,
                     scale = std::sqrt(of.density / density) * std::pow(diameter, 2. / 3) * std::cbrt(H),
                     slope = c.depth * mu / scale;
        table.rows.push_back(
            {of.R, of.density, of.height, c.depth, c.time, H, scale, slope, density, surface});
        for (const Crater::Sample& s : c.motion)
            motion.rows.push_back({of.R, of.density, of.height, s.t, s.depth, s.speed});
        if (of.density == 2200 && of.height == 0.1) slope_of_size[of.R] = slope;
        if (of.R != R) continue;
        slopes.push_back(slope);
        // The depth at the same H: d/H^(1/3) for the exponent of the density, d/ρ^(1/2) for that of H
        densities.push_back(of.density), of_density.push_back(c.depth / std::cbrt(H));
        heights.push_back(H), of_height.push_back(c.depth / std::sqrt(of.density));
    }
    ValidationResult result;
    result.tables = {table, motion};
    double mean = 0;
    for (const double slope : slopes) mean += slope / static_cast<double>(slopes.size());
    result.checks.push_back(
        {"exponent of the density of the ball", exponent(densities, of_density), 0.4, 0.6});
    result.checks.push_back({"exponent of the height of fall", exponent(heights, of_height), 0.26, 0.40});
    // The slope grows as the grains become smaller: the interval of the experiment holds for R = 1 mm.
    result.checks.push_back({io::formatted("slope d mu/scale, R = %g mm", 1e3 * R), mean,
                             options.full ? 0.10 : 0.08, options.full ? 0.15 : 0.11});
    double last = 0;
    for (auto size = slope_of_size.rbegin(); size != slope_of_size.rend(); last = (size++)->second)
        if (last > 0)
            result.checks.push_back(
                {io::formatted("slope with R = %g mm over that of larger grains", 1e3 * size->first),
                 size->second / last, 1.02, 2});
    return result;
}

const bool registered_cratering = io::Registry<Validation>::add(
    {.name = "cratering",
     .description = "depth of the crater of a ball over its density and height of fall (Fig. 7.14)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
