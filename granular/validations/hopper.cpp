// SPDX-License-Identifier: GPL-3.0-or-later
/// Discharge of a flat-bottomed hopper through a round outlet (Beverloo, Leniger and van de Velde 1961, Chem.
/// Eng. Sci. 15, 260).
///
///     W = C ρ_b √g (D - k d)^(5/2)
///
/// W: mass flow, ρ_b: bulk density of the bed at rest, D: diameter of the outlet, d: mean diameter of the
/// grains. C is about 0.58 and k about 1.4 for spheres.

#include "granular/insertion/insertion.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/validations/bed_geometry.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "granular/validations/validation.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, d = 4e-3, spread = 0.15, wall = 11 * d, h = 2.5e-5, mu = 0.1, restitution = 0.7;
constexpr double settling = 0.35, longest_settling = 2, flow_begin = 0.15, flow_end = 0.5,
                 sample = 5e-3;          // [s]
constexpr double settled_energy = 1e-2;  ///< largest kinetic energy per grain [m g R]
constexpr std::size_t grains = 10000;

Material glass() { return {"glass", 2500, 1e7, 0.24}; }

World hopper(double low, double high, double outlet, Device device)
{
    WorldOptions o;
    o.low = {-wall - d, -wall - d, low}, o.high = {wall + d, wall + d, high};
    o.gravity = {0, 0, -g}, o.h = h, o.device = device;
    o.outflow[4] = outlet > 0;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), restitution, mu));
    Boundary tube, floor;
    tube.shape = Boundary::Shape::cylinder, tube.inside = 1, tube.radius = wall;
    world.add(tube);
    if (outlet > 0) {
        floor.shape = Boundary::Shape::mesh;
        world.add(floor, lathe_mesh({{outlet / 2, 0}, {wall + d / 2, 0}}, 64));
    } else {
        world.add(floor);
    }
    return world;
}

/// Grains that have fallen from a loose lattice on a closed floor
std::vector<BedSphere> bed_at_rest(Device device, const std::function<void(double)>& progress)
{
    Random random(1);
    constexpr double most = 0.5 * d * (1 + spread), pitch = 2.12 * most;
    std::vector<Particle> all;
    for (int layer = 0; all.size() < grains; ++layer)
        for (int a = -12; a <= 12; ++a)
            for (int b = -12; b <= 12 && all.size() < grains; ++b) {
                if (std::hypot(a * pitch, b * pitch) > wall - 1.1 * most) continue;
                const auto in = [&](double x) { return random.number(-x, x); };
                Particle p;
                p.radius = 0.5 * d * (1 + in(spread));
                p.r = {a * pitch + in(0.05 * most), b * pitch + in(0.05 * most),
                       1.1 * most + layer * pitch + in(0.05 * most)};
                p.v = {in(0.2), in(0.2), in(0.2)};
                all.push_back(p);
            }
    World world = hopper(-d, all.back().r.z + 2 * d, 0, device);
    for (const Particle& p : all) world.add(p);
    settle(world,
           {.what = "the bed",
            .interval = std::lround(0.01 / h),
            .longest = longest_settling,
            .energy = settled_energy,
            .shortest = settling - h / 2},
           progress);
    std::vector<BedSphere> settled;
    for (const Particle& p : world.particles()) settled.push_back({p.r, p.radius});
    return settled;
}

struct Flow {
    double rate = 0;           ///< mass flow between flow_begin and flow_end, by least squares [kg/s]
    double steady = 0;         ///< that of the second half of this time over that of the first
    double balance = 0;        ///< mass inside and left, less the initial and inserted one, over the latter
    double left = 0;           ///< [kg]
    std::vector<double> mass;  ///< that has left until 0, sample, 2 sample, ... [kg]
};

/// Mass flow between the samples number begin and end, by least squares [kg/s]
double rate_of(const std::vector<double>& mass, std::size_t begin, std::size_t end)
{
    std::vector<double> t, of;
    for (std::size_t k = begin; k <= end; ++k)
        t.push_back(static_cast<double>(k) * sample), of.push_back(mass[k]);
    return StraightLine(t, of).b;
}

