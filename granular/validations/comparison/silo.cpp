// SPDX-License-Identifier: GPL-3.0-or-later
/// Emptying of a silo (Dosta et al. 2024, Comput. Phys. Commun. 296, 109066, case 1).
///
/// A cylinder of radius 100 mm with a conical hopper of 45° and a round orifice of diameter 40 or 60 mm is
/// filled with 100 000 grains of diameter 4 mm. The published result is the number of grains above the
/// orifice over 5 s. The geometry is that of the smooth walls of MercuryDPM. The published start positions
/// are not used: the grains fall from a loose lattice and settle on a floor in the orifice.

#include "granular/validations/comparison/silo.hpp"

#include "granular/mesh/mesh_shapes.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, cylinder_radius = 0.1;
constexpr double flow_begin = 0.3, least_retained = 0.35;

/// The silo with its grains and a floor under the orifice
struct SiloWorld {
    World world;
    int floor = 0;

    SiloWorld(const Silo& s, const std::vector<Particle>& grains, Device device)
        : world(options(s, highest_point(grains) + s.radius(), device), bulk_materials(s.scale))
    {
        set_bulk_laws(world, s.scale);
        Boundary b;
        b.material = steel;
        b.r.z = -s.depth(), floor = world.add(b);
        b.r.z = 0, b.shape = Boundary::Shape::cylinder, b.inside = 1, b.radius = cylinder_radius;
        world.add(b);
        const double R = s.radius();
        b.shape = Boundary::Shape::mesh;
        world.add(b, lathe_mesh({{s.orifice / 2, -s.depth()}, {cylinder_radius + R / 2, R / 2}}, 64));
        for (const Particle& p : grains) world.add(p);
        world.step(0);
    }

    static WorldOptions options(const Silo& s, double top, Device device)
    {
        const double side = cylinder_radius + s.radius();
        WorldOptions o;
        o.low = {-side, -side, -s.depth() - 0.02}, o.high = {side, side, top};
        o.gravity = {0, 0, -g}, o.h = s.h(), o.device = device;
        o.outflow[4] = true;
        return o;
    }

    void settle(double h, const std::function<void(double)>& progress)
    {
        granular::settle(world,
                         {.what = "the filling of the silo",
                          .interval = std::lround(0.01 / h),
                          .longest = 3,
                          .energy = 1e-2},
                         progress);
    }

    /// Puts the floor below the domain.
    void open() { world.boundary(floor).r.z = world.low().z - 1; }
};

std::vector<Particle> loose_grains(const Silo& s)
{
    Particle p;
    p.radius = s.radius(), p.material = s.material;
    const auto inside = [&](const Vec3& r) {
        const double of_cone = s.orifice / 2 + r.z + s.depth() - 1.1 * std::numbers::sqrt2 * p.radius;
        return std::hypot(r.x, r.y) < std::min(cylinder_radius - 1.1 * p.radius, of_cone);
    };
    Random random(1);
    return loose_layers(p, s.number(), -s.depth(), cylinder_radius, inside, random);
}

}  // namespace

double Silo::depth() const { return cylinder_radius - orifice / 2; }

double SiloFlow::slope(double from, double to) const
{
    std::vector<double> x, y;
    for (std::size_t k = 0; k < t.size(); ++k)
        if (t[k] > from - 1e-9 && t[k] < to + 1e-9) x.push_back(t[k]), y.push_back(retained[k]);
    return -StraightLine(x, y).b;
}

namespace {

/// The last sample with enough grains above the orifice
double end_of_flow(const SiloFlow& f)
{
    double end = 0;
    for (std::size_t k = 0; k < f.t.size(); ++k)
        if (f.retained[k] >= least_retained * f.retained.front()) end = f.t[k];
    return end;
}

}  // namespace

double SiloFlow::rate() const { return slope(flow_begin, end_of_flow(*this)); }

double SiloFlow::steady() const
{
    const double end = end_of_flow(*this), middle = (flow_begin + end) / 2;
    return slope(middle, end) / slope(flow_begin, middle);
}

