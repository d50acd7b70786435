// SPDX-License-Identifier: GPL-3.0-or-later
// Queries of contacts at t. Loads are computed again from copies of the histories, so that a query does not
// change the state.
#include "granular/backend/cpu_loops.hpp"
#include "granular/backend/fixed_sum.hpp"
#include "granular/backend/instruction_set.hpp"
#include "granular/core/surfaces/hand_over.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <tuple>
#include <utility>

namespace hilda::granular {

using namespace detail;

/// Adds the force and the torque of a contact on its boundary, and on the boundaries to which its particles
/// are attached, and on the bodies of which these are parts, about Boundary::r. to[b]: the sum of boundary b.
template <class To>
void World::add_wrench(To& to, const ContactRecord& c) const
{
    const auto add = [&](int number, double sign) {
        if (number < 0) return;
        const auto b = static_cast<std::size_t>(number);
        const auto add_to = [&](std::size_t on) {
            to[on].F += sign * c.F;
            to[on].T += sign * ((c.C - boundaries[on].r).cross(c.F) + c.T);
        };
        add_to(b);
        if (boundaries[b].body >= 0) add_to(static_cast<std::size_t>(boundaries[b].body));
    };
    add(c.boundary ? static_cast<int>(c.j) : boundary_of(c.j), -1);
    if (!c.boundary) add(boundary_of(c.i), 1);
}

/// Loads at t of a part of the pairs in the neighbour list
struct World::CurrentLoads {
    static constexpr std::uint32_t most = 1024;  ///< pairs of a part

    const Arrays<par::Cpu>& of;
    std::uint32_t begin, count;  ///< number of the first pair, number of pairs
    Float4 history[most], rotation_history[most], torque[most], internal[most];  ///< set if they are used
    Load load[most];
    std::uint8_t in_contact[most];

    CurrentLoads(const Arrays<par::Cpu>& of, std::uint32_t begin, std::uint32_t count)
        : of(of), begin(begin), count(count)
    {}

    bool touching(std::uint32_t n) const { return in_contact[n - begin] != 0; }
    static std::uint32_t parts(std::uint32_t pairs) { return (pairs + most - 1) / most; }
};

namespace {

/// The histories of the pairs at the present positions: those of contacts with triangles may have passed to
/// another triangle since the last step; see HandOver. Copies are made only if there are triangles.
struct HandedOver {
    const Float4 *history, *rotation_history, *internal;
    const std::uint8_t* in_contact;

