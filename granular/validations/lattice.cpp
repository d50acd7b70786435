// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/lattice.hpp"

#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace hilda::granular {

namespace {

constexpr double R = 0.05, density = 7800, g = 9.81, half_width = lattice::widest * R;
/// Initial gap between layers, over R. The results do not depend on it from 0.1 on. If the layers touch at
/// the start, the friction forces after settling depend on the gap, and with them the force at the middle for
/// μ = 0.2.
constexpr double initial_gap = 0.2;
const double m = sphere_mass(R, density);

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
        return at;
    }

    /// Kinetic energy of each lattice [m g R]
    std::vector<double> kinetic() const
    {
        std::vector<double> T(all.size(), 0);
        for (const Particle& p : world.particles())
            T[p.replica] += 0.5 * (p.v.dot(p.v) + 0.4 * R * R * p.omega.dot(p.omega)) / (g * R);
        return T;
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

namespace {

/// What a run needs besides the state of its world
struct RunState {
    enum Phase : std::int64_t { falls, settles, is_loaded, settles_again, is_done };
    std::int64_t phase = falls;
    double begin = 0;                    ///< of the phase [s]
    std::vector<double> previous;        ///< kinetic energies at the last interval [m g R]
    std::vector<double> settled;         ///< largest kinetic energy when it settled; NaN before
    std::vector<double> time_to_settle;  ///< in this phase [s]
    std::vector<LatticeResponse::BoundaryForces> before;
    std::vector<double> heights, first_time;  ///< of the loaded spheres; times of the first phase

    void transfer(io::Archive& a)
    {
        a.value(phase), a.value(begin), a.list(previous), a.list(settled), a.list(time_to_settle);
        a.list(before), a.list(heights), a.list(first_time);
    }
};

class SettlingRun {
public:
    SettlingRun(const std::vector<LoadCase>& all, const LatticeRun& run)
        : all(all), run(run), lattices(all, run), world(lattices.get()),
          interval(std::max(1L, std::lround(run.interval / run.h)))
    {}

    std::vector<LatticeResponse> compute(const std::function<void(double)>& progress)
    {
        const auto more = [&](io::Archive& a) { state.transfer(a); };
        run.kept.load([&](const std::string& bytes, const std::string& file) {
            world.from_bytes(bytes, "lattices", file, more);
        });
        world.before_each_step([&](World& w) {
            const double part = (w.t() - state.begin) / run.ramp;
            if (state.phase == RunState::is_loaded) lattices.apply_load(std::min(part, 1.));
        });
        while (state.phase != RunState::is_done) {
            world.step(interval);
            const double in_phase = world.t() - state.begin;
            progress((static_cast<double>(state.phase) + std::min(in_phase / run.longest, 1.)) / 4);
            if (advance_phase(in_phase)) state.begin = world.t(), ++state.phase;
            // The neighbour list is rebuilt also if the state is not kept: the results do not depend on it.
            if (world.steps() % (interval * run.save_every) == 0)
                run.kept.save(world.to_bytes("lattices", more));
        }
        run.ended(world);
        return response();
    }

private:
    /// Whether the phase has ended
    bool advance_phase(double in_phase)
    {
        switch (state.phase) {
            case RunState::falls:
                return in_phase > run.fall - 0.5 * run.h;
            case RunState::is_loaded:
                if (in_phase < run.ramp - 0.5 * run.h) return false;
                lattices.apply_load(1);
                return true;
            default:
                if (!settle(in_phase)) return false;
                if (state.phase == RunState::settles) {
                    state.before = boundary_forces(), state.heights = lattices.heights();
                    state.first_time = state.time_to_settle;
                    state.previous.clear();
                }
                return true;
        }
    }

    bool settle(double in_phase)
    {
        const std::vector<double> T = lattices.kinetic();
        if (state.previous.empty()) {
            state.previous = T;
            state.settled.assign(all.size(), std::nan("")), state.time_to_settle.assign(all.size(), 0);
            return false;
        }
        bool done = true;
        for (std::size_t n = 0; n < all.size(); ++n) {
            const double largest = std::exchange(state.previous[n], T[n]);
            if (std::isnan(state.settled[n]) && T[n] <= largest) {
                if (largest < run.kinetic) {
                    state.settled[n] = largest, state.time_to_settle[n] = in_phase;
                } else {
                    world.stop(static_cast<std::uint16_t>(n));
                    state.previous[n] = 0;
                }
            }
            if (!std::isnan(state.settled[n])) continue;
            done = false;
            if (in_phase > run.longest)
                throw io::NumericalFailure(
                    "not_settled",
                    io::formatted("lattice %zu (mu = %g, F = %g mg) has not settled after %g s: its kinetic "
                                  "energy is %.3g m g R, and %g is allowed",
                                  n, all[n].mu, all[n].F, run.longest, largest, run.kinetic));
        }
        return done;
    }

    std::vector<LatticeResponse::BoundaryForces> boundary_forces() const
    {
        std::vector<LatticeResponse::BoundaryForces> at = lattices.boundary_forces();
        for (std::size_t n = 0; n < all.size(); ++n) at[n].kinetic = state.settled[n];
        return at;
    }

    std::vector<LatticeResponse> response() const
    {
        const std::vector<LatticeResponse::BoundaryForces> after = boundary_forces();
        const std::vector<double> low = lattices.heights();
        std::vector<LatticeResponse> pressed(all.size());
        for (std::size_t n = 0; n < all.size(); ++n)
            pressed[n] = {.before = state.before[n],
                          .after = after[n],
                          .settled = state.first_time[n],
                          .held = state.time_to_settle[n],
                          .displacement = (state.heights[n] - low[n]) / R};
        return pressed;
    }

    const std::vector<LoadCase>& all;
    const LatticeRun& run;
    Lattices lattices;
    World& world;
    const long interval;
    RunState state;
};

}  // namespace

std::vector<LatticeResponse> run_lattices(const std::vector<LoadCase>& all, const LatticeRun& run,
                                          const std::function<void(double)>& progress)
{
    return SettlingRun(all, run).compute(progress);
}

}  // namespace hilda::granular
