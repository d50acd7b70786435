// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hilda::granular {

namespace {

constexpr double R = 0.05, density = 7800, g = 9.81, half_width = lattice::widest * R;
/// Initial gap between layers, over R. The results do not depend on it from 0.1 on. If the layers touch at
/// the start, the friction forces after settling depend on the gap, and with them the force at the middle for
/// μ = 0.2.
constexpr double initial_gap = 0.2;
const double m = 4. / 3 * M_PI * R * R * R * density;

/// Damping coefficient [1/s]. With the value of the dissertation, 5e4 1/s, a linear contact relaxes in 0.04 s
/// and the lattice in some seconds. The linear law uses 2500 1/s instead, the value of the scaled law at
/// √(δ/R) = 0.05. The static forces do not depend on the damping.
float damping_of(Stiffness s) { return s == Stiffness::scaled ? 5e4f : 2500.f; }

PairLaw law(Stiffness s, double mu, bool wall)
{
    const double k = (s == Stiffness::scaled ? 30000 : 3000) * m * g / R;
    const float k_n = static_cast<float>(wall ? 2 * k : k), gamma = damping_of(s);
    PairLaw law;
    if (s == Stiffness::scaled)
        law.normal = ScaledHooke{.k_n = k_n, .gamma_n = gamma};
    else
        law.normal = Hooke{.k_n = k_n, .gamma_n = gamma};
    const auto bound = static_cast<float>(mu);
    if (mu > 0)
        law.tangential =
            Mindlin{.spring = {.k_t = static_cast<float>(0.8 * k), .c = 0, .gamma_t = 0.8f * gamma},
                    .cap = {bound, bound}};
    return law;
}

class Lattices {
public:
    Lattices(const std::vector<LoadCase>& all, const LatticeRun& run) : all(all), world(make_world(all, run))
    {
        floor = world.add(Boundary{.material = walls});
        world.add(Boundary{.r = {-half_width, 0, 0}, .axis = {1, 0, 0}, .material = walls});
        world.add(Boundary{.r = {half_width, 0, 0}, .axis = {-1, 0, 0}, .material = walls});
        Particle p;
        p.radius = R, p.mass = m;
        for (std::size_t n = 0; n < all.size(); ++n) {
            p.replica = static_cast<std::uint16_t>(n);
            p.material = materials.at({all[n].stiffness, all[n].mu});
            for (int row = 0; row < lattice::rows; ++row) {
                const int count = lattice::widest - row % 2;
                for (int k = 0; k < count; ++k) {
                    p.r = {R * (2 * k - (count - 1)), 0, R + row * (std::sqrt(3.) + initial_gap) * R};
                    world.add(p);
                }
            }
        }
    }

    /// Id of the loaded sphere of a lattice, the middle one of the top layer
    static std::uint32_t pressed(std::size_t n)
    {
        return static_cast<std::uint32_t>(n * lattice::spheres + lattice::spheres - 1 - lattice::middle);
    }

    void apply_load(double part)
    {
        for (std::size_t n = 0; n < all.size(); ++n)
            world.set_force(pressed(n), {0, 0, -part * all[n].F * m * g});
    }

    std::vector<LatticeResponse::BoundaryForces> boundary_forces() const
    {
        std::vector<LatticeResponse::BoundaryForces> at(all.size());
        for (const ContactRecord& c : world.contacts()) {
            if (!c.boundary) continue;
            LatticeResponse::BoundaryForces& of = at[c.replica];
            const std::uint32_t k = c.i % lattice::spheres;
            const bool on_floor = static_cast<int>(c.j) == floor;
            (on_floor ? k < of.floor.size() ? of.floor[k] : of.upper_layers : of.sides) += c.F.z / (m * g);
        }
        for (const Particle& p : world.particles())
            at[p.replica].kinetic += 0.5 * (p.v.dot(p.v) + 0.4 * R * R * p.omega.dot(p.omega)) / (g * R);
        return at;
    }

    std::vector<double> heights() const
    {
        const std::vector<Particle> now = world.particles();
        std::vector<double> z(all.size());
        for (std::size_t n = 0; n < all.size(); ++n) z[n] = now[pressed(n)].r.z;
        return z;
    }

    World& get() { return world; }

private:
    World make_world(const std::vector<LoadCase>& lattices, const LatticeRun& run)
    {
        for (const LoadCase& p : lattices)
            materials.try_emplace({p.stiffness, p.mu}, static_cast<int>(materials.size()));
        walls = static_cast<int>(materials.size());
        WorldOptions options;
        options.low = {-half_width - R, -2 * R, -R}, options.high = {half_width + R, 2 * R, 32 * R};
        options.gravity = {0, 0, -g}, options.h = run.h, options.device = run.device;
        World world(options, std::vector<Material>(materials.size() + 1, {"sphere", density, 1e7, 0.3}));
        for (const auto& [of, k] : materials) {
            for (int other = 0; other <= k; ++other) world.set_law(k, other, law(of.first, of.second, false));
            world.set_law(k, walls, law(of.first, of.second, true));
        }
        return world;
    }

    const std::vector<LoadCase>& all;
    std::map<std::pair<Stiffness, double>, int> materials;
    int walls = 0, floor = 0;
    World world;
};

}  // namespace

std::array<double, lattice::widest> LatticeResponse::share(double F) const
{
    std::array<double, lattice::widest> of{};
    for (int k = 0; k < lattice::widest; ++k) of[k] = (after.floor[k] - before.floor[k]) / F;
    return of;
}

std::vector<LatticeResponse> run_lattices(const std::vector<LoadCase>& all, const LatticeRun& run,
                                          const std::function<void(double)>& progress)
{
    Lattices lattices(all, run);
    World& world = lattices.get();
    const double end = run.settle + run.ramp + run.hold;
    double begin = std::nan("");  // of the load; NaN before
    std::vector<LatticeResponse::BoundaryForces> before;
    std::vector<double> high;
    const auto more = [&](io::Archive& a) { a.value(begin), a.list(before), a.list(high); };
    run.kept.load([&](const std::string& bytes, const std::string& file) {
        world.from_bytes(bytes, "lattices", file, more);
    });
    // The neighbour list is rebuilt at each instant, also if the state is not kept: the results do not depend
    // on it.
    const auto instant = [&] { return std::floor(world.t() / end * 20 + 1e-9); };
    double last = instant();
    const auto step_to = [&](double t) {
        while (world.t() < t - 0.5 * run.h) {
            const double interval = std::min(t, world.t() + end / 200) - world.t();
            world.step(std::max(1L, std::lround(interval / run.h)));
            progress(world.t() / end);
            if (instant() == last) continue;
            last = instant();
            run.kept.save(world.to_bytes("lattices", more));
        }
    };
    if (std::isnan(begin)) {
        step_to(run.settle);
        before = lattices.boundary_forces(), high = lattices.heights();
        begin = world.t();
    }
    world.before_each_step([&](World& w) {
        const double part = (w.t() - begin) / run.ramp;
        if (part < 1 + run.h / run.ramp) lattices.apply_load(std::min(part, 1.));
    });
    step_to(end);
    run.ended(world);
    const std::vector<LatticeResponse::BoundaryForces> after = lattices.boundary_forces();
    const std::vector<double> low = lattices.heights();
    std::vector<LatticeResponse> pressed(all.size());
    for (std::size_t n = 0; n < all.size(); ++n)
        pressed[n] = {.before = before[n], .after = after[n], .displacement = (high[n] - low[n]) / R};
    return pressed;
}

}  // namespace hilda::granular
