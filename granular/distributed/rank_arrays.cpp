// SPDX-License-Identifier: GPL-3.0-or-later
// Distribution of the arrays of a world to the processes, and their collection.
#include "granular/distributed/lists.hpp"
#include "granular/distributed/rank_engine.hpp"

#include <algorithm>
#include <utility>

namespace hilda::granular {

using namespace detail;

void RankEngine::scatter(Arrays<par::Cpu>* whole, const Domain& domain, bool keeps_list)
{
    const CellGrid& g = domain.grid;
    struct Sizes {
        std::uint32_t edge, particles;
        UsedArrays used;
    } sizes{};
    std::vector<BlockWork> loaded;
    const auto cell = [&](std::uint32_t k) {
        const Particles<par::Cpu>& p = whole->particle;
        return keeps_list ? p.position_at_build.data()[k].cell : p.position.data()[k].cell;
    };
    if (whole != nullptr) {
        Particles<par::Cpu>& p = whole->particle;
        if (!keeps_list) {
            p.position_at_build.resize(p.count);
            std::copy_n(p.position.data(), p.count, p.position_at_build.data());
        }
        sizes.particles = p.count;
        sizes.used = {p.acc.size() > 0, p.orientation.size() > 0};
        for (const std::int32_t edge : Partition::edges) {
            const BlockGrid blocks(g, edge);
            sizes.edge = static_cast<std::uint32_t>(edge);
            std::vector<float> weight(static_cast<std::size_t>(blocks.count()));
            for (std::uint32_t k = 0; k < p.count; ++k)
                ++weight[blocks.block_of(g.x_of(cell(k)), g.y_of(cell(k)), g.z_of(cell(k)))];
            loaded.clear();
            for (std::uint32_t b = 0; b < weight.size(); ++b)
                if (weight[b] > 0) loaded.push_back({b, weight[b]});
            constexpr std::size_t each = 64;  // blocks of a process
            if (loaded.size() >= each * static_cast<std::size_t>(all.size())) break;
        }
    }
    all.broadcast(&sizes, sizeof sizes);
    used = sizes.used;
    partition.make(BlockGrid(g, static_cast<std::int32_t>(sizes.edge)), loaded);
    surrounded.assign(static_cast<std::size_t>(partition.grid().count()), -1);

    Addressed<ParticleRecord> particles;
    Addressed<ContactHistory> contacts;
    if (whole != nullptr) {
        const Particles<par::Cpu>& p = whole->particle;
        const Pairs<par::Cpu>& pairs = whole->pairs;
        std::vector<int> owner(p.count);
        particles.reserve(p.count);
        for (std::uint32_t k = 0; k < p.count; ++k) {
            owner[k] = owner_of(g, cell(k));
            particles.emplace_back(owner[k], record_of(p, k));
        }
        for (std::uint32_t n = 0; n < pairs.count; ++n) {
            if (pairs.in_contact.data()[n] == 0) continue;
            const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
            const ContactHistory c = contact_of(pairs, p.id.data(), n);
            contacts.emplace_back(owner[i], c);
            if ((j & PairView::boundary_bit) == 0 && owner[j] != owner[i]) contacts.emplace_back(owner[j], c);
        }
    }
    const std::vector<ParticleRecord> mine = exchanged(all, particles);
    const std::vector<ContactHistory> with_mine = exchanged(all, contacts);

    // All particles of the contacts; the partners of other processes are placeholders until rebuild() finds
    // them as ghosts.
    Index index;
    for (std::uint32_t k = 0; k < mine.size(); ++k) index.add(mine[k].id, k);
    index.sort();
    std::vector<std::uint32_t> partners;
    for (const ContactHistory& c : with_mine)
        for (const std::uint32_t id : {c.i, c.j})
            if ((id & PairView::boundary_bit) == 0 && !index.find(id)) partners.push_back(id);
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    const auto count = static_cast<std::uint32_t>(mine.size() + partners.size());
    resize(own.particle, count, used);
    own.particle.ghost.resize(count);
    for (std::uint32_t k = 0; k < mine.size(); ++k)
        set_record(own.particle, k, mine[k]), own.particle.ghost.data()[k] = 0;
    for (std::uint32_t k = 0; k < partners.size(); ++k) {
        const auto at = static_cast<std::uint32_t>(mine.size()) + k;
        ParticleRecord placeholder;
        placeholder.id = partners[k];
        set_record(own.particle, at, placeholder), own.particle.ghost.data()[at] = 1;
        index.add(partners[k], at);
    }
    index.sort();
    ContactList list;
    for (const ContactHistory& c : with_mine)
        list.add(*index.find(c.i), (c.j & PairView::boundary_bit) != 0 ? c.j : *index.find(c.j), c);
    list.put(own.pairs, rotation_laws, internal);
    own.pairs.start.resize(0);
    grid = g;
    ghost_plan.reset();
    busy = work = 0, steps = 0;
}

namespace {

/// The particles of a process with their rows of the neighbour list
struct Rows {
    std::vector<ParticleRecord> particles;
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint32_t> j;  ///< id, or surface with PairView::boundary_bit
    std::vector<std::uint8_t> law, in_contact;
    std::vector<Float4> history, rotation, internal;
};

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
    if (!all.is_first()) {
        all.send_to_first(rows.particles), all.send_to_first(rows.lengths), all.send_to_first(rows.j);
        all.send_to_first(rows.law), all.send_to_first(rows.in_contact), all.send_to_first(rows.history);
        all.send_to_first(rows.rotation), all.send_to_first(rows.internal);
        return;
    }

