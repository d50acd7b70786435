// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of an entry of `insert`.
#include "granular/insertion/insertion.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

/// Time in which a particle moves by the distance d from rest or from the speed v, with the acceleration g
double time_to_move(double d, double v, double g) { return 2 * d / (v + std::sqrt(v * v + 2 * g * d)); }

/// Number of steps in a time, at least `least`
long steps_in(ObjectReader& o, const char* key, double time, double h, long least)
{
    constexpr double most = 9e15;
    if (!(time / h <= most))
        o.fail(key, std::string(key) + " must be at most 9e15 steps, got " + io::shortest(time));
    return std::max(least, std::lround(time / h));
}

void read_amount(ObjectReader& o, InsertionSpec& s)
{
    if (o.has("rate")) s.flow.rate = o.positive("rate");
    if (o.has("mass_rate")) s.flow.mass_rate = o.positive("mass_rate");
    if (s.flow.rate > 0 && s.flow.mass_rate > 0)
        o.fail("mass_rate", "mass_rate must not be given together with rate");
    if (o.has("count")) s.count = o.count("count");
    if (s.count == 0) o.fail("count", "count must be positive, got 0");
    if (s.flow.rate == 0 && s.flow.mass_rate == 0 && s.count == InsertionSpec::no_limit)
        o.fail("one of the keys rate, mass_rate and count is required");
}

}  // namespace

InsertionSpec read_insertion(ObjectReader& o, const std::string& name, double h, const Vec3& gravity,
                             const World& world)
{
    InsertionSpec s;
    s.name = o.name("name", {}, name);
    s.clumps = read_placed_clumps(o, world);
    s.sizes = read_radius(o, s.clumps ? std::optional(s.clumps.radius) : std::nullopt);
    if (s.clumps) {
        s.material = s.clumps.of.material;
        s.density = s.clumps.of.mass / sphere_volume(s.clumps.radius);
    }
    const double R = s.sizes.largest();
    s.region = read_region(o.object("region"), R);
    read_amount(o, s);
    s.from = o.not_negative("from", {}, 0);
    if (o.has("to")) s.flow.to = o.number("to");
    if (o.has("to") && s.flow.rate == 0 && s.flow.mass_rate == 0)
        o.fail("to", "to must be given together with rate or mass_rate only");
    if (!(s.flow.to > s.from))
        o.fail("to", "to must be after from, " + io::shortest(s.from) + ", got " + io::shortest(s.flow.to));
    s.flow.v = o.vec3("v", Vec3{0, 0, 0});
    s.flow.random_v = o.not_negative("random_v", {}, 0);
    const double speed = s.flow.v.norm(), g = gravity.norm();
    std::optional<double> interval;
    if (speed + g > 0) interval = time_to_move(2 * R, speed, g);
    s.first_step = steps_in(o, "from", s.from, h, 0);
    s.interval = steps_in(o, "interval", o.positive("interval", {}, interval), h, 1);
    s.postpones = o.one_of("on_overlap", {"postpone", "refuse"}, {}, "postpone") == "postpone";
    s.most_tries = o.count("tries", {}, s.most_tries);
    if (s.most_tries < InsertionSpec::tries_at_once)
        o.fail("tries", "tries must be at least 200, got " + std::to_string(s.most_tries));
    s.flow.active = o.flag("active", {}, true);
    s.seed = static_cast<std::uint64_t>(o.count("seed", {}, 1));
    return s;
}

}  // namespace hilda::granular