    HandedOver(const Pairs<par::Cpu>& pairs, const ParticleView& particles, const Surfaces& surfaces,
               bool has_rotation, bool has_internal)
        : history(pairs.history.data()), rotation_history(pairs.rotation_history.data()),
          internal(pairs.internal.data()), in_contact(pairs.in_contact.data())
    {
        std::vector<std::uint32_t> which;
        const HasTriangle has_triangle{pairs.j.data()};
        for (std::uint32_t n = 0; surfaces.mesh.triangle != nullptr && n < pairs.count; ++n)
            if (has_triangle(n)) which.push_back(n);
        if (which.empty()) return;
        const auto copy = [&](std::vector<Float4>& to, const Float4*& values, bool used) {
            if (used) to.assign(values, values + pairs.count), values = to.data();
        };
        copy(copies[0], history, true), copy(copies[1], rotation_history, has_rotation);
        copy(copies[2], internal, has_internal);
        flags.assign(in_contact, in_contact + pairs.count), in_contact = flags.data();
        const PairView view{.i = pairs.i.data(),
                            .j = pairs.j.data(),
                            .law = nullptr,
                            .history = copies[0].data(),
                            .rotation_history = has_rotation ? copies[1].data() : nullptr,
                            .load = nullptr,
                            .torque = nullptr,
                            .in_contact = flags.data(),
                            .count = pairs.count,
                            .internal = has_internal ? copies[2].data() : nullptr};
        par::for_each(par::Cpu(), static_cast<std::uint32_t>(which.size()),
                      HandOver{particles, view, surfaces, which.data(), pairs.start.data()});
    }
    HandedOver(const HandedOver&) = delete;
    HandedOver& operator=(const HandedOver&) = delete;

private:
    std::vector<Float4> copies[3];
    std::vector<std::uint8_t> flags;
};

}  // namespace

/// Calls f(number of a part, CurrentLoads) for all parts of the pairs of these arrays, in parallel.
template <class F>
void World::for_current_loads(const Arrays<par::Cpu>& of, const F& f) const
{
    const Pairs<par::Cpu>& pairs = of.pairs;
    const bool rotation_laws = pairs.rotation_history.size() > 0, internal = pairs.internal.size() > 0;
    // With velocity Verlet the histories belong to t already. With the other schemes they belong to the
    // previous step.
    const bool is_advanced = options.scheme == Scheme::velocity_verlet && step_count > 0;
    const double h = is_advanced ? 0 : options.h, lag = velocity_lag(options.scheme) * h;
    const LawView law_view{laws.data(), static_cast<int>(laws.size()), surfaces(), static_cast<float>(h),
                           static_cast<float>(lag)};
    const ParticleView particles = particle_view(domain, of.particle);
    constexpr std::uint32_t most = CurrentLoads::most;
    const CpuLoops& loops = cpu_loops();
    const HandedOver from(pairs, particles, law_view.surfaces, rotation_laws, internal);
    par::for_each(
        par::Cpu(), CurrentLoads::parts(pairs.count),
        [&](std::uint32_t part) {
            const std::uint32_t begin = part * most, count = std::min(most, pairs.count - begin);
            const auto now = std::make_unique<CurrentLoads>(of, begin, count);
            std::copy_n(from.history + begin, count, now->history);
            std::copy_n(from.in_contact + begin, count, now->in_contact);
            if (rotation_laws) std::copy_n(from.rotation_history + begin, count, now->rotation_history);
            std::fill_n(now->torque, count, Float4{});
            if (internal) std::copy_n(from.internal + begin, count, now->internal);
            std::uint32_t number[most];
            std::iota(number, number + count, 0u);
            loops.find_listed_loads(par::Cpu(), particles,
                                    {.i = pairs.i.data() + begin,
                                     .j = pairs.j.data() + begin,
                                     .law = laws.size() > 1 ? pairs.law.data() + begin : nullptr,
                                     .history = now->history,
                                     .rotation_history = rotation_laws ? now->rotation_history : nullptr,
                                     .load = now->load,
                                     .torque = rotation_laws ? now->torque : nullptr,
                                     .in_contact = now->in_contact,
                                     .count = count,
                                     .internal = internal ? now->internal : nullptr,
                                     .image = pairs.image.size() > 0 ? pairs.image.data() + begin : nullptr},
                                    law_view, number, count);
            f(part, *now);
        },
        1);
}

/// Rebuilds the neighbour list for a query if the particles or laws have changed since the last step.
void World::update_for_query() const
{
    if (std::isfinite(particle_displacement) || inserted_count == 0 || particle_lost) return;
    try {
        find_neighbours();
    } catch (const LeftDomain& lost) {
        // The next step removes the particle. The present list has all pairs in contact.
        if (!removes()) throw_left(lost.id);
    }
    // The requested rebuild before the next step still has to take place.
    particle_displacement = std::numeric_limits<double>::infinity();
}

/// Record of the pair n, which is in contact. i is the particle with the lower id.
ContactRecord World::contact(const CurrentLoads& now, std::uint32_t n) const
{
    const Particles<par::Cpu>& particle = now.of.particle;
    const std::uint32_t i = now.of.pairs.i.data()[n], j = now.of.pairs.j.data()[n];
    ContactRecord c;
    c.boundary = (j & PairView::boundary_bit) != 0;
    c.i = particle.id.data()[i];
    const std::uint32_t surface = j & ~PairView::boundary_bit;
    c.j = c.boundary ? surfaces().boundary_of(surface) : particle.id.data()[j];
    c.replica = particle.species.data()[i].replica;
    const Position at = particle.position.data()[i];
    const double R = particle.velocity.data()[i].w;
    const Vec3 r = global_position(domain.grid, at);
    const double depth = now.load[n - now.begin].M.w;  // 0 with Lever::radius
    if (c.boundary) {
        const Nearest near = surfaces().nearest(surface, r, R);
        c.n = near.n, c.delta = R - near.distance;
        c.C = r - (near.distance + depth) * near.n;
    } else {
        const Vec3 apart = separation(domain.grid, now.of, n);
        c.n = (1 / apart.norm()) * apart;
        c.delta = R + particle.velocity.data()[j].w - apart.norm();
        c.C = r - (R - depth) * c.n;
    }
    c.T = to_double(now.torque[n - now.begin]);
    c.F = to_double(now.load[n - now.begin].F), c.u = to_double(now.history[n - now.begin]);
    if (!c.boundary && c.j < c.i) {
        std::swap(c.i, c.j);
        if (!(depth > 0)) c.C += c.delta * c.n;  // from the surface of one particle to that of the other
        c.n = -c.n, c.F = -c.F, c.T = -c.T, c.u = -c.u;
    }
    return c;
}

std::vector<ContactRecord> World::contacts() const
{
    update_for_query();
    std::vector<ContactRecord> all;
    engine->each_piece(true, [&](const Piece& piece) {
        std::vector<std::vector<ContactRecord>> parts(CurrentLoads::parts(piece.arrays.pairs.count));
        for_current_loads(piece.arrays, [&](std::uint32_t part, const CurrentLoads& now) {
            for (std::uint32_t n = now.begin; n < now.begin + now.count; ++n)
                if (now.touching(n)) parts[part].push_back(contact(now, n));
        });
        std::size_t number = all.size();
        for (const auto& part : parts) number += part.size();
        if (all.empty()) all.reserve(number);
        for (auto& part : parts) {
            all.insert(all.end(), part.begin(), part.end());
            std::vector<ContactRecord>().swap(part);
        }
    });
    // Keys differ, so that the order is unique; std::stable_sort needs more memory. Contacts with two images
    // of a particle differ in their points.
    std::sort(all.begin(), all.end(), [](const ContactRecord& a, const ContactRecord& b) {
        return std::tie(a.boundary, a.i, a.j, a.C.x, a.C.y, a.C.z) <
               std::tie(b.boundary, b.i, b.j, b.C.x, b.C.y, b.C.z);
    });
    return all;
}

Wrench World::wrench(const std::vector<ContactRecord>& contacts, int b, int replica) const
{
    std::vector<Wrench> on(boundaries.size());
    for (const ContactRecord& c : contacts)
        if (replica < 0 || c.replica == replica) add_wrench(on, c);
    return on[static_cast<std::size_t>(b)];
}

/// World::Totals of any parts, whose order has no influence; the stress is that over a volume of 1.
struct World::ExactTotals {
    struct ExactWrench {
        FixedVec F, T;
        ExactWrench& operator+=(const ExactWrench& o)
        {
            F += o.F, T += o.T;
            return *this;
        }
        Wrench value() const { return {F.value(), T.value()}; }
    };

