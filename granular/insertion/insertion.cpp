// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/insertion/insertion.hpp"

#include "granular/insertion/obstacles.hpp"
#include "io/archive.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Mass of a sphere as the world stores it: its inverse in single precision [kg]
double stored_mass(double radius, double density)
{
    return 1 / static_cast<double>(static_cast<float>(1 / sphere_mass(radius, density)));
}

}  // namespace

double InsertionSpec::due(double t, double since) const
{
    const double time = std::min(t, to) - std::max(from, since);
    if (!(time >= 0)) return 0;
    if (mass_rate > 0) return mass_rate * time;
    // a number that is whole up to rounding errors is whole
    return rate > 0 ? std::floor(rate * time * (1 + 1e-12) + 1e-9) : static_cast<double>(count);
}

double InsertionSpec::largest_count(double t) const
{
    const double mean_mass = 4. / 3 * M_PI * density * sizes.mean_cube();
    const double number = mass_rate > 0 ? 1.05 * due(t) / mean_mass + 100 : due(t);
    return std::min(number, static_cast<double>(count));
}

Particle InsertionSpec::particle(double radius) const
{
    Particle p;
    p.radius = radius, p.material = material, p.replica = replica, p.v = v;
    return p;
}

std::vector<Particle> InsertionSpec::samples() const
{
    constexpr int number = 64;
    std::vector<Particle> all = {particle(sizes.least())};
    for (int k = 0; k < number; ++k) all.push_back(particle(sizes.quantile((k + 0.5) / number)));
    all.push_back(particle(sizes.largest()));
    return all;
}

Insertion::Insertion(const InsertionSpec& of) : spec(of) { state.random = spec.seed; }

double Insertion::due(const InsertionSpec& of, double t) const
{
    const double earlier = of.mass_rate > 0 ? base.mass : static_cast<double>(base.count);
    if (!of.active) return base.is_set ? earlier : 0;
    if (!base.is_set || (of.rate == 0 && of.mass_rate == 0)) return of.due(t);
    return earlier + of.due(t, base.t);
}

void Insertion::restart(double t)
{
    if (spec.rate == before.rate && spec.mass_rate == before.mass_rate && spec.active == before.active)
        return;
    Base now{true, t, state.count, state.mass};
    if (before.mass_rate > 0)
        now.mass = std::max(now.mass, due(before, t));
    else if (before.rate > 0)
        now.count = std::max(now.count, static_cast<std::int64_t>(due(before, t)));
    base = now;
}

bool Insertion::is_due(const State& now, double t) const
{
    if (now.count >= spec.count) return false;
    if (spec.mass_rate == 0) return static_cast<double>(now.count) < due(spec, t);
    // the inserted mass is the closest one to that which is due
    return now.mass + stored_mass(now.radius, spec.density) / 2 <= due(spec, t);
}

void Insertion::set_flow(const InsertionSpec& of)
{
    before = spec;
    spec.rate = of.rate, spec.mass_rate = of.mass_rate, spec.to = of.to;
    spec.v = of.v, spec.random_v = of.random_v, spec.active = of.active;
}

void Insertion::transfer_base(io::Archive& a)
{
    auto is_set = static_cast<std::uint64_t>(base.is_set);
    a.value(is_set), a.value(base.t), a.value(base.count), a.value(base.mass);
    base.is_set = is_set != 0;
    a.check(is_set <= 1 && std::isfinite(base.t) && std::isfinite(base.mass) && base.count >= 0,
            io::formatted("invalid restart of the insertion '%s', got t = %g s, %lld particles of %g kg",
                          spec.name.c_str(), base.t, static_cast<long long>(base.count), base.mass));
}

void Insertion::throw_blocked(const State& now, double t) const
{
    throw InsertionBlocked(io::formatted(
        "insertion '%s': no place for a particle of radius %.9g m in its region, a %s, in %lld tries from t "
        "= %.9g s to "
        "t = %.9g s; it has inserted %lld particles",
        spec.name.c_str(), now.radius, spec.region.description().c_str(), static_cast<long long>(now.tries),
        now.blocked_since, t, static_cast<long long>(now.count)));
}

std::optional<std::uint32_t> Insertion::before_step(World& world)
{
    const long steps = world.steps() - spec.first_step;
    if (steps < 0 || steps % spec.interval != 0) return {};
    const double t = world.t();
    State now = state;
    Random random(now.random);
    const auto draw = [&] {
        if (now.radius == 0) now.radius = spec.sizes.draw(random);
    };
    draw();
    std::vector<Particle> placed;
    if (is_due(now, t)) {
        const double R = spec.sizes.largest();
        const auto [low, high] = spec.region.bounds(R);
        Obstacles obstacles(world, low, high, R, spec.replica);
        for (bool has_place = true; has_place && is_due(now, t); draw()) {
            Particle p = spec.particle(now.radius);
            has_place = false;
            for (long k = 0; k < InsertionSpec::tries_at_once && !has_place; ++k) {
                p.r = spec.region.centre(p.radius, random);
                has_place = !obstacles.touches(p.r, p.radius);
                if (!has_place && now.tries++ == 0) now.blocked_since = t;
            }
            if (!has_place) {
                if (!spec.postpones || now.tries >= spec.most_tries) throw_blocked(now, t);
                break;
            }
            p.v += spec.random_v * random.direction();
            obstacles.add(p.r, p.radius);
            placed.push_back(p);
            now.mass += stored_mass(p.radius, spec.density);
            ++now.count, now.radius = 0, now.tries = 0;
        }
    }
    now.random = random.state;
    std::optional<std::uint32_t> first;
    for (const Particle& p : placed) {
        const std::uint32_t id = world.add(p);
        if (!first) first = id;
    }
    state = now;
    return first;
}

void Insertion::transfer(io::Archive& a)
{
    a.value(state);
    a.check(state.count >= 0 && state.count <= spec.count && std::isfinite(state.mass) && state.mass >= 0 &&
                state.tries >= 0 && std::isfinite(state.blocked_since) &&
                (state.radius == 0 ||
                 (state.radius >= spec.sizes.least() && state.radius <= spec.sizes.largest())),
            io::formatted(
                "invalid state of the insertion '%s', got %lld particles of %g kg, the next radius %g m, "
                "%lld tries since %g s",
                spec.name.c_str(), static_cast<long long>(state.count), state.mass, state.radius,
                static_cast<long long>(state.tries), state.blocked_since));
}

std::int64_t Insertions::count() const
{
    std::int64_t sum = 0;
    for (const Insertion& i : all) sum += i.count();
    return sum;
}

double Insertions::mass() const
{
    double sum = 0;
    for (const Insertion& i : all) sum += i.mass();
    return sum;
}

void Insertions::start(World& world, double t)
{
    for (const Insertion& i : all)
        world.expect(i.what().samples(), static_cast<std::size_t>(std::min(i.what().largest_count(t), 4e9)));
    world.before_each_step([this](World& w) {
        for (Insertion& i : all)
            if (const std::optional<std::uint32_t> first = i.before_step(w); first && groups != nullptr)
                groups->add(*first, i.what().group);
    });
}

bool Insertions::is_restarted() const
{
    return std::any_of(all.begin(), all.end(), [](const Insertion& i) { return i.is_restarted(); });
}

void Insertions::transfer_bases(io::Archive& a)
{
    for (Insertion& i : all) i.transfer_base(a);
}

void Insertions::transfer(io::Archive& a)
{
    for (Insertion& i : all) i.transfer(a);
}

}  // namespace hilda::granular
