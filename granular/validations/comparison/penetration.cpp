// SPDX-License-Identifier: GPL-3.0-or-later
/// Impact of a steel ball on a bed (Dosta et al. 2024, Comput. Phys. Commun. 296, 109066, case 3).
///
/// A box of 100 mm × 60 mm has 25 000, 50 000 or 100 000 grains M1 of diameter 2 mm. A steel ball of diameter
/// 20 mm starts 150 mm above the bottom with 5 m/s downward. The published result is the height of the ball
/// over 0.1 s. The published start positions are not used: the grains fall from a loose lattice and settle.

#include "granular/validations/comparison/penetration.hpp"

#include "granular/validations/settling.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, half_x = 0.05, half_y = 0.03;
constexpr double domain_top = 0.5;  ///< above the grains that the ball throws up [m]

World box(const Penetration& test, double top, Device device)
{
    WorldOptions o;
    o.low = {-half_x, -half_y, 0}, o.high = {half_x, half_y, top};
    std::array<Boundary, 5> walls = open_box(o.low, o.high);
    const Vec3 margin{test.radius(), test.radius(), test.radius()};
    o.low = o.low - margin, o.high = o.high + margin;
    o.gravity = {0, 0, -g}, o.h = bulk_step(test.radius(), M1, test.scale), o.device = device;
    World world(o, bulk_materials(test.scale));
    set_bulk_laws(world, test.scale);
    for (Boundary& b : walls) b.material = steel, world.add(b);
    return world;
}

Particle grain(const Penetration& test)
{
    Particle p;
    p.radius = test.radius(), p.material = M1;
    return p;
}

}  // namespace

std::vector<Vec3> penetration_bed(const Penetration& test, const ValidationOptions& options,
                                  const std::function<void(double)>& progress)
{
    Penetration soft = test;
    soft.scale.softness *= 10;
    const double R = test.radius(), h = bulk_step(R, M1, soft.scale);
    Random random(1);
    const auto inside = [R](const Vec3& r) {
        return std::abs(r.x) < half_x - 1.1 * R && std::abs(r.y) < half_y - 1.1 * R;
    };
    const std::vector<Particle> start = loose_layers(grain(test), test.number(), 0, half_x, inside, random);
    World world = box(soft, highest_point(start) + R, options.device);
    for (const Particle& p : start) world.add(p);
    settle(world, {.what = "the bed", .interval = std::lround(0.01 / h), .longest = 3, .energy = 1e-2},
           progress);
    std::vector<Vec3> centres;
    for (const Particle& p : world.particles()) centres.push_back(p.r);
    return centres;
}

std::size_t BallMotion::contact() const
{
    std::size_t k = 0;
    while (k + 1 < z.size() && z[k + 1] - radius > surface) ++k;
    return k;
}

std::size_t BallMotion::stop() const
{
    std::size_t k = contact();
    while (k + 1 < v.size() && v[k] < 0) ++k;
    return k;
}

double BallMotion::peak() const
{
    double a = 0;
    for (std::size_t k = 0; k + 1 < v.size(); ++k) a = max_or_nan(a, (v[k + 1] - v[k]) / (t[k + 1] - t[k]));
    return a;
}

BallMotion ball_motion(const Penetration& test, const std::vector<Vec3>& bed,
                       const ValidationOptions& options)
{
    World world = box(test, domain_top, options.device);
    for (const Vec3& r : bed) {
        Particle p = grain(test);
        p.r = r;
        world.add(p);
    }
    Particle p;
    p.radius = BallMotion::radius, p.material = steel;
    p.r = {0, 0, BallMotion::start}, p.v = {0, 0, -BallMotion::speed};
    const std::uint32_t ball = world.add(p);
    const long interval = std::lround(test.sample / bulk_step(test.radius(), M1, test.scale)),
               samples = std::lround(test.time / test.sample);
    BallMotion out;
    out.surface = height_of_98_percent(equal_spheres(bed, test.radius())) + test.radius();
    for (long k = 0; k <= samples; ++k) {
        world.step(k > 0 ? interval : 0);
        world.each_particle([&](const Particle& now) {
            if (now.id == ball)
                out.t.push_back(world.t()), out.z.push_back(now.r.z), out.v.push_back(now.v.z);
        });
    }
    out.lost = static_cast<double>(bed.size() + 1) - static_cast<double>(world.count());
    options.include(io::formatted("%ld grains, E/%g", test.number(), test.scale.softness), world);
    return out;
}