SiloFlow silo_flow(const Silo& silo, const ValidationOptions& options,
                   const std::function<void(double)>& progress)
{
    SiloWorld now(silo, loose_grains(silo), options.device);
    World& world = now.world;
    const auto initial = static_cast<double>(world.count());
    now.settle(silo.h(), [&](double share) { progress(0.3 * share); });
    now.open();
    const double start = world.t();
    const long interval = std::lround(silo.sample / silo.h()), samples = std::lround(silo.time / silo.sample);
    SiloFlow out;
    for (long k = 0; k <= samples; ++k) {
        world.step(k > 0 ? interval : 0);
        world.clear_removed();
        double retained = 0;
        world.each_particle([&](const Particle& p) { retained += p.r.z > -silo.depth() ? 1 : 0; });
        out.t.push_back(world.t() - start), out.retained.push_back(retained);
        progress(1 - 0.7 * (1 - static_cast<double>(k) / static_cast<double>(samples)));
        if (retained == 0) break;
    }
    out.balance = static_cast<double>(world.count()) + static_cast<double>(world.outflow().count) - initial;
    options.include(io::formatted("orifice of %g mm, M%d", 1e3 * silo.orifice, silo.material + 1), world);
    return out;
}

namespace {

ValidationResult run(const ValidationOptions& options)
{
    std::vector<Silo> all;
    for (const double orifice : {0.04, 0.06})
        for (const BulkMaterial material : {M1, M2}) {
            Silo s{.orifice = orifice, .material = material};
            s.scale.softness = 500;
            if (!options.full) s.scale.size = 2, s.time = 1.5;
            all.push_back(s);
        }
    if (options.full)
        options.announce("4 silos with 100 000 grains, about an hour of CPU time in the preset native");
    const auto parts = static_cast<double>(all.size());
    double done = 0;
    ValidationTable table{"study",
                          {"orifice", "material", "diameter", "grains", "softness", "rate", "mass_rate",
                           "steady", "left", "balance"},
                          {}},
        motion{"motion", {"orifice", "material", "t", "retained"}, {}};
    std::vector<double> rates;
    double balance = 0, unsteady = 0;
    std::vector<SiloFlow> flows(all.size());
    const auto compute = [&](long k) {
        flows[static_cast<std::size_t>(k)] =
            silo_flow(all[static_cast<std::size_t>(k)], options,
                      [&](double share) { options.progress((done + share) / parts); });
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        SiloFlow& f = flows[static_cast<std::size_t>(k)];
        a.list(f.t), a.list(f.retained), a.value(f.balance);
    });
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Silo& s = all[n];
        const SiloFlow& f = flows[n];
        const double R = s.radius(),
                     mass = sphere_mass(
                         R, bulk_materials(s.scale)[static_cast<std::size_t>(s.material)].density);
        const std::string name = s.material == M1 ? "M1" : "M2";
        rates.push_back(f.rate());
        table.rows.push_back({s.orifice, name, 2 * R, f.retained.front(), s.scale.softness, f.rate(),
                              f.rate() * mass, f.steady(), f.retained.back() / f.retained.front(),
                              f.balance});
        for (std::size_t k = 0; k < f.t.size(); ++k)
            motion.rows.push_back({s.orifice, name, f.t[k], f.retained[k]});
        balance = max_or_nan(balance, std::abs(f.balance));
        unsteady = max_or_nan(unsteady, std::abs(f.steady() - 1));
    }
    // Beverloo's law with k = 1.4: ((D2 - k d)/(D1 - k d))^(5/2), large orifice over small
    const double kd = 1.4 * 2 * all.front().radius(),
                 beverloo = std::pow((all.back().orifice - kd) / (all.front().orifice - kd), 2.5);
    return {
        {table, motion},
        {{"rate of M1, large orifice over small, over that of Beverloo's law", rates[2] / rates[0] / beverloo,
          0.75, 1.25},
         {"rate of M2, large orifice over small, over that of Beverloo's law", rates[3] / rates[1] / beverloo,
          0.75, 1.25},
         {"rate of M2 (mu = 0.4) over that of M1 (mu = 0.3), small orifice", rates[1] / rates[0], 0.75, 1},
         {"rate of M2 over that of M1, large orifice", rates[3] / rates[2], 0.75, 1},
         {"largest change of a rate between the halves of its time", unsteady, 0, 0.15},
         {"grains inside and removed, less the initial ones", balance, 0, 0}}};
}

const bool registered_silo = io::Registry<Validation>::add(
    {.name = "comparison-silo",
     .description = "grains in a silo that empties, over time (comparison of ten codes, case 1)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
