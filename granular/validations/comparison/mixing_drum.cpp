// SPDX-License-Identifier: GPL-3.0-or-later
/// Drum with grains of two sizes (Dosta et al. 2024, Comput. Phys. Commun. 296, 109066, case 2).
///
/// A drum of radius 100 mm and width 60 mm has 8000 grains M2 of diameter 4 mm, and above them 30 000 grains
/// M1 of diameter 2 mm. It rotates with 2 rad/s. The published result is the number of grains of each kind
/// in two quadrants over 5 s. The published start positions are not used: the grains fall from a loose
/// lattice and settle before the drum rotates.
///
/// In the mean over a long time the torque of the grains on the drum is the moment of their weight about the
/// axis. The work of the drum is the gain of energy of the grains and what the contacts dissipate.

#include "granular/validations/comparison/mixing_drum.hpp"

#include "granular/validations/settling.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, radius = 0.1, width = 0.06;
constexpr long loads_per_sample = 20;

struct DrumWorld {
    World world;
    std::vector<int> walls = {};

    DrumWorld(const MixingDrum& d, Device device) : world(options(d, device), bulk_materials(d.scale))
    {
        set_bulk_laws(world, d.scale);
        Boundary b;
        b.material = steel;
        b.axis = {0, 1, 0}, b.r = {0, -width / 2, 0}, walls.push_back(world.add(b));
        b.axis = {0, -1, 0}, b.r = {0, width / 2, 0}, walls.push_back(world.add(b));
        b.shape = Boundary::Shape::cylinder, b.inside = 1, b.radius = radius, b.r = {0, 0, 0};
        walls.push_back(world.add(b));
    }

    static WorldOptions options(const MixingDrum& d, Device device)
    {
        const double side = radius + d.radius(M1), half = width / 2 + d.radius(M1);
        WorldOptions o;
        o.low = {-side, -half, -side}, o.high = {side, half, side};
        o.gravity = {0, 0, -g}, o.h = d.h(), o.device = device;
        return o;
    }

    void rotate(double omega)
    {
        for (const int b : walls) world.boundary(b).omega = {0, -omega, 0};
    }

    void settle(double h, const std::function<void(double)>& progress)
    {
        granular::settle(world,
                         {.what = "the filling of the drum",
                          .interval = std::lround(0.01 / h),
                          .longest = 3,
                          .energy = 1e-2},
                         progress);
    }

    /// Torque of the grains on the drum about +y [N m]
    double torque() const
    {
        const std::vector<Wrench> on = world.totals().on_boundary;
        return std::accumulate(walls.begin(), walls.end(), 0.,
                               [&](double sum, int b) { return sum + on[static_cast<std::size_t>(b)].T.y; });
    }

    double energy() const
    {
        const World::Sums sums = world.sums();
        return sums.kinetic_energy + sums.potential_energy;
    }

    /// Moment of the weight of the grains about +y [N m]
    double moment_of_weight() const
    {
        double sum = 0;
        world.each_particle([&](const Particle& p) { sum += p.mass * g * p.r.x; });
        return sum;
    }
};

/// M2 below, M1 above
std::vector<Particle> loose_grains(const MixingDrum& d)
{
    Random random(1);
    std::vector<Particle> all;
    double low = -radius;
    for (const BulkMaterial material : {M2, M1}) {
        Particle p;
        p.radius = d.radius(material), p.material = material;
        const auto inside = [R = p.radius](const Vec3& r) {
            return std::hypot(r.x, r.z) < radius - 1.1 * R && std::abs(r.y) < width / 2 - 1.1 * R;
        };
        const std::vector<Particle> layers = loose_layers(p, d.number(material), low, radius, inside, random);
        all.insert(all.end(), layers.begin(), layers.end());
        low = highest_point(all);
    }
    return all;
}

/// `start`: time at which the drum began to rotate [s]
void add_sample(DrumMixing& out, const World& world, double start)
{
    double zone[2][2] = {}, mass[2] = {};
    Vec3 centre[2] = {{0, 0, 0}, {0, 0, 0}};
    world.each_particle([&](const Particle& p) {
        const int kind = p.material == M1 ? 0 : 1;
        if (p.r.x > 0 && p.r.z > 0) zone[0][kind] += 1;
        if (p.r.x < 0 && p.r.z < 0) zone[1][kind] += 1;
        mass[kind] += p.mass, centre[kind] += p.mass * p.r;
    });
    const Vec3 all = (1 / (mass[0] + mass[1])) * (centre[0] + centre[1]);
    out.t.push_back(world.t() - start);
    out.zone1_M1.push_back(zone[0][0]), out.zone1_M2.push_back(zone[0][1]);
    out.zone2_M1.push_back(zone[1][0]), out.zone2_M2.push_back(zone[1][1]);
    out.separation.push_back(((1 / mass[0]) * centre[0] - (1 / mass[1]) * centre[1]).norm() / radius);
    out.centre_angle.push_back(std::atan2(all.x, -all.z) * 180 / std::numbers::pi);
}

void add_slice(DrumMixing& out, const World& world, const MixingDrum& d)
{
    world.each_particle([&](const Particle& p) {
        if (std::abs(p.r.y) < d.radius(M2))
            out.slices.push_back({out.t.back(), p.r.x, p.r.z, p.radius, p.material});
    });
}

}  // namespace

