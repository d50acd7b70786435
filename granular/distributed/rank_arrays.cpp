// SPDX-License-Identifier: GPL-3.0-or-later
// Distribution of the arrays of a world to the processes.
#include "granular/distributed/lists.hpp"
#include "granular/distributed/rank_engine.hpp"

#include <algorithm>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

/// The particles and contacts of a process
struct Portion {
    std::vector<ParticleRecord> particles;
    std::vector<std::uint32_t> partners;  ///< ids of the particles of other processes in the contacts
    /// i and j: places in `particles`, then in `partners`; j of a surface has PairView::boundary_bit
    std::vector<ContactHistory> contacts;
};

/// Numbers in the order of their processes; those of a process p are start[p] to start[p + 1] - 1.
struct Listed {
    std::vector<std::uint32_t> number, start;

    /// each(f) calls f(process, number), twice with the same calls.
    template <class Each>
    Listed(int processes, const Each& each) : start(static_cast<std::size_t>(processes) + 2)
    {
        each([&](int process, std::uint32_t) { ++start[static_cast<std::size_t>(process) + 2]; });
        for (std::size_t k = 2; k < start.size(); ++k) start[k] += start[k - 1];
        number.resize(start.back());
        each([&](int process, std::uint32_t n) {
            number[start[static_cast<std::size_t>(process) + 1]++] = n;
        });
    }
};

/// Calls f(process, portion) for all processes from the last to the first.
template <class F>
void each_portion(const Arrays<par::Cpu>& whole, bool keeps_list, int processes,
                  const std::vector<int>& owner, const F& f)
{
    const Particles<par::Cpu>& p = whole.particle;
    const Pairs<par::Cpu>& pairs = whole.pairs;
    const Listed particles(processes, [&](const auto& add) {
        for (std::uint32_t k = 0; k < p.count; ++k) add(owner[k], k);
    });
    const Listed contacts(processes, [&](const auto& add) {
        for (std::uint32_t n = 0; n < pairs.count; ++n) {
            if (pairs.in_contact.data()[n] == 0) continue;
            const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
            add(owner[i], n);
            if ((j & PairView::boundary_bit) == 0 && owner[j] != owner[i]) add(owner[j], n);
        }
    });
    std::vector<std::uint32_t> place(p.count, none), partners;
    Portion portion;
    for (int process = processes - 1; process >= 0; --process) {
        const auto of = static_cast<std::size_t>(process);
        portion.particles.clear(), portion.partners.clear(), portion.contacts.clear(), partners.clear();
        for (std::uint32_t m = particles.start[of]; m < particles.start[of + 1]; ++m) {
            place[particles.number[m]] = m - particles.start[of];
            ParticleRecord r = record_of(p, particles.number[m]);
            if (!keeps_list) r.position_at_build = r.position;
            portion.particles.push_back(r);
        }
        const auto place_of = [&](std::uint32_t k) {
            if (place[k] == none) {
                place[k] = static_cast<std::uint32_t>(portion.particles.size() + partners.size());
                partners.push_back(k), portion.partners.push_back(p.id.data()[k]);
            }
            return place[k];
        };
        for (std::uint32_t m = contacts.start[of]; m < contacts.start[of + 1]; ++m) {
            ContactHistory c = contact_of(pairs, contacts.number[m]);
            c.i = place_of(c.i);
            if ((c.j & PairView::boundary_bit) == 0) c.j = place_of(c.j);
            portion.contacts.push_back(c);
        }
        for (const std::uint32_t k : partners) place[k] = none;
        for (std::uint32_t m = particles.start[of]; m < particles.start[of + 1]; ++m)
            place[particles.number[m]] = none;
        f(process, portion);
    }
}

}  // namespace

