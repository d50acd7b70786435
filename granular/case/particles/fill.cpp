// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/particles/fill.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

FillSpec read_filled_box(ObjectReader& o, const std::optional<double>& radius)
{
    note_clumps(o,
                "Name of an entry of clumps: the fill consists of clumps. Each one takes the place of a "
                "sphere around its centre of mass that contains the clump; radius or sizes are those of this "
                "sphere, and scale the clumps. By default radius is that of the template.");
    FillSpec f;
    f.low = o.vec3(
        "low",
        {"Lower corner of the box that contains the whole particles [m], in the global frame.", "[0, 0, 0]"});
    f.high = o.vec3(
        "high",
        {"Upper corner of the box [m], in the global frame. The box must be at least one diameter wide.",
         "[0.03, 0.02, 0.028]"});
    f.sizes = read_radius(o, radius);
    f.radius = f.sizes.largest();
    const double spacing = o.number(
        "spacing",
        {"Distance of the centres, in diameters of the largest particle [-].", "1.02", R"("minimum": 1)"},
        1.05);
    if (!(spacing >= 1))
        o.fail("spacing", "spacing must be at least 1 diameter, got " + io::shortest(spacing));
    f.spacing = 2 * f.radius * spacing;
    f.jitter = o.fraction(
        "jitter",
        {"Random displacement of the positions as a fraction of the free distance between neighbours [-].",
         "0.5"},
        0);
    f.max_count = static_cast<std::size_t>(
        o.count("count", {"Maximum number of particles; 0: as many as fit.", "1000"}, 0));
    f.seed = static_cast<std::uint64_t>(o.count("seed", about_seed, 1));
    f.v = o.vec3("v", {"Initial velocity of all particles [m/s], in the global frame.", "[0, 0, -0.5]"},
                 Vec3{0, 0, 0});
    f.random_v = o.not_negative("random_v", about_random_v, 0);
    for (const auto& [low, high, axis] :
         {std::tuple{f.low.x, f.high.x, 0u}, {f.low.y, f.high.y, 1u}, {f.low.z, f.high.z, 2u}})
        if (!(high - low >= 2 * f.radius))
            o.fail("high", axis,
                   "high must be at least a diameter, " + io::shortest(2 * f.radius) + ", above low, " +
                       io::shortest(low) + ", got " + io::shortest(high));
    return f;
}

FillSpec read_fill(ObjectReader& o, const std::optional<double>& radius)
{
    const auto& type = io::read_type<FillType>(o, {"Fill", "type", "Type of the fill."});
    FillSpec f = type.read(o, radius);
    f.type = &type;
    return f;
}

double estimated_count(const FillSpec& f)
{
    if (!f.particles.empty()) return static_cast<double>(f.particles.size());
    return (f.clumps ? f.clumps.spheres() : 1) *
           f.type->estimated_count(f, f.high - f.low - 2 * Vec3{f.radius, f.radius, f.radius});
}

void fill(const FillSpec& f, const std::function<void(const Particle&)>& use)
{
    if (!f.particles.empty()) {
        for (Particle p : f.particles) {
            p.replica = f.replica, p.attached_to = f.attached_to;
            if (f.material >= 0) p.material = f.material;
            use(p);
        }
        return;
    }
    const Vec3 margin{f.radius, f.radius, f.radius}, low = f.low + margin, high = f.high - margin;
    Random random(f.seed);
    std::vector<Vec3> places = f.type->centres(f, low, high, random);
    if (f.max_count > 0 && places.size() > f.max_count) places.resize(f.max_count);
    const double free = f.jitter * (f.spacing / 2 - f.radius) / std::sqrt(3.);
    for (const Vec3& r : places) {
        Particle p;
        p.radius = f.sizes.draw(random);
        p.material = f.material, p.replica = f.replica, p.attached_to = f.attached_to;
        p.r = r + Vec3{random.number(-free, free), random.number(-free, free), random.number(-free, free)};
        p.r = {std::clamp(p.r.x, low.x, high.x), std::clamp(p.r.y, low.y, high.y),
               std::clamp(p.r.z, low.z, high.z)};
        p.v = f.v + f.random_v * random.direction();
        use(p);
    }
}

std::vector<Particle> fill(const FillSpec& f)
{
    std::vector<Particle> all;
    fill(f, [&](const Particle& p) { all.push_back(p); });
    return all;
}

}  // namespace hilda::granular
