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

/// The largest whole number up to x. A number that is whole up to rounding errors is whole.
double whole(double x) { return std::floor(x * (1 + 1e-12) + 1e-9); }

}  // namespace

bool InsertionFlow::has_values_of(const InsertionFlow& o) const
{
    return rate == o.rate && mass_rate == o.mass_rate && to == o.to && v == o.v && random_v == o.random_v &&
           active == o.active;
}

void InsertionFlow::transfer(io::Archive& a)
{
    auto is_active = static_cast<std::uint64_t>(active);
    a.value(rate), a.value(mass_rate), a.value(to), a.value(v), a.value(random_v), a.value(is_active);
    a.value(since), a.value(number), a.value(mass);
    active = is_active != 0;
    const auto is_amount = [](double x) { return x >= 0 && std::isfinite(x); };
    a.check(is_amount(rate) && is_amount(mass_rate) && !std::isnan(to) && finite(v) && is_amount(random_v) &&
                is_active <= 1 && is_amount(since) && std::isfinite(number) && std::isfinite(mass),
            io::formatted("invalid flow of an insertion, got %g particles/s, %g kg/s, since t = %g s, %g "
                          "particles and %g kg due until then",
                          rate, mass_rate, since, number, mass));
}

double InsertionSpec::due(const InsertionFlow& of, double t) const
{
    const double earlier = of.mass_rate > 0 ? of.mass : of.number,
                 time = std::min(t, of.to) - std::max(from, of.since);
    if (!of.active || !(time >= 0)) return earlier;
    if (of.mass_rate > 0) return earlier + of.mass_rate * time;
    return of.rate > 0 ? earlier + of.rate * time : static_cast<double>(count);
}

double InsertionSpec::mean_mass() const { return 4. / 3 * M_PI * density * sizes.mean_cube(); }

double InsertionSpec::largest_count(double t) const
{
    InsertionFlow of = flow;
    of.active = true;  // a change of the run can set it
    const double due = this->due(of, t),
                 number = flow.mass_rate > 0 ? 1.05 * due / mean_mass() + 100 : whole(due);
    return std::min(number, static_cast<double>(count));
}

Particle InsertionSpec::particle(double radius) const
{
    Particle p;
    p.radius = radius, p.material = material, p.replica = replica, p.v = flow.v;
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

void InsertionSpec::announce(World& world, std::size_t number) const
{
    if (!clumps) return world.expect(samples(), number);
    std::vector<double> scales;
    for (const Particle& p : samples()) scales.push_back(p.radius / clumps.radius);
    world.expect_clumps(clumps.shape, scales, replica, number);
}

Insertion::Insertion(const InsertionSpec& of) : spec(of), flow(of.flow) { state.random = spec.seed; }

void Insertion::begin_flow(const InsertionFlow& of, double t)
{
    if (of.has_values_of(flow)) return;
    const double due = spec.due(flow, t);
    InsertionFlow next = of;
    next.since = t, next.number = static_cast<double>(state.count), next.mass = state.mass;
    if (flow.mass_rate > 0)
        next.number += (due - state.mass) / spec.mean_mass(), next.mass = due;
    else if (flow.rate > 0)
        next.mass += (due - next.number) * spec.mean_mass(), next.number = due;
    flow = next;
}

double Insertion::due_mass(double t) const
{
    if (!flow.active) return state.mass;
    const double due = spec.due(flow, t), mean = spec.mean_mass(),
                 most = static_cast<double>(spec.count) * mean;
    return std::min(flow.mass_rate > 0 ? due : due * mean, most);
}

std::string Insertion::shortfall(double t, double h) const
{
    // those that have become due since the last insertion wait for the next one
    const double interval = static_cast<double>(spec.interval) * h;
    const double due = due_mass(std::max(t - interval, 0.)), lacks = due - state.mass;
    if (!(lacks > 0.1 * due) || !(lacks > 10 * spec.mean_mass())) return {};
    return io::formatted(
        "the insertion '%s' cannot keep up: %.9g kg are due at t = %.9g s and %.9g kg are "
        "inserted; a larger region, a velocity or a smaller rate helps",
        spec.name.c_str(), due_mass(t), t, state.mass);
}

bool Insertion::is_due(const State& now, double t) const
{
    if (!flow.active || now.count >= spec.count) return false;
    const double due = spec.due(flow, t);
    if (flow.mass_rate == 0) return static_cast<double>(now.count) < whole(due);
    // the inserted mass is the closest one to that which is due
    return now.mass + stored_mass(now.radius, spec.density) / 2 <= due;
}

void Insertion::throw_blocked(const State& now, double t) const
{
    throw InsertionBlocked(io::formatted(
        "insertion '%s': no place for a particle of radius %.9g m in its region, a %s, in %lld tries from "
        "t = %.9g s to t = %.9g s; it has inserted %lld particles",
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
    std::vector<Clump> clumps;     // in place of the particles
    std::vector<Sphere> occupied;  // by a particle or a clump
    if (is_due(now, t)) {
        const double R = spec.sizes.largest();
        const auto [low, high] = spec.region.bounds(R);
        Obstacles obstacles(world, low, high, R, spec.replica);
        for (bool has_place = true; has_place && is_due(now, t); draw()) {
            Particle p = spec.particle(now.radius);
            Clump clump;
            has_place = false;
            for (long k = 0; k < InsertionSpec::tries_at_once && !has_place; ++k) {
                p.r = spec.region.centre(p.radius, random);
                if (spec.clumps) {
                    clump = spec.clumps.at(p, random);
                    occupied = spec.clumps.of.placed(clump.r, clump.e, clump.scale);
                } else {
                    occupied.assign(1, {p.r, p.radius});
                }
                has_place = std::none_of(occupied.begin(), occupied.end(),
                                         [&](const Sphere& s) { return obstacles.touches(s.r, s.radius); });
                if (!has_place && now.tries++ == 0) now.blocked_since = t;
            }
            if (!has_place) {
                if (!spec.postpones || now.tries >= spec.most_tries) throw_blocked(now, t);
                break;
            }
            p.v = flow.v + flow.random_v * random.direction();
            clump.v = p.v;
            for (const Sphere& s : occupied) obstacles.add(s.r, s.radius);
            placed.push_back(p), clumps.push_back(clump);
            now.mass += stored_mass(p.radius, spec.density);
            ++now.count, now.radius = 0, now.tries = 0;
        }
    }
    now.random = random.state;
    std::optional<std::uint32_t> first;
    for (std::size_t k = 0; k < placed.size(); ++k) {
        const std::uint32_t id = spec.clumps ? world.add_clump(clumps[k]) : world.add(placed[k]);
        if (!first) first = id;
    }
    state = now;
    return first;
}

void Insertion::transfer(io::Archive& a)
{
    flow.transfer(a);
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

double Insertions::due_mass(double t) const
{
    double sum = 0;
    for (const Insertion& i : all) sum += i.due_mass(t);
    return sum;
}

void Insertions::start(World& world, double t)
{
    for (const Insertion& i : all)
        i.what().announce(world, static_cast<std::size_t>(std::min(i.what().largest_count(t), 4e9)));
    world.before_each_step([this](World& w) {
        for (Insertion& i : all)
            if (const std::optional<std::uint32_t> first = i.before_step(w); first && groups != nullptr)
                groups->add(*first, i.what().group);
    });
}

void Insertions::transfer(io::Archive& a)
{
    for (Insertion& i : all) i.transfer(a);
}

}  // namespace hilda::granular
