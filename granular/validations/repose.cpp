// SPDX-License-Identifier: GPL-3.0-or-later
/// Angle of repose of a heap on a plate of finite width.
///
/// Grains settle on a rough plate between two smooth walls at its edges. The walls sink slowly until their
/// upper edges are at the height of the plate. The grains above flow over them and leave. A heap with two
/// flanks remains, whose foot is the edge of the plate. The plate is a layer of fixed grains. The set-up is
/// periodic along y, so that no wall carries the heap.

#include "granular/validations/repose.hpp"

#include "granular/backend/split_mix.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, restitution = 0.7, eta_r = 0.3, spread = 0.15;
constexpr double settled_energy = 1e-2, resting_energy = 3e-5;  ///< largest ones per grain [m g R]
constexpr double longest_settling = 2, longest_rest = 10;       // [s]

enum MaterialNumber { grain, wall };

Material glass(const Heap& heap) { return {"glass", 2500, heap.E, 0.24}; }

/// The plate at z = 0 with its walls
struct Plate {
    World world;
    Heap heap;
    int walls = 0;

    Plate(const Heap& heap, Device device)
        : world(options(heap, device), {glass(heap), glass(heap)}), heap(heap)
    {
        PairLaw law = hertz_mindlin(glass(heap), restitution, heap.mu);
        law.rolling = Epsd{.mu_r = static_cast<float>(heap.mu_r), .eta_r = static_cast<float>(eta_r)};
        world.set_law(grain, grain, law);
        world.set_law(grain, wall, hertz_mindlin(glass(heap), restitution));
        const double beyond = heap.period() / 2 + heap.d;
        Boundary b;
        b.shape = Boundary::Shape::mesh, b.material = wall;
        walls = world.add(b,
                          box_mesh({-heap.edge(), -beyond, -heap.d}, {heap.edge(), beyond, top(heap)},
                                   {false, false, true, true, true, true}, true, 0),
                          true);
    }

    /// Upper edges of the walls while the grains settle, and of the domain [m]
    static double top(const Heap& heap) { return 2.5 * heap.height * heap.d; }

    static WorldOptions options(const Heap& heap, Device device)
    {
        const double side = heap.edge() + 3 * heap.d, half = heap.period() / 2;
        WorldOptions o;
        o.low = {-side, -half, -1.5 * heap.d}, o.high = {side, half, top(heap)};
        o.periodic[1] = true, o.outflow = {true, true, false, false, true, false};
        o.skin = 0.2, o.gravity = {0, 0, -g}, o.h = heap.h, o.device = device;
        return o;
    }

    /// Fixed grains in rows along y, a hexagonal lattice with random displacements
    void add_plate(Random& random)
    {
        const double d = heap.d, free = 0.1 * d;
        const auto across = static_cast<int>(heap.length / 1.25), along = static_cast<int>(heap.width / 1.08);
        const double pitch = heap.period() / across, row = (2 * heap.edge() - d) / (along - 1);
        for (int i = 0; i < along; ++i)
            for (int j = 0; j < across; ++j) {
                Particle p;
                p.radius = d / 2, p.fixed = true;
                p.r = {i * row + d / 2 - heap.edge() + random.number(-free, free),
                       (j + 0.25 + 0.5 * (i % 2)) * pitch - heap.period() / 2 + random.number(-free, free),
                       random.number(-free, free)};
                world.add(p);
            }
    }

    /// A loose lattice of grains with random displacements and velocities
    void fill(Random& random)
    {
        constexpr double packing = 0.6;
        const double d = heap.d, pitch = 1.06 * (1 + spread) * d;
        const auto count = static_cast<int>(
            std::lround(packing * heap.width * heap.length * heap.height / (std::numbers::pi / 6)));
        const auto along = static_cast<int>(2 * heap.edge() / pitch),
                   across = static_cast<int>(heap.period() / pitch);
        const auto in = [&](double most) { return random.number(-most, most); };
        for (int k = 0; k < count; ++k) {
            const int layer = k / (along * across), i = k % along, j = k / along % across;
            Particle p;
            p.radius = d / 2 * (1 + in(spread));
            p.r = {((i + 0.5) / along * 2 - 1) * heap.edge() + in(0.02 * d),
                   (j + 0.5) / across * heap.period() - heap.period() / 2 + in(0.02 * d),
                   1.3 * d + layer * pitch + in(0.02 * d)};
            p.v = {in(0.2), in(0.2), in(0.2)};
            world.add(p);
        }
    }

