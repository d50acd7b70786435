// SPDX-License-Identifier: GPL-3.0-or-later
// Queries of contacts at t. Loads are computed again from copies of the histories, so that a query does not
// change the state.
#include "granular/world/world_impl.hpp"

#include <algorithm>

namespace hilda::granular {

using namespace detail;

/// Adds the force and the torque of a contact on its boundary, and on the boundaries to which its particles
/// are attached, about Boundary::r.
void World::add_wrench(std::vector<Wrench>& to, const ContactRecord& c) const
{
    const auto add = [&](int number, double sign) {
        if (number < 0) return;
        const auto b = static_cast<std::size_t>(number);
        to[b].F += sign * c.F;
        to[b].T += sign * ((c.C - boundaries[b].r).cross(c.F) + c.T);
    };
    add(c.boundary ? static_cast<int>(c.j) : boundary_of(c.j), -1);
    if (!c.boundary) add(boundary_of(c.i), 1);
}

/// Loads at t of all pairs in the neighbour list
struct World::CurrentLoads {
    const Arrays<par::Cpu>& of;
    par::Array<par::Cpu, Float4> history, rotation_history, torque;
    par::Array<par::Cpu, Load> load;
    par::Array<par::Cpu, std::uint8_t> in_contact;
};

World::CurrentLoads World::current_loads() const
{
    if (!std::isfinite(particle_displacement) && inserted_count > 0 && !particle_lost) {
        try {
            find_neighbours();
        } catch (const LeftDomain& lost) {
            // The next step removes the particle. The present list has all pairs in contact.
            if (!removes()) throw_left(lost.id);
        }
        // The requested rebuild before the next step still has to take place.
        particle_displacement = std::numeric_limits<double>::infinity();
    }
    const Arrays<par::Cpu>& a = engine->arrays();
    const Pairs<par::Cpu>& pairs = a.pairs;
    const auto copy_of = [&](const auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        par::Array<par::Cpu, T> copy(std::min(array.size(), std::size_t{pairs.count}));
        par::copy_bytes(par::Cpu(), copy.data(), array.data(), copy.size() * sizeof(T));
        return copy;
    };
    CurrentLoads now{.of = a,
                     .history = copy_of(pairs.history),
                     .rotation_history = copy_of(pairs.rotation_history),
                     .torque = par::Array<par::Cpu, Float4>(pairs.rotation_history.size()),
                     .load = par::Array<par::Cpu, Load>(pairs.count),
                     .in_contact = copy_of(pairs.in_contact)};
    const bool rotation_laws = now.rotation_history.size() > 0;
    // With velocity Verlet the histories belong to t already. With the other schemes they belong to the
    // previous step.
    const float h =
        options.scheme == Scheme::velocity_verlet && step_count > 0 ? 0 : static_cast<float>(options.h);
    find_loads(par::Cpu(), particle_view(domain, a.particle),
               {pairs.i.data(), pairs.j.data(), laws.size() > 1 ? pairs.law.data() : nullptr,
                now.history.data(), rotation_laws ? now.rotation_history.data() : nullptr, now.load.data(),
                rotation_laws ? now.torque.data() : nullptr, now.in_contact.data(), pairs.count},
               {laws.data(), static_cast<int>(laws.size()), boundaries.data(), h});
    return now;
}

/// Record of the pair n, which is in contact. i is the particle with the lower id.
ContactRecord World::contact(const CurrentLoads& now, std::uint32_t n) const
{
    const Particles<par::Cpu>& particle = now.of.particle;
    const std::uint32_t i = now.of.pairs.i.data()[n], j = now.of.pairs.j.data()[n];
    ContactRecord c;
    c.boundary = (j & PairView::boundary_bit) != 0;
    c.i = particle.id.data()[i];
    c.j = c.boundary ? j & ~PairView::boundary_bit : particle.id.data()[j];
    c.replica = particle.species.data()[i].replica;
    const Position at = particle.position.data()[i];
    const double R = particle.velocity.data()[i].w;
    const Vec3 r = global_position(domain.grid, at);
    if (c.boundary) {
        const Nearest near = nearest(boundaries[c.j], r);
        c.n = near.n, c.delta = R - near.distance;
        c.C = r - near.distance * near.n;
    } else {
        const Vec3 apart = separation(domain.grid, at, particle.position.data()[j]);
        c.n = (1 / apart.norm()) * apart;
        c.delta = R + particle.velocity.data()[j].w - apart.norm();
        c.C = r - R * c.n;
    }
    if (now.rotation_history.size() > 0) c.T = to_double(now.torque.data()[n]);
    c.F = to_double(now.load.data()[n].F), c.u = to_double(now.history.data()[n]);
    if (!c.boundary && c.j < c.i) {
        std::swap(c.i, c.j);
        c.C += c.delta * c.n;  // from the surface of one particle to that of the other
        c.n = -c.n, c.F = -c.F, c.T = -c.T, c.u = -c.u;
    }
    return c;
}

std::vector<ContactRecord> World::contacts() const
{
    const CurrentLoads now = current_loads();
    const std::uint32_t* id = now.of.particle.id.data();
    std::vector<std::uint32_t> pair;
    std::vector<std::uint64_t> key;
    for (std::uint32_t n = 0; n < now.of.pairs.count; ++n) {
        if (now.in_contact.data()[n] == 0) continue;
        std::uint32_t i = id[now.of.pairs.i.data()[n]], j = now.of.pairs.j.data()[n];
        const bool boundary = (j & PairView::boundary_bit) != 0;
        if (!boundary) j = id[j];
        if (!boundary && j < i) std::swap(i, j);
        constexpr std::uint64_t last = std::uint64_t{1} << 63;
        pair.push_back(n);
        key.push_back((boundary ? last : 0) | std::uint64_t{i} << 32 | j);
    }
    par::stable_sort_by_key(par::Cpu(), key.data(), pair.data(), pair.size(), 64);
    std::vector<ContactRecord> all(pair.size());
    par::for_each(par::Cpu(), pair.size(), [&](std::uint32_t k) { all[k] = contact(now, pair[k]); });
    return all;
}

Wrench World::wrench(const std::vector<ContactRecord>& contacts, int b, int replica) const
{
    std::vector<Wrench> on(boundaries.size());
    for (const ContactRecord& c : contacts)
        if (replica < 0 || c.replica == replica) add_wrench(on, c);
    return on[static_cast<std::size_t>(b)];
}

World::Totals World::totals() const
{
    const CurrentLoads now = current_loads();
    const Pairs<par::Cpu>& pairs = now.of.pairs;
    const Position* position = now.of.particle.position.data();
    Totals all{.contacts = 0, .stress = {}, .on_boundary = std::vector<Wrench>(boundaries.size())};

    // Partial sums over fixed blocks, added in order: the result does not depend on the number of threads.
    constexpr std::uint32_t piece = 4096;
    struct Sum {
        std::size_t contacts = 0;
        std::array<double, 9> stress = {};
    };
    std::vector<Sum> sums((pairs.count + piece - 1) / piece);
    const auto add_stress = [](Sum& to, const Vec3& l, const Float4& F) {
        const double from_j[] = {l.x, l.y, l.z}, on_i[] = {F.x, F.y, F.z};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) to.stress[3 * a + b] += from_j[a] * on_i[b];
        ++to.contacts;
    };
    const auto particles = [&](std::uint32_t k) {
        for (std::uint32_t n = k * piece; n < std::min((k + 1) * piece, pairs.count); ++n) {
            const std::uint32_t j = pairs.j.data()[n];
            if (now.in_contact.data()[n] != 0 && (j & PairView::boundary_bit) == 0)
                add_stress(sums[k], separation(domain.grid, position[pairs.i.data()[n]], position[j]),
                           now.load.data()[n].F);
        }
    };
    par::for_each(par::Cpu(), sums.size(), particles, 1);
    Sum sum;
    const auto is_fixed = [&](std::uint32_t k) { return !(now.of.particle.omega.data()[k].w > 0); };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        const std::uint32_t j = pairs.j.data()[n];
        if (now.in_contact.data()[n] == 0) continue;
        const bool boundary = (j & PairView::boundary_bit) != 0;
        if (!boundary && (attached.empty() || !(is_fixed(pairs.i.data()[n]) || is_fixed(j)))) continue;
        const ContactRecord c = contact(now, n);
        add_wrench(all.on_boundary, c);
        if (!boundary) continue;  // its stress is in `sums`
        const double R = now.of.particle.velocity.data()[pairs.i.data()[n]].w;
        add_stress(sum, (R - c.delta) * c.n, now.load.data()[n].F);
    }
    for (const Sum& s : sums) {
        sum.contacts += s.contacts;
        for (int k = 0; k < 9; ++k) sum.stress[k] += s.stress[k];
    }
    all.contacts = sum.contacts;
    for (int k = 0; k < 9; ++k) all.stress[k] = sum.stress[k] / volume();
    return all;
}

}  // namespace hilda::granular