namespace {

/// The three beds, then the first one with ten times the Young's moduli
std::vector<Penetration> tests(bool full)
{
    Penetration test;
    test.scale.softness = 10;
    if (!full) test.scale.size = 2;
    std::vector<Penetration> all;
    for (const long grains : {25000, 50000, 100000}) all.push_back(test), all.back().grains = grains;
    all.push_back(test), all.back().scale.softness = 1;
    return all;
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<Penetration> all = tests(options.full);
    if (options.full)
        options.announce("4 impacts on up to 100 000 grains, about an hour of CPU time in the preset native");
    ValidationTable table{
        "study",
        {"grains", "diameter", "softness", "surface", "time", "height", "depth", "height_end", "peak"},
        {}},
        motion{"motion", {"grains", "softness", "t", "z", "v"}, {}};
    const auto parts = static_cast<double>(2 * all.size());
    double done = 0, lost = 0, fall = 0, rise = 0, lowest = BallMotion::start / BallMotion::radius;
    struct Part {
        std::uint64_t grains = 0;  ///< of the bed
        BallMotion motion;
    };
    std::vector<Part> balls(all.size());
    const auto compute = [&](long k) {
        const Penetration& test = all[static_cast<std::size_t>(k)];
        const std::vector<Vec3> bed =
            penetration_bed(test, options, [&](double share) { options.progress((done + share) / parts); });
        options.progress(++done / parts);
        balls[static_cast<std::size_t>(k)] = {bed.size(), ball_motion(test, bed, options)};
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        auto& [grains, m] = balls[static_cast<std::size_t>(k)];
        a.value(grains), a.list(m.t), a.list(m.z), a.list(m.v), a.value(m.surface), a.value(m.lost);
    });
    std::vector<double> depths;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Penetration& test = all[n];
        const BallMotion& m = balls[n].motion;
        const std::size_t contact = m.contact(), stop = m.stop();
        const auto grains = static_cast<double>(balls[n].grains);
        table.rows.push_back({grains, 2 * test.radius(), test.scale.softness, m.surface,
                              m.t[stop] - m.t[contact], m.z[stop], m.depth(), m.z.back(), m.peak()});
        for (std::size_t k = 0; k < m.t.size(); ++k)
            motion.rows.push_back({grains, test.scale.softness, m.t[k], m.z[k], m.v[k]});
        const double t = m.t[contact];
        fall = max_or_nan(
            fall, std::abs(m.z[contact] - (BallMotion::start - BallMotion::speed * t - g * t * t / 2)));
        for (std::size_t k = contact; k < stop; ++k)
            rise = max_or_nan(rise, std::abs(m.v[k]) / std::abs(m.v[contact]));
        lost = max_or_nan(lost, std::abs(m.lost));
        lowest = min_or_nan(lowest, m.z[stop] / BallMotion::radius);
        depths.push_back(m.depth());
    }
    const double d = 2 * all.front().radius();
    return {
        {table, motion},
        {{"largest error of the free fall before the contact [m]", fall, 0, 2e-6},
         {"largest speed of the ball in the bed over that at the contact", rise, 0, 1.01},
         {"lowest height of the centre of the ball over its radius", lowest, 1, no_bound},
         {"depth in the second bed less that in the first one [d]", (depths[1] - depths[0]) / d, 0, no_bound},
         {"depth in the third bed less that in the second one [d]", (depths[2] - depths[1]) / d, -2, 2},
         {"depth with ten times E less the other, first bed [d]", (depths[3] - depths[0]) / d, -1, 1},
         {"grains that are missing at the end", lost, 0, 0}}};
}

const bool registered_penetration = io::Registry<Validation>::add(
    {.name = "comparison-penetration",
     .description = "impact of a steel ball on a bed of grains (comparison of ten codes, case 3)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
