// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/field_input.hpp"

#include <numbers>

namespace hilda::granular {

FieldInput field_input(const World& world, const std::vector<ContactRecord>& contacts, int replica)
{
    FieldInput in;
    const std::vector<Particle> all = world.particles();
    for (const Particle& p : all)
        if (p.replica == replica && !p.fixed)
            in.particles.push_back(
                {p.r, p.v, p.mass, 4. / 3 * std::numbers::pi * p.radius * p.radius * p.radius});
    for (const ContactRecord& c : contacts) {
        if (c.replica != replica) continue;
        const Particle& i = all[index_of(c.i, all)];
        if (c.boundary) {
            if (!i.fixed) in.contacts.push_back({i.r, (i.radius - c.delta) * c.n, c.F, true});
            continue;
        }
        const Particle& j = all[index_of(c.j, all)];
        const double distance = i.radius + j.radius - c.delta;
        if (!i.fixed && !j.fixed)
            in.contacts.push_back({i.r, distance * c.n, c.F, false});
        else if (!i.fixed)
            in.contacts.push_back({i.r, (distance - j.radius) * c.n, c.F, true});
        else if (!j.fixed)
            in.contacts.push_back({j.r, (i.radius - distance) * c.n, -c.F, true});
    }
    return in;
}

}  // namespace hilda::granular
