// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hilda::granular {

namespace {

constexpr double R = 0.05, density = 7800, g = 9.81, half_width = lattice::widest * R;
/// Of the layers at the start, over R. From 0.1 on the lattice forgets it; when they touch at the start, the friction that
/// the settling leaves in the contacts, and with it the middle at μ = 0.2, is another for each thousandth of R.
constexpr double apart = 0.2;
const double m = 4. / 3 * M_PI * R * R * R * density;

/// A linear contact with the damping of the text, 5e4 1/s, relaxes in 0.04 s, and the whole lattice in some seconds; what
/// the scaled one has of it at √(δ/R) = 0.05 is taken instead. Where things come to rest, damping says nothing.
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
    Lattices(const std::vector<Press>& all, const PressRun& run) : all(all), world(empty(all, run))
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
                    p.r = {R * (2 * k - (count - 1)), 0, R + row * (std::sqrt(3.) + apart) * R};
                    world.add(p);
                }
            }
        }
    }

    /// The pressed sphere of a lattice: the middle one of the top
    static std::uint32_t pressed(std::size_t n)
    {
        return static_cast<std::uint32_t>(n * lattice::spheres + lattice::spheres - 1 - lattice::middle);
    }

    void press_with(double part)
    {
        for (std::size_t n = 0; n < all.size(); ++n)
            world.set_force(pressed(n), {0, 0, -part * all[n].F * m * g});
    }

    std::vector<Pressed::At> look() const
    {
        std::vector<Pressed::At> at(all.size());
        for (const ContactRecord& c : world.contacts()) {
            if (!c.boundary) continue;
            Pressed::At& of = at[c.replica];
            const std::uint32_t k = c.i % lattice::spheres;
            const bool on_floor = static_cast<int>(c.j) == floor;
            (on_floor ? k < of.floor.size() ? of.floor[k] : of.others : of.sides) += c.F.z / (m * g);
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

    World& of() { return world; }

private:
    World empty(const std::vector<Press>& lattices, const PressRun& run)
    {
        for (const Press& p : lattices)
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

    const std::vector<Press>& all;
    std::map<std::pair<Stiffness, double>, int> materials;
    int walls = 0, floor = 0;
    World world;
};

}  // namespace

std::array<double, lattice::widest> Pressed::share(double F) const
{
    std::array<double, lattice::widest> of{};
    for (int k = 0; k < lattice::widest; ++k) of[k] = (after.floor[k] - before.floor[k]) / F;
    return of;
}

std::vector<Pressed> press(const std::vector<Press>& all, const PressRun& run,
                           const std::function<void(double)>& progress)
{
    Lattices lattices(all, run);
    World& world = lattices.of();
    const double end = run.settle + run.ramp + run.hold;
    const auto go_to = [&](double t) {
        while (world.t() < t - 0.5 * run.h) {
            const double way = std::min(t, world.t() + end / 200) - world.t();
            world.step(std::max(1L, std::lround(way / run.h)));
            progress(world.t() / end);
        }
    };
    go_to(run.settle);
    const std::vector<Pressed::At> before = lattices.look();
    const std::vector<double> high = lattices.heights();
    const double begin = world.t();
    world.before_each_step([&](World& w) {
        const double part = (w.t() - begin) / run.ramp;
        if (part < 1 + run.h / run.ramp) lattices.press_with(std::min(part, 1.));
    });
    go_to(end);
    const std::vector<Pressed::At> after = lattices.look();
    const std::vector<double> low = lattices.heights();
    std::vector<Pressed> pressed(all.size());
    for (std::size_t n = 0; n < all.size(); ++n)
        pressed[n] = {.before = before[n], .after = after[n], .sunk = (high[n] - low[n]) / R};
    return pressed;
}

}  // namespace hilda::granular