    /// Mass of the grains that are not fixed [kg]
    double mass() const
    {
        double sum = 0;
        world.each_particle([&](const Particle& p) { sum += p.fixed ? 0 : p.mass; });
        return sum;
    }

    Settling until(const std::string& what, double longest, double energy) const
    {
        return {.what = what, .interval = std::lround(0.01 / heap.h), .longest = longest, .energy = energy};
    }

    /// The walls sink from the highest grain until their upper edges are at z = 0.
    void open(const std::function<void(double)>& progress)
    {
        constexpr int parts = 50;
        const double highest = highest_point(world.particles());
        const long steps = std::lround(highest / heap.speed / heap.h / parts);
        world.boundary(walls).r.z = highest - top(heap);
        world.boundary(walls).v.z = -highest / (static_cast<double>(steps) * parts * heap.h);
        for (int k = 1; k <= parts; ++k) world.step(steps), progress(static_cast<double>(k) / parts);
        world.boundary(walls).v = {0, 0, 0};
    }
};

}  // namespace

HeapSurface surface_of(const std::vector<BedSphere>& spheres, const Heap& heap)
{
    const double half = heap.period() / 2;
    const auto count = [&](double length) { return static_cast<int>(std::lround(length / (heap.d / 4))); };
    const int nx = count(2 * heap.edge()), ny = count(heap.period());
    const double dx = 2 * heap.edge() / nx, dy = heap.period() / ny;
    const auto index = [ny](int i, int j) {
        return static_cast<std::size_t>(i) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(j);
    };
    std::vector<double> highest(index(nx, 0), 0);
    for (const BedSphere& s : spheres) {
        const auto first = [](double x, double step) { return static_cast<int>(std::ceil(x / step - 0.5)); };
        const double x = s.r.x + heap.edge(), y = s.r.y + half, R = s.radius;  // from the first corner
        for (int i = std::max(0, first(x - R, dx)); i < std::min(nx, first(x + R, dx)); ++i)
            for (int j = first(y - R, dy); j < first(y + R, dy); ++j) {
                const double a = (i + 0.5) * dx - x, b = (j + 0.5) * dy - y, c = R * R - a * a - b * b;
                double& z = highest[index(i, ((j % ny) + ny) % ny)];
                if (c > 0) z = std::max(z, s.r.z + std::sqrt(c));
            }
    }
    HeapSurface out;
    for (int i = 0; i < nx; ++i) {
        double sum = 0;
        for (int j = 0; j < ny; ++j) sum += highest[index(i, j)];
        out.x.push_back((i + 0.5) * dx - heap.edge()), out.z.push_back(sum / ny);
    }
    return out;
}

FlankAngles flank_angles(const HeapSurface& surface, const Heap& heap)
{
    FlankAngles out{.r2 = 1};
    for (const double side : {-1., 1.}) {
        std::vector<double> x, z;
        for (std::size_t k = 0; k < surface.x.size(); ++k) {
            const double outwards = side * surface.x[k] / heap.edge();
            if (outwards > 0.2 && outwards < 0.8) x.push_back(surface.x[k]), z.push_back(surface.z[k]);
        }
        const StraightLine line(x, z);
        (side < 0 ? out.left : out.right) = -side * std::atan(line.b) * 180 / std::numbers::pi;
        out.r2 = min_or_nan(out.r2, line.r2);
    }
    return out;
}