    std::vector<Rows> of(static_cast<std::size_t>(all.size()));
    of[0] = std::move(rows);
    for (int from = 1; from < all.size(); ++from) {
        Rows& r = of[static_cast<std::size_t>(from)];
        r.particles = all.received<ParticleRecord>(from), r.lengths = all.received<std::uint32_t>(from);
        r.j = all.received<std::uint32_t>(from), r.law = all.received<std::uint8_t>(from);
        r.in_contact = all.received<std::uint8_t>(from), r.history = all.received<Float4>(from);
        r.rotation = all.received<Float4>(from), r.internal = all.received<Float4>(from);
    }
    // The order of a single process: that of the cells of the last search, then of the ids
    struct Place {
        std::uint64_t key;
        std::uint32_t id, process, number, begin;  ///< begin: first pair of its row in the lists
        bool operator<(const Place& o) const { return std::pair(key, id) < std::pair(o.key, o.id); }
    };
    std::vector<Place> places;
    std::uint32_t largest_id = 0;
    std::size_t pairs = 0;
    for (std::uint32_t from = 0; from < of.size(); ++from) {
        const auto begin = static_cast<std::ptrdiff_t>(places.size());
        std::uint32_t first_pair = 0;
        for (std::uint32_t k = 0; k < of[from].particles.size(); ++k) {
            const ParticleRecord& r = of[from].particles[k];
            places.push_back(
                {key_of(grid, r.position_at_build.cell, r.species.replica), r.id, from, k, first_pair});
            first_pair += of[from].lengths[k];
            largest_id = std::max(largest_id, r.id);
        }
        pairs += first_pair;
        std::inplace_merge(places.begin(), places.begin() + begin, places.end());
    }
    std::vector<std::uint32_t> index(places.empty() ? 0 : std::size_t{largest_id} + 1, none);
    Particles<par::Cpu>& p = whole->particle;
    Pairs<par::Cpu>& to = whole->pairs;
    const auto n = static_cast<std::uint32_t>(places.size());
    resize(p, n, used);
    to.count = static_cast<std::uint32_t>(pairs);
    to.start.resize(n + std::size_t{1}), to.i.resize(pairs), to.j.resize(pairs);
    to.law.resize(one_law ? 0 : pairs), to.in_contact.resize(pairs), to.history.resize(pairs);
    to.rotation_history.resize(rotation_laws ? pairs : 0), to.internal.resize(internal ? pairs : 0);
    for (std::uint32_t k = 0; k < n; ++k) {
        index[places[k].id] = k;
        set_record(p, k, of[places[k].process].particles[places[k].number]);
    }
    std::uint32_t pair = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
        const Rows& r = of[places[k].process];
        to.start.data()[k] = pair;
        const std::uint32_t begin = places[k].begin, end = begin + r.lengths[places[k].number];
        for (std::uint32_t from = begin; from < end; ++from, ++pair) {
            const std::uint32_t j = r.j[from];
            to.i.data()[pair] = k;
            to.j.data()[pair] = (j & PairView::boundary_bit) != 0 ? j : index[j];
            if (!one_law) to.law.data()[pair] = from < r.law.size() ? r.law[from] : std::uint8_t{0};
            to.in_contact.data()[pair] = r.in_contact[from], to.history.data()[pair] = r.history[from];
            if (rotation_laws) to.rotation_history.data()[pair] = r.rotation[from];
            if (internal) to.internal.data()[pair] = r.internal[from];
        }
    }
    to.start.data()[n] = pair;
}

}  // namespace hilda::granular
