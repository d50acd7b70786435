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
    o.note_exclusive(std::array<std::string, 2>{"rate", "mass_rate"});
    s.flow.rate =
        o.optional_positive("rate", {"Number of particles per time [1/s].", "2000"}).value_or(s.flow.rate);
    s.flow.mass_rate = o.optional_positive("mass_rate", {"Mass of the particles per time [kg/s].", "0.05"})
                           .value_or(s.flow.mass_rate);
    if (s.flow.rate > 0 && s.flow.mass_rate > 0)
        o.fail("mass_rate", "mass_rate must not be given together with rate");
    if (o.given("count"))
        s.count =
            o.count("count",
                    {"Largest number of particles. Without rate and mass_rate, all are due at the time from.",
                     "500", R"("minimum": 1)"});
    if (s.count == 0) o.fail("count", "count must be positive, got 0");
    if (s.flow.rate == 0 && s.flow.mass_rate == 0 && s.count == InsertionSpec::no_limit)
        o.fail("one of the keys rate, mass_rate and count is required");
}

}  // namespace

InsertionSpec read_insertion(ObjectReader& o, const std::string& name, double h, const Vec3& gravity,
                             const World& world)
{
    o.defines(
        "insertion", "Insertion",
        "Particles that are inserted at random places of a region, where they touch nothing. One of the keys "
        "rate, mass_rate and count is required, and one of radius, sizes and clump.",
        R"("allOf": [{"if": {"required": ["clump"]}, "then": {"not": {"required": ["material"]}}, )"
        R"("else": {"anyOf": [{"required": ["radius"]}, {"required": ["sizes"]}], )"
        R"("not": {"required": ["orientation"]}}}, )"
        R"({"anyOf": [{"required": ["rate"]}, {"required": ["mass_rate"]}, {"required": ["count"]}]}, )"
        R"({"anyOf": [{"not": {"required": ["to"]}}, {"required": ["rate"]}, {"required": ["mass_rate"]}]}])");
    InsertionSpec s;
    s.name = o.name("name",
                    {.text = "Name in messages and in summary.json. By default insertion 0, insertion 1, ...",
                     .example = R"("feed")",
                     .computed = true},
                    name);
    note_clumps(
        o,
        "Name of an entry of clumps: clumps are inserted, and numbers and masses are those of the clumps. "
        "radius or sizes are those of the sphere around the centre of mass that contains the clump, and "
        "scale the clumps. By default radius is that of the template. Not together with material.");
    s.clumps = read_placed_clumps(o, world);
    s.sizes = read_radius(o, s.clumps ? std::optional(s.clumps.radius) : std::nullopt);
    if (s.clumps) {
        s.material = s.clumps.of.material;
        s.density = s.clumps.of.mass / sphere_volume(s.clumps.radius);
    }
    const double R = s.sizes.largest();
    s.region = read_region(
        o.object(
            "region",
            {"Region that contains the whole particles at their insertion. It must be within the domain.",
             R"({"type": "box", "low": [0, 0, 0.09], "high": [0.03, 0.02, 0.1]})"},
            "region"),
        R);
    read_amount(o, s);
    s.from = o.not_negative("from", {"Begin of the insertion [s].", "0.1"}, 0);
    o.note("to", "number",
           {"End of the insertion [s], with rate or mass_rate. It must be after from. By default the "
            "insertion goes on. Particles that have found no place until then are still inserted later.",
            "0.5"});
    if (o.has("to")) s.flow.to = o.number("to");
    if (o.has("to") && s.flow.rate == 0 && s.flow.mass_rate == 0)
        o.fail("to", "to must be given together with rate or mass_rate only");
    if (!(s.flow.to > s.from))
        o.fail("to", "to must be after from, " + io::shortest(s.from) + ", got " + io::shortest(s.flow.to));
    s.flow.v = o.vec3(
        "v", {"Velocity of the particles at their insertion [m/s], in the global frame.", "[0, 0, -0.5]"},
        Vec3{0, 0, 0});
    s.flow.random_v = o.not_negative("random_v", about_random_v, 0);
    const double speed = s.flow.v.norm(), g = gravity.norm();
    std::optional<double> interval;
    if (speed + g > 0) interval = time_to_move(2 * R, speed, g);
    s.first_step = steps_in(o, "from", s.from, h, 0);
    const double between = o.positive(
        "interval",
        {.text = "Time between insertions [s], rounded to whole steps. The particles that have become due "
                 "are inserted together. By default the time in which a particle moves by the largest "
                 "diameter, with the velocity v and gravity. It is required if both are zero.",
         .example = "0.01",
         .computed = true},
        interval);
    s.interval = steps_in(o, "interval", between, h, 1);
    const std::string on_overlap =
        o.one_of("on_overlap", {"postpone", "refuse"},
                 {"What happens to a particle for which 200 random positions have no place: postpone lets it "
                  "wait for the next insertion, refuse ends the run with exit code 4.",
                  R"("refuse")"},
                 "postpone");
    s.postpones = on_overlap == "postpone";
    s.most_tries = o.count("tries",
                           {"Number of positions in turn without place, over all insertions, after which the "
                            "run ends with exit code 4.",
                            "1000", R"("minimum": 200)"},
                           s.most_tries);
    if (s.most_tries < InsertionSpec::tries_at_once)
        o.fail("tries", "tries must be at least 200, got " + std::to_string(s.most_tries));
    s.flow.active = o.flag("active",
                           {"If false, nothing is inserted. A change of the run can set it later; the "
                            "amounts are then due from this time on.",
                            "false"},
                           true);
    s.seed = static_cast<std::uint64_t>(o.count("seed", about_seed, 1));
    return s;
}

}  // namespace hilda::granular