RestingHeap resting_heap(const Heap& heap, const ValidationOptions& options,
                         const std::function<void(double)>& progress)
{
    Plate plate(heap, options.device);
    World& world = plate.world;
    Random random(static_cast<std::uint64_t>(heap.seed));
    plate.add_plate(random), plate.fill(random);
    world.step(0);
    const double initial = plate.mass();
    settle(world, plate.until("the bed between the walls", longest_settling, settled_energy),
           [&](double share) { progress(0.3 * share); });
    plate.open([&](double share) { progress(0.3 + 0.6 * share); });
    settle(world, plate.until("the heap", longest_rest, resting_energy), [](double) {});
    progress(1);
    RestingHeap out;
    out.balance = (plate.mass() + world.outflow().mass - initial) / initial;
    world.each_particle([&](const Particle& p) {
        out.spheres.push_back({p.r, p.radius});
        if (!p.fixed) out.grains += 1;
    });
    options.include(io::formatted("mu = %g, mu_r = %g, seed %d", heap.mu, heap.mu_r, heap.seed), world);
    return out;
}

namespace {

/// Heaps with equal parameters and different seeds
struct Heaps {
    Heap of;
    int seeds = 0;
    std::vector<FlankAngles> angles = {};  ///< by seed
    double grains = 0, balance = 0, r2 = 1;

