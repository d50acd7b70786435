// SPDX-License-Identifier: GPL-3.0-or-later
// Distribution of the arrays of a world to the processes, and their collection.
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
    grid = g;
    ghost_plan.reset();
}

namespace {

/// The particles of a process with their rows of the neighbour list
struct Rows {
    std::vector<ParticleRecord> particles;
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint32_t> j;  ///< id, or surface with PairView::boundary_bit
    std::vector<std::uint8_t> law, in_contact;
    std::vector<Float4> history, rotation, internal;

    /// Calls f for each list.
    template <class F>
    void each(const F& f)
    {
        f(particles), f(lengths), f(j), f(law), f(in_contact), f(history), f(rotation), f(internal);
    }
};

/// The place of a particle in the order of a single process: that of the cells of the last search, then of
/// the ids
struct Place {
    std::uint64_t key = 0;
    std::uint32_t id = 0, length = 0;       ///< length of its row
    std::uint32_t process = 0, number = 0;  ///< number in the Rows of its process
    bool operator<(const Place& o) const { return std::pair(key, id) < std::pair(o.key, o.id); }
};

/// Sorts runs that are in order: from ends[k] to ends[k + 1] - 1.
void merge(std::vector<Place>& places, std::vector<std::size_t> ends)
{
    const auto at = [&](std::size_t n) { return places.begin() + static_cast<std::ptrdiff_t>(n); };
    while (ends.size() > 2) {
        std::vector<std::size_t> merged = {0};
        for (std::size_t k = 2; k < ends.size(); k += 2) {
            std::inplace_merge(at(ends[k - 2]), at(ends[k - 1]), at(ends[k]));
            merged.push_back(ends[k]);
        }
        if (ends.size() % 2 == 0) merged.push_back(ends.back());
        ends = std::move(merged);
    }
}

/// Sorts contacts by their particles i.
void sort_by_i(Pairs<par::Cpu>& pairs)
{
    std::vector<std::uint32_t> order(pairs.count);
    for (std::uint32_t n = 0; n < pairs.count; ++n) order[n] = n;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return pairs.i.data()[a] < pairs.i.data()[b]; });
    const auto permute = [&](auto& array) {
        std::remove_reference_t<decltype(array)> sorted(array.size());
        for (std::uint32_t n = 0; n < array.size(); ++n) sorted.data()[n] = array.data()[order[n]];
        array = std::move(sorted);
    };
    permute(pairs.i), permute(pairs.j), permute(pairs.history), permute(pairs.rotation_history);
    permute(pairs.internal);
}

}  // namespace

void RankEngine::gather(Arrays<par::Cpu>* whole)
{
    Rows rows;
    const Pairs<par::Cpu>& q = own.pairs;
    const std::uint32_t *const id = own.particle.id.data(), *start = q.start.data();
    std::vector<std::uint32_t> of_contacts;
    if (q.start.size() == 0) {  // before the first search: the contacts, in the order of their particles i
        sort_by_i(own.pairs);
        for (std::uint32_t k = 0, n = 0; k <= own.particle.count; ++k) {
            while (n < q.count && q.i.data()[n] < k) ++n;
            of_contacts.push_back(n);
        }
        start = of_contacts.data();
    }
    for (std::uint32_t k = 0; k < own.particle.count; ++k) {
        if (is_ghost(k)) continue;
        rows.particles.push_back(record_of(own.particle, k));
        const std::uint32_t begin = start[k], end = start[k + 1];
        rows.lengths.push_back(end - begin);
        for (std::uint32_t n = begin; n < end; ++n) {
            const std::uint32_t j = q.j.data()[n];
            rows.j.push_back((j & PairView::boundary_bit) != 0 ? j : id[j]);
        }
        const auto append = [&](auto& to, const auto& from, bool has) {
            if (has) to.insert(to.end(), from.data() + begin, from.data() + end);
        };
        append(rows.law, q.law, !one_law && q.start.size() > 0), append(rows.in_contact, q.in_contact, true);
        append(rows.history, q.history, true), append(rows.rotation, q.rotation_history, rotation_laws);
        append(rows.internal, q.internal, internal);
    }
    std::vector<Place> places;
    places.reserve(rows.particles.size());
    for (std::uint32_t k = 0; k < rows.particles.size(); ++k) {
        const ParticleRecord& r = rows.particles[k];
        places.push_back({.key = key_of(grid, r.position_at_build.cell, r.species.replica),
                          .id = r.id,
                          .length = rows.lengths[k],
                          .process = static_cast<std::uint32_t>(all.rank()),
                          .number = k});
    }
    if (!all.is_first()) {
        all.send(0, places);
        rows.each([&](const auto& list) { all.send(0, list); });
        return;
    }

    std::vector<std::size_t> ends = {0, places.size()};
    for (int from = 1; from < all.size(); ++from) {
        std::vector<Place> of;
        all.receive(from, of);
        places.insert(places.end(), of.begin(), of.end());
        ends.push_back(places.size());
    }
    const std::vector<std::size_t> first = ends;  // particle of each process
    merge(places, std::move(ends));

    Particles<par::Cpu>& p = whole->particle;
    Pairs<par::Cpu>& to = whole->pairs;
    const auto n = static_cast<std::uint32_t>(places.size());
    std::uint64_t all_pairs = 0;
    for (const Place& of : places) all_pairs += of.length;
    if (all_pairs >= PairView::boundary_bit) throw TooManyPairs();
    std::uint32_t largest_id = 0, pairs = 0;
    std::vector<std::uint32_t> place_of(n);  // by process and number
    to.start.resize(n + std::size_t{1});
    for (std::uint32_t k = 0; k < n; ++k) {
        const Place& of = places[k];
        place_of[first[of.process] + of.number] = k;
        to.start.data()[k] = pairs;
        pairs += of.length, largest_id = std::max(largest_id, of.id);
    }
    to.start.data()[n] = pairs;
    std::vector<std::uint32_t> index(n == 0 ? 0 : std::size_t{largest_id} + 1, none);
    for (std::uint32_t k = 0; k < n; ++k) index[places[k].id] = k;
    resize(p, n, used);
    to.count = pairs;
    to.i.resize(pairs), to.j.resize(pairs);
    to.law.resize(one_law ? 0 : pairs), to.in_contact.resize(pairs), to.history.resize(pairs);
    to.rotation_history.resize(rotation_laws ? pairs : 0), to.internal.resize(internal ? pairs : 0);
    for (int from = 0; from < all.size(); ++from) {
        if (from > 0) rows.each([&](auto& list) { all.receive(from, list); });
        std::uint32_t begin = 0;
        for (std::uint32_t number = 0; number < rows.particles.size(); ++number) {
            const std::uint32_t k = place_of[first[static_cast<std::size_t>(from)] + number],
                                end = begin + rows.lengths[number];
            set_record(p, k, rows.particles[number]);
            for (std::uint32_t pair = to.start.data()[k]; begin < end; ++begin, ++pair) {
                const std::uint32_t j = rows.j[begin];
                to.i.data()[pair] = k;
                to.j.data()[pair] = (j & PairView::boundary_bit) != 0 ? j : index[j];
                if (!one_law)
                    to.law.data()[pair] = begin < rows.law.size() ? rows.law[begin] : std::uint8_t{0};
                to.in_contact.data()[pair] = rows.in_contact[begin];
                to.history.data()[pair] = rows.history[begin];
                if (rotation_laws) to.rotation_history.data()[pair] = rows.rotation[begin];
                if (internal) to.internal.data()[pair] = rows.internal[begin];
            }
        }
    }
}

}  // namespace hilda::granular
