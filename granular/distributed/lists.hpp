// SPDX-License-Identifier: GPL-3.0-or-later
/// Lists of particles and contacts that go from one process to another.

#pragma once

#include "granular/distributed/plan.hpp"
#include "granular/distributed/records.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace hilda::granular::detail {

/// Number of a cell in the order of replicas, z, y, x
inline std::uint64_t key_of(const CellGrid& g, std::uint32_t cell, std::uint16_t replica)
{
    const auto n = [&](int k) { return static_cast<std::uint64_t>(g.cells[k]); };
    return ((replica * n(2) + static_cast<std::uint64_t>(g.z_of(cell))) * n(1) +
            static_cast<std::uint64_t>(g.y_of(cell))) *
               n(0) +
           static_cast<std::uint64_t>(g.x_of(cell));
}

/// A value and the process to which it goes
template <class T>
using Addressed = std::vector<std::pair<int, T>>;

/// Sends the values and returns those of the other processes.
template <class T>
std::vector<T> exchanged(const Communicator& all, const Addressed<T>& values)
{
    // a counting sort by process
    std::vector<std::size_t> place(static_cast<std::size_t>(all.size()) + 1);
    for (const auto& value : values) ++place[static_cast<std::size_t>(value.first) + 1];
    for (std::size_t k = 1; k < place.size(); ++k) place[k] += place[k - 1];
    std::vector<int> to(values.size());
    std::vector<T> of(values.size());
    for (const auto& [process, value] : values) {
        const std::size_t at = place[static_cast<std::size_t>(process)]++;
        to[at] = process, of[at] = value;
    }
    return Plan(all, std::move(to)).exchange(of);
}

template <class T>
void assign(par::Array<par::Cpu, T>& to, const std::vector<T>& from)
{
    to.resize(from.size());
    std::copy(from.begin(), from.end(), to.data());
}

/// Keeps the first `kept` elements and adds others.
template <class T>
void append(par::Array<par::Cpu, T>& to, std::size_t kept, const std::vector<T>& added)
{
    const std::size_t n = kept + added.size();
    if (n * sizeof(T) > to.bytes()) {
        const std::vector<T> before(to.data(), to.data() + kept);
        to.resize(n);
        std::copy(before.begin(), before.end(), to.data());
    }
    to.resize(n);
    std::copy(added.begin(), added.end(), to.data() + kept);
}

/// Keeps the particles with these indices, which ascend, and adds others.
inline void replace(Particles<par::Cpu>& p, const std::vector<std::uint32_t>& kept,
                    const std::vector<ParticleRecord>& added, const UsedArrays& used)
{
    const auto one = [&](auto& array, auto member) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        keep(array, kept);
        std::vector<T> values;
        values.reserve(added.size());
        for (const ParticleRecord& r : added) values.push_back(r.*member);
        append(array, kept.size(), values);
    };
    using R = ParticleRecord;
    one(p.position, &R::position), one(p.position_at_build, &R::position_at_build);
    one(p.velocity, &R::velocity), one(p.omega, &R::omega), one(p.compensation, &R::compensation);
    one(p.species, &R::species), one(p.id, &R::id);
    if (used.acceleration) one(p.acc, &R::acc), one(p.alpha, &R::alpha);
    if (used.orientation)
        one(p.orientation, &R::orientation), one(p.orientation_compensation, &R::orientation_compensation);
    p.count = static_cast<std::uint32_t>(kept.size() + added.size());
    p.ghost.resize(p.count);
}

/// Contacts with the indices of their particles
struct ContactList {
    std::vector<std::uint32_t> i, j;
    std::vector<Float4> history, rotation, internal;

    void add(std::uint32_t of_i, std::uint32_t of_j, const ContactHistory& c)
    {
        i.push_back(of_i), j.push_back(of_j);
        history.push_back(c.history), rotation.push_back(c.rotation), internal.push_back(c.internal);
    }
    /// As the contacts of a list before a neighbour search
    void put(Pairs<par::Cpu>& pairs, bool has_rotation, bool has_internal) const
    {
        pairs.count = static_cast<std::uint32_t>(i.size());
        assign(pairs.i, i), assign(pairs.j, j), assign(pairs.history, history);
        if (has_rotation)
            assign(pairs.rotation_history, rotation);
        else
            pairs.rotation_history.resize(0);
        if (has_internal)
            assign(pairs.internal, internal);
        else
            pairs.internal.resize(0);
        pairs.in_contact.resize(i.size());
        par::fill(par::Cpu(), pairs.in_contact.data(), i.size(), std::uint8_t{1});
    }
};

/// A contact with the indices of its particles
inline ContactHistory contact_of(const Pairs<par::Cpu>& pairs, std::uint32_t n)
{
    return {.i = pairs.i.data()[n],
            .j = pairs.j.data()[n],
            .history = pairs.history.data()[n],
            .rotation = value_of(pairs.rotation_history, n),
            .internal = value_of(pairs.internal, n)};
}
/// A contact with the ids of its particles
inline ContactHistory contact_of(const Pairs<par::Cpu>& pairs, const std::uint32_t* id, std::uint32_t n)
{
    ContactHistory c = contact_of(pairs, n);
    c.i = id[c.i];
    if ((c.j & PairView::boundary_bit) == 0) c.j = id[c.j];
    return c;
}

/// Indices of particles by id
class Index {
public:
    void add(std::uint32_t id, std::uint32_t index) { entries.emplace_back(id, index); }
    void sort() { std::sort(entries.begin(), entries.end()); }
    std::optional<std::uint32_t> find(std::uint32_t id) const
    {
        const auto at = std::lower_bound(entries.begin(), entries.end(), std::pair(id, std::uint32_t{0}));
        if (at == entries.end() || at->first != id) return {};
        return at->second;
    }

private:
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;
};

constexpr std::uint32_t none = ~std::uint32_t{0};

}  // namespace hilda::granular::detail