    double mean() const
    {
        double sum = 0;
        for (const FlankAngles& a : angles) sum += a.mean() / static_cast<double>(angles.size());
        return sum;
    }
    /// Variance of the mean angle of the two flanks, over the seeds
    double variance() const
    {
        double sum = 0;
        for (const FlankAngles& a : angles) sum += (a.mean() - mean()) * (a.mean() - mean());
        return sum / static_cast<double>(angles.size() - 1);
    }
    /// Standard error of the mean of all flanks
    double error() const
    {
        double sum = 0;
        const double n = 2 * static_cast<double>(angles.size());
        for (const FlankAngles& a : angles)
            for (const double flank : {a.left, a.right}) sum += (flank - mean()) * (flank - mean());
        return std::sqrt(sum / (n - 1) / n);
    }
};

constexpr double mu_reference = 0.5, mu_r_reference = 0.05;

/// The values of mu at one mu_r, then those of mu_r at one mu; in the full grid also the reference with walls
/// that sink at a quarter of the speed, and with ten times E
std::vector<Heaps> all_heaps(bool full)
{
    Heap heap;
    if (full) heap.width = 60, heap.height = 18;
    std::vector<Heaps> all;
    const auto add = [&](double mu, double mu_r) {
        heap.mu = mu, heap.mu_r = mu_r;
        all.push_back({heap, full ? 5 : 3});
    };
    for (const double mu : full ? std::vector{0.1, 0.2, 0.3, 0.5, 0.8} : std::vector{0.1, 0.3, 0.5})
        add(mu, mu_r_reference);
    for (const double mu_r : full ? std::vector{0., 0.02, 0.1, 0.2} : std::vector{0., 0.1})
        add(mu_reference, mu_r);
    if (full) {
        add(mu_reference, mu_r_reference);
        all.back().of.speed /= 4;
        add(mu_reference, mu_r_reference);
        all.back().of.E *= 10, all.back().of.h /= std::sqrt(10);
    }
    return all;
}

std::vector<ValidationCheck> checks(const std::vector<Heaps>& all)
{
    double variance = 0, balance = 0, least_r2 = 1;
    std::map<double, double> over_mu, over_mu_r;
    std::vector<ValidationCheck> out;
    const Heap standard = all.front().of;
    for (const Heaps& h : all) {
        variance += h.variance() / static_cast<double>(all.size());
        balance = max_or_nan(balance, h.balance), least_r2 = min_or_nan(least_r2, h.r2);
        if (h.of.speed != standard.speed || h.of.E != standard.E) continue;
        if (h.of.mu_r == mu_r_reference) over_mu[h.of.mu] = h.mean();
        if (h.of.mu == mu_reference) over_mu_r[h.of.mu_r] = h.mean();
    }
    const double spread = std::sqrt(variance), reference = over_mu.at(mu_reference);
    const auto steps = [&](const char* name, const std::map<double, double>& angles) {
        for (auto to = std::next(angles.begin()); to != angles.end(); ++to) {
            const auto from = std::prev(to);
            out.push_back(
                {io::formatted("angle at %s = %g less that at %g [spread]", name, to->first, from->first),
                 (to->second - from->second) / spread, 1, no_bound});
        }
    };
    steps("mu", over_mu), steps("mu_r", over_mu_r);
    out.push_back({"standard deviation of the angle over the seeds [deg]", spread, 0, 1.5});
    out.push_back({"angle at mu = 0.5, mu_r = 0 [deg]", over_mu_r.at(0), 22, 28});
    for (const Heaps& h : all) {
        if (h.of.speed != standard.speed)
            out.push_back(
                {"angle with slow walls less the other [spread]", (h.mean() - reference) / spread, -1, 1});
        if (h.of.E != standard.E)
            out.push_back(
                {"angle with ten times E less the other [spread]", (h.mean() - reference) / spread, -1, 1});
    }
    out.push_back({"smallest coefficient of determination of a flank", least_r2, 0.95, 1});
    out.push_back({"largest relative error of the mass balance", balance, 0, 1e-12});
    return out;
}

ValidationResult run(const ValidationOptions& options)
{
    std::vector<Heaps> all = all_heaps(options.full);
    double done = 0, parts = 0;
    for (const Heaps& h : all) parts += h.seeds;
    if (options.full)
        options.announce(io::formatted("%g heaps, about 30 minutes of CPU time in the preset native", parts));
    ValidationTable table{
        "study", {"mu", "mu_r", "speed", "E", "seeds", "angle", "error", "spread", "grains", "r2"}, {}},
        heaps{"heaps", {"mu", "mu_r", "speed", "E", "seed", "left", "right", "r2", "grains"}, {}},
        surface{"surface", {"mu", "mu_r", "speed", "E", "seed", "x", "z"}, {}},
        spheres{"spheres", {"mu", "mu_r", "speed", "E", "seed", "x", "z", "radius"}, {}};
    std::vector<Heap> heaps_of;
    for (const Heaps& h : all)
        for (int seed = 1; seed <= h.seeds; ++seed) heaps_of.push_back(h.of), heaps_of.back().seed = seed;
    std::vector<RestingHeap> resting(heaps_of.size());
    const auto compute = [&](long k) {
        resting[static_cast<std::size_t>(k)] =
            resting_heap(heaps_of[static_cast<std::size_t>(k)], options,
                         [&](double share) { options.progress((done + share) / parts); });
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(heaps_of.size()), compute, [&](io::Archive& a, long k) {
        RestingHeap& one = resting[static_cast<std::size_t>(k)];
        a.list(one.spheres), a.value(one.grains), a.value(one.balance);
    });
    auto next = resting.cbegin();
    for (Heaps& h : all) {
        for (h.of.seed = 1; h.of.seed <= h.seeds; ++h.of.seed) {
            const RestingHeap& one = *next++;
            const HeapSurface s = surface_of(one.spheres, h.of);
            const FlankAngles a = flank_angles(s, h.of);
            h.angles.push_back(a);
            h.grains += one.grains / h.seeds, h.r2 = min_or_nan(h.r2, a.r2);
            h.balance = max_or_nan(h.balance, std::abs(one.balance));
            const double seed = h.of.seed;
            heaps.rows.push_back(
                {h.of.mu, h.of.mu_r, h.of.speed, h.of.E, seed, a.left, a.right, a.r2, one.grains});
            for (std::size_t k = 0; k < s.x.size(); ++k)
                surface.rows.push_back({h.of.mu, h.of.mu_r, h.of.speed, h.of.E, seed, s.x[k], s.z[k]});
            if (h.of.mu_r == mu_r_reference)
                for (const BedSphere& p : one.spheres)
                    if (h.of.seed == 1 && std::abs(p.r.y) < h.of.d / 2)
                        spheres.rows.push_back(
                            {h.of.mu, h.of.mu_r, h.of.speed, h.of.E, seed, p.r.x, p.r.z, p.radius});
        }
        table.rows.push_back({h.of.mu, h.of.mu_r, h.of.speed, h.of.E, static_cast<double>(h.seeds), h.mean(),
                              h.error(), std::sqrt(h.variance()), h.grains, h.r2});
    }
    return {{table, heaps, surface, spheres}, checks(all)};
}

const bool registered_repose = io::Registry<Validation>::add(
    {.name = "repose",
     .description = "angle of repose of a heap over the friction and the rolling resistance of its grains",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
