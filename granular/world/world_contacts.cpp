// SPDX-License-Identifier: GPL-3.0-or-later
// What a world tells of its contacts, at t: loads are found anew, on copies, so that telling changes nothing.
#include "granular/world/world_impl.hpp"

#include <algorithm>

namespace hilda::granular {

using namespace detail;

namespace {

/// What a contact with a boundary does to it
void add_wrench(Wrench& to, const ContactRecord& c, const Boundary& b)
{
    to.F -= c.F;
    to.T -= (c.C - b.r).cross(c.F) + c.T;
}

}  // namespace

/// Loads at t, by pairs
struct World::LoadsNow {
    const Arrays<par::Cpu>& of;
    par::Array<par::Cpu, Four> history, turning, torque;
    par::Array<par::Cpu, Load> load;
    par::Array<par::Cpu, std::uint8_t> touches;
};

World::LoadsNow World::loads_now() const
{
    if (!std::isfinite(moved) && particles_in > 0 && !one_is_lost) {
        look_for_neighbours();
        moved = std::numeric_limits<
            double>::infinity();  // and once more before the next step, as it was asked for
    }
    const Arrays<par::Cpu>& a = engine->arrays();
    const Pairs<par::Cpu>& pairs = a.pairs;
    const auto copy_of = [&](const auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        par::Array<par::Cpu, T> copy(std::min(array.size(), std::size_t{pairs.count}));
        par::copy_bytes(par::Cpu(), copy.data(), array.data(), copy.size() * sizeof(T));
        return copy;
    };
    LoadsNow now{.of = a,
                 .history = copy_of(pairs.history),
                 .turning = copy_of(pairs.turning),
                 .torque = par::Array<par::Cpu, Four>(pairs.turning.size()),
                 .load = par::Array<par::Cpu, Load>(pairs.count),
                 .touches = copy_of(pairs.touches)};
    const bool turns = now.turning.size() > 0;
    // histories of velocity Verlet are those of t; of the others, those of the step before
    const float h =
        options.scheme == Scheme::velocity_verlet && number > 0 ? 0 : static_cast<float>(options.h);
    find_loads(par::Cpu(), particle_view(scene, a.particle),
               {pairs.i.data(), pairs.j.data(), laws.size() > 1 ? pairs.law.data() : nullptr,
                now.history.data(), turns ? now.turning.data() : nullptr, now.load.data(),
                turns ? now.torque.data() : nullptr, now.touches.data(), pairs.count},
               {laws.data(), static_cast<int>(laws.size()), boundaries.data(), h});
    return now;
}

/// Of pair n, which touches, with the lower id as i
ContactRecord World::contact(const LoadsNow& now, std::uint32_t n) const
{
    const Particles<par::Cpu>& particle = now.of.particle;
    const std::uint32_t i = now.of.pairs.i.data()[n], j = now.of.pairs.j.data()[n];
    ContactRecord c;
    c.boundary = (j & PairView::boundary) != 0;
    c.i = particle.id.data()[i];
    c.j = c.boundary ? j & ~PairView::boundary : particle.id.data()[j];
    c.replica = particle.kind.data()[i].replica;
    const Position at = particle.position.data()[i];
    const double R = particle.velocity.data()[i].w;
    const Vec3 r = place(scene.grid, at);
    if (c.boundary) {
        const Nearest near = nearest(boundaries[c.j], r);
        c.n = near.n, c.delta = R - near.distance;
        c.C = r - near.distance * near.n;
    } else {
        const Vec3 apart = apart_of(scene.grid, at, particle.position.data()[j]);
        c.n = (1 / apart.norm()) * apart;
        c.delta = R + particle.velocity.data()[j].w - apart.norm();
        c.C = r - R * c.n;
    }
    if (now.turning.size() > 0) c.T = to_double(now.torque.data()[n]);
    c.F = to_double(now.load.data()[n].F), c.u = to_double(now.history.data()[n]);
    if (!c.boundary && c.j < c.i) {
        std::swap(c.i, c.j);
        c.C += c.delta * c.n;  // at the radius of the other
        c.n = -c.n, c.F = -c.F, c.T = -c.T, c.u = -c.u;
    }
    return c;
}

std::vector<ContactRecord> World::contacts() const
{
    const LoadsNow now = loads_now();
    const std::uint32_t* id = now.of.particle.id.data();
    std::vector<std::uint32_t> pair;
    std::vector<std::uint64_t> key;
    for (std::uint32_t n = 0; n < now.of.pairs.count; ++n) {
        if (now.touches.data()[n] == 0) continue;
        std::uint32_t i = id[now.of.pairs.i.data()[n]], j = now.of.pairs.j.data()[n];
        const bool boundary = (j & PairView::boundary) != 0;
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
    Wrench sum;
    for (const ContactRecord& c : contacts) {
        if (!c.boundary || static_cast<int>(c.j) != b || (replica >= 0 && c.replica != replica)) continue;
        add_wrench(sum, c, boundaries[c.j]);
    }
    return sum;
}

World::Totals World::totals() const
{
    const LoadsNow now = loads_now();
    const Pairs<par::Cpu>& pairs = now.of.pairs;
    const Position* position = now.of.particle.position.data();
    Totals all{.contacts = 0, .stress = {}, .on_boundary = std::vector<Wrench>(boundaries.size())};

    // sums of pieces that are the same for any number of threads, in their order
    constexpr std::uint32_t piece = 4096;
    struct Sum {
        std::size_t contacts = 0;
        std::array<double, 9> stress = {};
    };
    std::vector<Sum> sums((pairs.count + piece - 1) / piece);
    const auto add_stress = [](Sum& to, const Vec3& l, const Four& F) {
        const double from_j[] = {l.x, l.y, l.z}, on_i[] = {F.x, F.y, F.z};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) to.stress[3 * a + b] += from_j[a] * on_i[b];
        ++to.contacts;
    };
    const auto particles = [&](std::uint32_t k) {
        for (std::uint32_t n = k * piece; n < std::min((k + 1) * piece, pairs.count); ++n) {
            const std::uint32_t j = pairs.j.data()[n];
            if (now.touches.data()[n] != 0 && (j & PairView::boundary) == 0)
                add_stress(sums[k], apart_of(scene.grid, position[pairs.i.data()[n]], position[j]),
                           now.load.data()[n].F);
        }
    };
    par::for_each(par::Cpu(), sums.size(), particles, 1);
    Sum sum;
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        const std::uint32_t j = pairs.j.data()[n];
        if (now.touches.data()[n] == 0 || (j & PairView::boundary) == 0) continue;
        const ContactRecord c = contact(now, n);
        add_wrench(all.on_boundary[c.j], c, boundaries[c.j]);
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