/// Discharge of a bed. With a refill [kg/s], grains fall on it from above.
Flow discharge(const std::vector<BedSphere>& bed, double outlet, double refill,
               const ValidationOptions& options)
{
    const double top = height_of_98_percent(bed) + 5 * d;
    World world = hopper(-5 * d, top + 2 * d, outlet, options.device);
    for (const BedSphere& p : bed) world.add(Particle{.r = p.r, .radius = p.radius});
    Insertions insertions;
    if (refill > 0) {
        InsertionSpec s;
        s.name = "refill", s.density = glass().density, s.flow.mass_rate = refill;
        s.sizes = Sizes({{0.5 * d * (1 - spread), 0.5 * d * (1 + spread), 1}}, Share::of_number);
        s.region.shape = InsertionRegion::Shape::disk, s.region.r = {0, 0, top},
        s.region.radius = wall - 0.1 * d;
        s.flow.v = {0, 0, -0.3}, s.interval = 400;
        insertions.all.emplace_back(s);
        insertions.start(world, flow_end);
    }
    const auto inside = [&] {
        double sum = 0;
        for (const Particle& p : world.particles()) sum += p.mass;
        return sum;
    };
    world.step(0);
    const double initial = inside();
    Flow flow;
    while (true) {
        flow.mass.push_back(world.outflow().mass);
        world.clear_removed();
        if (flow.mass.size() > std::lround(flow_end / sample)) break;
        world.step(std::lround(sample / h));
    }
    const auto begin = static_cast<std::size_t>(std::lround(flow_begin / sample)), end = flow.mass.size() - 1,
               half = (begin + end) / 2;
    flow.rate = rate_of(flow.mass, begin, end);
    flow.steady = rate_of(flow.mass, half, end) / rate_of(flow.mass, begin, half);
    flow.left = flow.mass.back();
    const double all = initial + insertions.mass();
    flow.balance = (inside() + flow.left - all) / all;
    options.include(io::formatted("outlet of %g mm", 1e3 * outlet), world);
    return flow;
}

ValidationResult run(const ValidationOptions& options)
{
    std::vector<double> outlets = {6 * d, 7.5 * d, 9 * d, 10.5 * d};
    if (options.full) outlets = {6 * d, 6.75 * d, 7.5 * d, 8.25 * d, 9 * d, 9.75 * d, 10.5 * d};
    const double parts = static_cast<double>(outlets.size()) + 3;
    double done = 0;
    std::vector<BedSphere> bed;
    options.kept.part(
        [&] { bed = bed_at_rest(options.device, [&](double share) { options.progress(share / parts); }); },
        [&](io::Archive& a) { a.list(bed); });
    options.progress(++done / parts);
    const auto flow_of = [&](const std::vector<BedSphere>& of, double outlet, double refill) {
        Flow flow;
        options.kept.part([&] { flow = discharge(of, outlet, refill, options); },
                          [&](io::Archive& a) {
                              a.value(flow.rate), a.value(flow.steady), a.value(flow.balance),
                                  a.value(flow.left);
                              a.list(flow.mass);
                          });
        options.progress(++done / parts);
        return flow;
    };
    const double height = height_of_98_percent(bed),
                 density = bulk_density(bed, height, std::numbers::pi * wall * wall, glass().density);
    ValidationTable study{
        "study", {"bed", "D", "W", "steady", "left", "balance", "height", "bulk_density", "C", "k"}, {}},
        motion{"motion", {"bed", "D", "t", "left"}, {}};
    double balance = 0, unsteady = 0;
    const auto add = [&](const std::string& name, double outlet, const Flow& f, double of_height) {
        study.rows.push_back({name, outlet, f.rate, f.steady, f.left, f.balance, of_height, density});
        for (std::size_t k = 0; k < f.mass.size(); ++k)
            motion.rows.push_back({name, outlet, static_cast<double>(k) * sample, f.mass[k]});
        balance = max_or_nan(balance, std::abs(f.balance));
        unsteady = max_or_nan(unsteady, std::abs(f.steady - 1));
    };
    constexpr double k_beverloo = 1.4, of_checks = 9 * d;
    std::vector<double> x, y, open, rates;  // open: D - k d
    double rate = 0;
    for (const double D : outlets) {
        const Flow flow = flow_of(bed, D, 0);
        add("whole", D, flow, height);
        x.push_back(D), y.push_back(std::pow(flow.rate, 0.4));
        open.push_back(D - k_beverloo * d), rates.push_back(flow.rate);
        if (D == of_checks) rate = flow.rate;
    }
    std::vector<BedSphere> lower;
    std::copy_if(bed.begin(), bed.end(), std::back_inserter(lower),
                 [&](const BedSphere& p) { return p.r.z + p.radius < 0.7 * height; });
    const Flow low = flow_of(lower, of_checks, 0), refilled = flow_of(bed, of_checks, rate);
    add("lower", of_checks, low, 0.7 * height), add("refilled", of_checks, refilled, height);
    const StraightLine line(x, y);
    const double C = std::pow(line.b, 2.5) / (density * std::sqrt(g)), k = -line.a / line.b / d;
    for (auto& row : study.rows) row.insert(row.end(), {C, k});
    ValidationResult result;
    result.tables = {study, motion};
    result.checks = {
        {"exponent of D - 1.4 d", exponent(open, rates), 2.35, 2.65},
        {"C with the exponent 5/2", C, 0.55, 0.65},
        {"k with the exponent 5/2", k, 1.2, 1.6},
        {"flow of a bed of 0.7 times the height, over that of the whole one", low.rate / rate, 0.95, 1.05},
        {"flow of a bed that is refilled, over that of the others", refilled.rate / rate, 0.95, 1.05},
        {"largest change of a flow between the halves of its time", unsteady, 0, 0.1},
        {"largest relative error of the mass balance", balance, 0, 1e-12}};
    return result;
}

const bool registered_hopper = io::Registry<Validation>::add(
    {.name = "hopper",
     .description = "mass flow through the outlet of a hopper over its diameter (Beverloo law)",
     .run = run});

}  // namespace

}  // namespace hilda::granular