DrumMixing drum_mixing(const MixingDrum& drum, const ValidationOptions& options,
                       const std::function<void(double)>& progress)
{
    DrumWorld now(drum, options.device);
    World& world = now.world;
    for (const Particle& p : loose_grains(drum)) world.add(p);
    const std::size_t grains = world.count();
    now.settle(drum.h(), [&](double share) { progress(0.1 * share); });
    now.rotate(drum.omega);
    const double start = now.energy(), settled = world.t();
    const long steps = std::lround(drum.sample / loads_per_sample / drum.h()),
               samples = std::lround(drum.time / drum.sample);
    DrumMixing out;
    add_sample(out, world, settled), add_slice(out, world, drum);
    for (long k = 0; k < samples; ++k) {
        double torque = 0, gravity = 0;
        for (long i = 0; i < loads_per_sample; ++i) {
            world.step(steps);
            torque += now.torque() / loads_per_sample, gravity += now.moment_of_weight() / loads_per_sample;
        }
        const double interval = world.t() - settled - out.t.back();
        out.work += drum.omega * torque * interval;
        out.torque.push_back(torque), out.gravity.push_back(gravity);
        add_sample(out, world, settled);
        progress(0.1 + 0.9 * static_cast<double>(k + 1) / static_cast<double>(samples));
        if (k + 1 == 3 * samples / 10 || k + 1 == samples) add_slice(out, world, drum);
    }
    out.gain = now.energy() - start;
    out.lost = static_cast<double>(grains) - static_cast<double>(world.count());
    options.include("drum", world);
    return out;
}

namespace {

/// Mean over the second half
double late(const std::vector<double>& values)
{
    const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
    return std::accumulate(values.begin() + half, values.end(), 0.) /
           static_cast<double>(values.end() - values.begin() - half);
}

ValidationResult run(const ValidationOptions& options)
{
    MixingDrum d;
    d.scale.softness = 500;
    if (!options.full) d.scale.size = 2;
    if (options.full)
        options.announce("a drum with 38 000 grains, about half an hour of CPU time in the preset native");
    DrumMixing m;
    options.kept.part([&] { m = drum_mixing(d, options, options.progress); },
                      [&](io::Archive& a) {
                          for (auto* column : {&m.t, &m.zone1_M1, &m.zone1_M2, &m.zone2_M1, &m.zone2_M2,
                                               &m.separation, &m.centre_angle, &m.torque, &m.gravity})
                              a.list(*column);
                          a.list(m.slices), a.value(m.work), a.value(m.gain), a.value(m.lost);
                      });
    options.progress(1);
    const auto of_M1 = static_cast<double>(d.number(M1)), of_M2 = static_cast<double>(d.number(M2)),
               all = of_M1 + of_M2;
    // The grains circulate, and the distance of the centres oscillates with them.
    const auto n = static_cast<std::ptrdiff_t>(m.separation.size());
    const double early =
                     std::accumulate(m.separation.begin(), m.separation.begin() + 2 * n / 5, 0., max_or_nan),
                 last = std::accumulate(m.separation.end() - 2 * n / 5, m.separation.end(), 0., max_or_nan);
    ValidationTable table{"study",
                          {"grains_M1", "grains_M2", "size", "softness", "zone1_M1", "zone1_M2", "zone2_M1",
                           "zone2_M2", "separation_early", "separation_late", "centre_angle", "torque",
                           "gravity", "work", "gain", "dissipated"},
                          {}},
        motion{"motion",
               {"t", "zone1_M1", "zone1_M2", "zone2_M1", "zone2_M2", "separation", "centre_angle"},
               {}};
    table.rows.push_back({of_M1, of_M2, d.scale.size, d.scale.softness, late(m.zone1_M1), late(m.zone1_M2),
                          late(m.zone2_M1), late(m.zone2_M2), early, last, late(m.centre_angle),
                          late(m.torque), late(m.gravity), m.work, m.gain, m.work - m.gain});
    for (std::size_t k = 0; k < m.t.size(); ++k)
        motion.rows.push_back({m.t[k], m.zone1_M1[k], m.zone1_M2[k], m.zone2_M1[k], m.zone2_M2[k],
                               m.separation[k], m.centre_angle[k]});
    ValidationTable grains{"grains", {"t", "x", "z", "radius", "material"}, {}};
    for (const DrumMixing::SliceGrain& p : m.slices)
        grains.rows.push_back({p.t, p.x, p.z, p.radius, p.material == M1 ? "M1" : "M2"});
    return {
        {table, motion, grains},
        {{"torque on the drum over the moment of the weight, second half", late(m.torque) / late(m.gravity),
          0.97, 1.03},
         {"share of the work of the drum that the contacts dissipate", 1 - m.gain / m.work, 0, 1},
         {"grains that are missing at the end", m.lost, 0, 0},
         {"share of the grains in zone 1 at the start", (m.zone1_M1[0] + m.zone1_M2[0]) / all, 0, 0.01},
         {"share of the grains in zone 2 at the start", (m.zone2_M1[0] + m.zone2_M2[0]) / all, 0.47, 0.53},
         {"largest distance of the centres of M1 and M2, after 0.6 of the time over that before 0.4",
          last / early, 0, 0.9}}};
}

const bool registered_mixing_drum = io::Registry<Validation>::add(
    {.name = "comparison-drum",
     .description = "mixing of grains of two sizes in a drum (comparison of ten codes, case 2)",
     .run = run});

}  // namespace

}  // namespace hilda::granular