    std::size_t contacts = 0;
    std::array<FixedSum, 9> stress = {};
    std::vector<ExactWrench> on_boundary;
    void put(Totals& to, double volume) const
    {
        to.contacts = contacts;
        for (std::size_t k = 0; k < stress.size(); ++k) to.stress[k] = stress[k].value() / volume;
        to.on_boundary.clear();
        for (const ExactWrench& on : on_boundary) to.on_boundary.push_back(on.value());
    }
};

/// Adds all contacts to the totals *to(number of the replica).
template <class To>
void World::add_totals(const To& to) const
{
    update_for_query();
    // Pairs are ordered by replica; a part has one sum for each replica in it.
    struct Sum {
        ExactTotals* to = nullptr;
        std::size_t contacts = 0;
        std::array<FixedSum, 9> stress = {};
        std::vector<std::pair<std::size_t, ExactTotals::ExactWrench>> on;  ///< by the number of a boundary

        ExactTotals::ExactWrench& operator[](std::size_t boundary)
        {
            for (auto& [number, sum] : on)
                if (number == boundary) return sum;
            return on.emplace_back(boundary, ExactTotals::ExactWrench()).second;
        }
    };
    /// Branch vectors and forces of contacts, by components
    struct Terms {
        double l[3][CurrentLoads::most], F[3][CurrentLoads::most], product[CurrentLoads::most];
        std::size_t count = 0;

        void add(const Vec3& branch, const Float4& force)
        {
            l[0][count] = branch.x, l[1][count] = branch.y, l[2][count] = branch.z;
            F[0][count] = force.x, F[1][count] = force.y, F[2][count] = force.z;
            ++count;
        }
        void finish(Sum& sum)
        {
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) {
                    for (std::size_t k = 0; k < count; ++k) product[k] = l[a][k] * F[b][k];
                    add_all(sum.stress[3 * a + b], product, count);
                }
            sum.contacts += count, count = 0;
        }
    };
    engine->each_piece(true, [&](const Piece& piece) {
        const Arrays<par::Cpu>& of = piece.arrays;
        const Float4* omega = of.particle.omega.data();
        const std::uint32_t* id = of.particle.id.data();
        std::vector<std::vector<Sum>> sums(CurrentLoads::parts(of.pairs.count));
        for_current_loads(of, [&](std::uint32_t part, const CurrentLoads& now) {
            std::vector<Sum> of_part;
            Terms terms;
            for (std::uint32_t n = now.begin; n < now.begin + now.count; ++n) {
                if (!now.touching(n)) continue;
                const std::uint32_t i = of.pairs.i.data()[n], j = of.pairs.j.data()[n];
                const Float4 F = now.load[n - now.begin].F;
                ExactTotals* const replica = to(of.particle.species.data()[i].replica);
                if (of_part.empty() || of_part.back().to != replica) {
                    if (!of_part.empty()) terms.finish(of_part.back());
                    of_part.emplace_back().to = replica;
                }
                Sum& sum = of_part.back();
                if ((j & PairView::boundary_bit) == 0) {
                    terms.add(
                        separation(domain.grid, of, n) - (offset_in_clump(id[i]) - offset_in_clump(id[j])),
                        F);
                    const bool fixed = !(omega[i].w > 0 && omega[j].w > 0);
                    if (!attached.empty() && fixed) add_wrench(sum, contact(now, n));
                } else {
                    const ContactRecord c = contact(now, n);
                    terms.add((of.particle.velocity.data()[i].w - c.delta) * c.n - offset_in_clump(id[i]), F);
                    add_wrench(sum, c);
                }
            }
            if (!of_part.empty()) terms.finish(of_part.back());
            sums[part] = std::move(of_part);
        });
        for (const std::vector<Sum>& of_part : sums)
            for (const Sum& sum : of_part) {
                sum.to->contacts += sum.contacts;
                for (std::size_t k = 0; k < 9; ++k) sum.to->stress[k] += sum.stress[k];
                for (const auto& [boundary, wrench] : sum.on) sum.to->on_boundary[boundary] += wrench;
            }
    });
}

