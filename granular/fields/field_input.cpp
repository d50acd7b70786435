// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/field_input.hpp"

namespace hilda::granular {

FieldInput field_input(const World& world, const std::vector<ContactRecord>& contacts, int replica,
                       const Groups* groups, int group)
{
    FieldInput in;
    const auto counts = [&](const Particle& p) {
        return !p.fixed && (groups == nullptr || groups->of(p.id) == group);
    };
    const std::vector<Particle> all = world.particles();
    for (const Particle& p : all)
        if (p.replica == replica && counts(p) && p.clump < 0)
            in.particles.push_back({p.r, p.v, p.mass, sphere_volume(p.radius)});
    for (const Clump& c : world.clumps())
        if (c.replica == replica && (groups == nullptr || groups->of(c.id) == group))
            in.particles.push_back({c.r, c.v, c.mass,
                                    c.scale * c.scale * c.scale *
                                        world.clump_templates()[static_cast<std::size_t>(c.shape)].volume});
    for (const ContactRecord& c : contacts) {
        if (c.replica != replica) continue;
        const Particle& i = all[index_of(c.i, all)];
        // Clumps are points with their mass at the centre of mass.
        const Vec3 in_i = world.offset_in_clump(c.i), r_i = i.r - in_i;
        if (c.boundary) {
            if (counts(i)) in.contacts.push_back({r_i, (i.radius - c.delta) * c.n - in_i, c.F, true});
            continue;
        }
        const Particle& j = all[index_of(c.j, all)];
        const double distance = i.radius + j.radius - c.delta;
        const Vec3 in_j = world.offset_in_clump(c.j);
        if (counts(i) && counts(j))
            in.contacts.push_back({r_i, distance * c.n - (in_i - in_j), c.F, false});
        else if (counts(i))
            in.contacts.push_back({r_i, (distance - j.radius) * c.n - in_i, c.F, true});
        else if (counts(j))
            in.contacts.push_back({j.r - in_j, (i.radius - distance) * c.n - in_j, -c.F, true});
    }
    return in;
}

}  // namespace hilda::granular
