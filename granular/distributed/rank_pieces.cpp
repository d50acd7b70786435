// SPDX-License-Identifier: GPL-3.0-or-later
// Collection of the arrays of all processes in the first one: as a whole, or in pieces.
#include "granular/distributed/lists.hpp"
#include "granular/distributed/packed_lists.hpp"
#include "granular/distributed/rank_engine.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

/// The particles of a process with their rows of the neighbour list
struct Rows {
    std::vector<ParticleRecord> particles;
    std::vector<ParticleRecord> partners;  ///< the particles in the rows that are in no process's `particles`
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint32_t> j;  ///< id, or surface with PairView::boundary_bit
    std::vector<std::uint8_t> law, in_contact;
    std::vector<Float4> history, rotation, internal;

    /// Calls f for each list.
    template <class F>
    void each(const F& f)
    {
        f(particles), f(partners), f(lengths), f(j), f(law), f(in_contact), f(history), f(rotation);
        f(internal);
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

/// Indices of particles by id: a table if the ids are dense, otherwise a sorted list
class Indices {
public:
    Indices(std::uint32_t largest_id, std::size_t particles)
    {
        if (largest_id / 4 <= particles) table.assign(std::size_t{largest_id} + 1, none);
    }
    void add(std::uint32_t id, std::uint32_t index)
    {
        if (table.empty())
            list.add(id, index);
        else
            table[id] = index;
    }
    void sort() { list.sort(); }
    std::uint32_t operator[](std::uint32_t id) const
    {
        return table.empty() ? list.find(id).value_or(none) : table[id];
    }

private:
    std::vector<std::uint32_t> table;
    Index list;
};

}  // namespace

/// Collects the own particles with these indices and those that the other processes name, with their rows of
/// the neighbour list. `is_here`: whether a particle, own or ghost, is one of them in some process; copies of
/// the others in the rows follow the particles. Returns the number of particles without these copies, in the
/// first process.
template <class IsHere>
std::uint32_t RankEngine::collect(Arrays<par::Cpu>* to, const std::vector<std::uint32_t>& which,
                                  const IsHere& is_here)
{
    Rows rows;
    const Pairs<par::Cpu>& q = own.pairs;
    const std::uint32_t *const id = own.particle.id.data(), *start = q.start.data();
    std::vector<std::uint32_t> of_contacts, partners;
    if (q.start.size() == 0) {  // before a search: the contacts, in the order of particles i
        sort_by_i(own.pairs);
        for (std::uint32_t k = 0, n = 0; k <= own.particle.count; ++k) {
            while (n < q.count && q.i.data()[n] < k) ++n;
            of_contacts.push_back(n);
        }
        start = of_contacts.data();
    }
    rows.particles.reserve(which.size()), rows.lengths.reserve(which.size());
    for (const std::uint32_t k : which) {
        rows.particles.push_back(record_of(own.particle, k));
        const std::uint32_t begin = start[k], end = start[k + 1];
        rows.lengths.push_back(end - begin);
        for (std::uint32_t n = begin; n < end; ++n) {
            const std::uint32_t j = q.j.data()[n];
            const bool is_surface = (j & PairView::boundary_bit) != 0;
            rows.j.push_back(is_surface ? j : id[j]);
            if (!is_surface && !is_here(j)) partners.push_back(j);
        }
        const auto append = [&](auto& list, const auto& from, bool has) {
            if (has) list.insert(list.end(), from.data() + begin, from.data() + end);
        };
        append(rows.law, q.law, !one_law && q.start.size() > 0), append(rows.in_contact, q.in_contact, true);
        append(rows.history, q.history, true), append(rows.rotation, q.rotation_history, rotation_laws);
        append(rows.internal, q.internal, internal);
    }
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    for (const std::uint32_t k : partners) rows.partners.push_back(record_of(own.particle, k));
    std::vector<Place> places;
    places.reserve(which.size());
    for (std::uint32_t n = 0; n < which.size(); ++n)
        places.push_back({.key = key_of(grid, own.particle.position_at_build.data()[which[n]].cell,
                                        rows.particles[n].species.replica),
                          .id = rows.particles[n].id,
                          .length = rows.lengths[n],
                          .process = static_cast<std::uint32_t>(all.rank()),
                          .number = n});
    if (!all.is_first()) {
        all.send(0, places);
        Lists lists;
        rows.each([&](const auto& list) { lists.add(list); });
        all.send(0, lists.bytes());
        return 0;
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

    const auto n = static_cast<std::uint32_t>(places.size());
    std::uint64_t all_pairs = 0;
    std::uint32_t largest_id = 0, pairs = 0;
    for (const Place& of : places) all_pairs += of.length, largest_id = std::max(largest_id, of.id);
    if (all_pairs >= PairView::boundary_bit) throw TooManyPairs();
    std::vector<std::uint32_t> place_of(n);  // by process and number
    Indices index(largest_id, n);
    Particles<par::Cpu>& p = to->particle;
    Pairs<par::Cpu>& pair = to->pairs;
    pair.start.resize(n + std::size_t{1});
    for (std::uint32_t k = 0; k < n; ++k) {
        const Place& of = places[k];
        place_of[first[of.process] + of.number] = k;
        index.add(of.id, k);
        pair.start.data()[k] = pairs;
        pairs += of.length;
    }
    index.sort();
    pair.start.data()[n] = pairs;
    pair.count = pairs;
    pair.i.resize(pairs), pair.j.resize(pairs);
    pair.law.resize(one_law ? 0 : pairs), pair.in_contact.resize(pairs), pair.history.resize(pairs);
    pair.rotation_history.resize(rotation_laws ? pairs : 0), pair.internal.resize(internal ? pairs : 0);
    resize(p, n, used);
    std::vector<ParticleRecord> copies;
    std::vector<std::uint32_t> unknown;  // pairs with such a j, which has its id
    for (int from = 0; from < all.size(); ++from) {
        if (from > 0) {
            std::string bytes;
            all.receive(from, bytes);
            Lists lists(std::move(bytes));
            rows.each([&](auto& list) { list = lists.next<std::decay_t<decltype(list[0])>>(); });
        }
        copies.insert(copies.end(), rows.partners.begin(), rows.partners.end());
        std::uint32_t begin = 0;
        for (std::uint32_t number = 0; number < rows.particles.size(); ++number) {
            const std::uint32_t k = place_of[first[static_cast<std::size_t>(from)] + number],
                                end = begin + rows.lengths[number];
            set_record(p, k, rows.particles[number]);
            for (std::uint32_t at = pair.start.data()[k]; begin < end; ++begin, ++at) {
                std::uint32_t j = rows.j[begin];
                if ((j & PairView::boundary_bit) == 0) {
                    const std::uint32_t found = j <= largest_id ? index[j] : none;
                    if (found == none) unknown.push_back(at);
                    j = found == none ? j : found;
                }
                pair.i.data()[at] = k, pair.j.data()[at] = j;
                if (!one_law)
                    pair.law.data()[at] = begin < rows.law.size() ? rows.law[begin] : std::uint8_t{0};
                pair.in_contact.data()[at] = rows.in_contact[begin];
                pair.history.data()[at] = rows.history[begin];
                if (rotation_laws) pair.rotation_history.data()[at] = rows.rotation[begin];
                if (internal) pair.internal.data()[at] = rows.internal[begin];
            }
        }
    }
    if (copies.empty()) return n;

    const auto by_id = [](const ParticleRecord& a, const ParticleRecord& b) { return a.id < b.id; };
    std::sort(copies.begin(), copies.end(), by_id);
    const auto same = [](const ParticleRecord& a, const ParticleRecord& b) { return a.id == b.id; };
    copies.erase(std::unique(copies.begin(), copies.end(), same), copies.end());
    std::vector<ParticleRecord> here;
    here.reserve(n);
    for (std::uint32_t k = 0; k < n; ++k) here.push_back(record_of(p, k));
    resize(p, n + static_cast<std::uint32_t>(copies.size()), used);
    for (std::uint32_t k = 0; k < n; ++k) set_record(p, k, here[k]);
    for (std::uint32_t k = 0; k < copies.size(); ++k) set_record(p, n + k, copies[k]);
    for (const std::uint32_t at : unknown) {
        const auto found =
            std::lower_bound(copies.begin(), copies.end(), ParticleRecord{.id = pair.j.data()[at]}, by_id);
        if (found == copies.end()) throw std::logic_error("a partner of a contact is not known");
        pair.j.data()[at] = n + static_cast<std::uint32_t>(found - copies.begin());
    }
    return n;
}

void RankEngine::gather(Arrays<par::Cpu>* whole)
{
    std::vector<std::uint32_t> which;
    for (std::uint32_t k = 0; k < own.particle.count; ++k)
        if (!is_ghost(k)) which.push_back(k);
    collect(whole, which, [](std::uint32_t) { return true; });
}

std::vector<std::uint64_t> RankEngine::sort_into_groups(std::uint32_t ids)
{
    constexpr std::uint64_t most_groups = 1 << 16;
    const auto n = [&](int axis) { return static_cast<std::uint64_t>(grid.cells[axis]); };
    groups_are_of_ids = ids > 0;
    const std::uint64_t numbers = groups_are_of_ids ? ids : n(0) * n(1) * n(2) * replicas;
    numbers_of_group = numbers / most_groups + 1;
    const std::size_t groups = numbers / numbers_of_group + 1;
    std::vector<std::uint64_t> number(groups);
    group_start.assign(groups + 1, 0);
    for (std::uint32_t k = 0; k < own.particle.count; ++k)
        if (!is_ghost(k)) ++number[group_of(k)];
    for (std::size_t g = 0; g < groups; ++g)
        group_start[g + 1] = group_start[g] + static_cast<std::uint32_t>(number[g]);
    grouped.resize(group_start.back());
    std::vector<std::uint32_t> next = group_start;
    for (std::uint32_t k = 0; k < own.particle.count; ++k)
        if (!is_ghost(k)) grouped[next[group_of(k)]++] = k;
    all.reduce(number.data(), number.size());
    return number;
}

std::size_t RankEngine::group_of(std::uint32_t k) const
{
    const Particles<par::Cpu>& p = own.particle;
    const std::uint64_t number =
        groups_are_of_ids ? p.id.data()[k]
                          : key_of(grid, p.position_at_build.data()[k].cell, p.species.data()[k].replica);
    return number / numbers_of_group;
}

std::uint32_t RankEngine::gather_groups(Arrays<par::Cpu>* piece, std::size_t first, std::size_t last,
                                        bool with_pairs)
{
    const auto at = [&](std::size_t g) {
        return grouped.begin() + static_cast<std::ptrdiff_t>(group_start[g]);
    };
    const std::vector<std::uint32_t> which(at(first), at(last));
    if (!with_pairs) return collect_particles(piece, which);
    return collect(piece, which, [&](std::uint32_t k) {
        const std::size_t g = group_of(k);
        return g >= first && g < last;
    });
}

/// Collects the own particles with these indices and those that the other processes name.
std::uint32_t RankEngine::collect_particles(Arrays<par::Cpu>* to, const std::vector<std::uint32_t>& which)
{
    std::vector<ParticleRecord> records;
    records.reserve(which.size());
    for (const std::uint32_t k : which) records.push_back(record_of(own.particle, k));
    if (!all.is_first()) {
        all.send(0, records);
        return 0;
    }
    std::vector<ParticleRecord> of_other;
    for (int from = 1; from < all.size(); ++from) {
        all.receive(from, of_other);
        records.insert(records.end(), of_other.begin(), of_other.end());
    }
    const auto n = static_cast<std::uint32_t>(records.size());
    resize(to->particle, n, used);
    for (std::uint32_t k = 0; k < n; ++k) set_record(to->particle, k, records[k]);
    return n;
}

std::size_t RankEngine::pair_count()
{
    std::uint64_t pairs = 0;
    for (std::uint32_t n = 0; n < own.pairs.count; ++n) pairs += is_ghost(own.pairs.i.data()[n]) ? 0 : 1;
    return all.reduced(pairs);
}

bool RankEngine::is_finite()
{
    const bool own_is = granular::is_finite(own.particle, own.pairs, [&](auto k) { return !is_ghost(k); });
    return all.reduced(std::uint64_t{own_is ? 0u : 1u}) == 0;
}

}  // namespace hilda::granular