World::Totals World::totals() const
{
    ExactTotals sum{
        .contacts = 0, .stress = {}, .on_boundary = std::vector<ExactTotals::ExactWrench>(boundaries.size())};
    add_totals([&](std::uint16_t) { return &sum; });
    Totals all;
    sum.put(all, volume());
    return all;
}

std::vector<World::ReplicaTotals> World::replica_totals() const
{
    std::vector<ReplicaTotals> all;
    const auto add = [](ReplicaTotals& sum, const Particle& p, const Vec3& w) {
        sum.kinetic_energy += 0.5 * p.mass * (p.v.dot(p.v) + 0.4 * p.radius * p.radius * p.omega.dot(w));
        sum.momentum += p.mass * p.v;
    };
    each_particle([&](const Particle& p) {
        if (p.replica >= all.size()) all.resize(p.replica + std::size_t{1});
        ReplicaTotals& sum = all[p.replica];
        ++sum.particles;
        if (p.clump < 0) {
            add(sum, p, p.omega);
        } else if (const std::uint32_t c = clump_of(p.id); p.clump == p.id && c != no_clump) {
            const ClumpState s = clump_state(c);
            add(sum, s.body, s.w);
        }
    });
    if (inserted_count > 0) all.resize(std::max<std::size_t>(all.size(), domain.replicas));
    std::vector<ExactTotals> sums(all.size());
    for (ExactTotals& sum : sums) sum.on_boundary.resize(boundaries.size());
    add_totals([&](std::uint16_t replica) { return &sums[replica]; });
    for (std::size_t k = 0; k < all.size(); ++k) sums[k].put(all[k], volume());
    return all;
}

}  // namespace hilda::granular