/// The blocks with particles, with the number of particles as weights. Chooses the size of the blocks.
template <class Cell>
std::vector<BlockWork> RankEngine::loaded_blocks(const Particles<par::Cpu>& p, const CellGrid& g,
                                                 const Cell& cell, std::int32_t& size) const
{
    constexpr double most_blocks = 1 << 22;  // smaller blocks would need too much memory in a domain that is
                                             // almost empty
    constexpr std::size_t each = 64;         // blocks of a process
    std::vector<BlockWork> loaded;
    for (const std::int32_t shift : Partition::shifts) {
        const BlockGrid blocks(g, shift);
        if (!loaded.empty() && blocks.count() > most_blocks) break;
        size = shift;
        std::vector<float> weight(static_cast<std::size_t>(blocks.count()));
        for (std::uint32_t k = 0; k < p.count; ++k)
            ++weight[blocks.block_of(g.x_of(cell(k)), g.y_of(cell(k)), g.z_of(cell(k)))];
        loaded.clear();
        for (std::uint32_t b = 0; b < weight.size(); ++b)
            if (weight[b] > 0) loaded.push_back({b, weight[b]});
        if (loaded.size() >= each * static_cast<std::size_t>(all.size())) break;
    }
    return loaded;
}

void RankEngine::scatter(Arrays<par::Cpu>* whole, const Domain& domain, bool keeps_list)
{
    const CellGrid& g = domain.grid;
    struct Start {
        std::int32_t shift;
        bool keeps_division;
        UsedArrays used;
    } begin{};
    std::vector<BlockWork> loaded;
    const auto cell = [&](std::uint32_t k) {
        const Particles<par::Cpu>& p = whole->particle;
        return keeps_list ? p.position_at_build.data()[k].cell : p.position.data()[k].cell;
    };
    if (whole != nullptr) {
        const Particles<par::Cpu>& p = whole->particle;
        begin.used = {p.acc.size() > 0, p.orientation.size() > 0};
        // Insertions and outflow distribute the particles again and again.
        constexpr long most_steps = 1000;
        begin.shift = partition.grid().shift;
        begin.keeps_division = partition.is_for(g) && steps_since_division < most_steps;
        if (!begin.keeps_division) loaded = loaded_blocks(p, g, cell, begin.shift);
    }
    all.broadcast(&begin, sizeof begin);
    used = begin.used;
    if (!begin.keeps_division) {
        partition.make(g, begin.shift, loaded);
        surrounded.assign(static_cast<std::size_t>(partition.grid().count()), -1);
        present = past = {}, reported = 0;
        steps = periods = steps_reported = steps_since_division = 0;
    }

    const auto take = [&](const Portion& mine) {
        const auto particles = static_cast<std::uint32_t>(mine.particles.size()),
                   count = particles + static_cast<std::uint32_t>(mine.partners.size());
        resize(own.particle, count, used);
        own.particle.ghost.resize(count);
        for (std::uint32_t k = 0; k < count; ++k) {
            // The partners of other processes are placeholders until rebuild() finds them as ghosts.
            ParticleRecord partner;
            if (k >= particles) partner.id = mine.partners[k - particles];
            set_record(own.particle, k, k < particles ? mine.particles[k] : partner);
            own.particle.ghost.data()[k] = k < particles ? 0 : 1;
        }
        ContactList list;
        for (const ContactHistory& c : mine.contacts) list.add(c.i, c.j, c);
        list.put(own.pairs, rotation_laws, internal);
    };
    if (whole != nullptr) {
        owner.resize(whole->particle.count);
        for (std::uint32_t k = 0; k < owner.size(); ++k) owner[k] = owner_of(g, cell(k));
        each_portion(*whole, keeps_list, all.size(), owner, [&](int process, const Portion& portion) {
            if (process == all.rank()) return take(portion);
            all.send(process, portion.particles), all.send(process, portion.partners);
            all.send(process, portion.contacts);
        });
    } else {
        Portion mine;
        all.receive(0, mine.particles), all.receive(0, mine.partners), all.receive(0, mine.contacts);
        take(mine);
    }
    own.pairs.start.resize(0);
    find_attached();
    grid = g, replicas = domain.replicas;
    ghost_plan.reset();
}

}  // namespace hilda::granular
