// SPDX-License-Identifier: GPL-3.0-or-later
// The member functions of Neighbours for any back end.
#pragma once

#include "granular/core/neighbours/saved_contacts.hpp"
#include "granular/core/neighbours/search.hpp"

#include <algorithm>
#include <bit>

namespace hilda::granular {

template <class Backend>
std::size_t Neighbours<Backend>::bytes() const
{
    return key.bytes() + order.bytes() + new_index.bytes() + cell_start.bytes() + counts.bytes() +
           scratch.bytes() + saved.bytes() + saved_rotation.bytes() + saved_internal.bytes() +
           saved_apart.bytes() + saved_count.bytes();
}

template <class Backend>
void Neighbours<Backend>::sort(const SearchInput& input, Particles<Backend>& p)
{
    const Backend on;
    const std::uint32_t n = p.count;
    const CellGrid& g = input.domain.grid;
    const auto cells =
        static_cast<std::uint32_t>(g.cells[0]) * g.cells[1] * g.cells[2] * input.domain.replicas;
    key.resize(n), order.resize(n), new_index.resize(n);
    scratch.resize(n + detail::SearchedRows<Backend>::padding);
    par::for_each(on, n,
                  detail::AssignCell{g, p.position.data(), p.species.data(), key.data(), order.data(),
                                     input.clump_of, p.id.data()});
    par::stable_sort_by_key(on, key.data(), order.data(), n, std::bit_width(cells));
    if (n > 0) {
        std::uint32_t last = 0;
        par::copy_to_host(on, &last, key.data() + n - 1, sizeof last);
        if (last == detail::outside_domain) {
            std::uint32_t k = 0, id = 0;
            par::copy_to_host(on, &k, order.data() + n - 1, sizeof k);
            par::copy_to_host(on, &id, p.id.data() + k, sizeof id);
            throw LeftDomain{id};
        }
    }
    par::for_each(on, n, detail::SortCells{key.data(), p.id.data(), n, order.data()});
    const auto permute = [&](auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        static_assert(sizeof(T) <= sizeof(Float4));
        auto* to = reinterpret_cast<T*>(scratch.data());
        par::gather(on, to, array.data(), order.data(), n);
        par::copy_bytes(on, array.data(), to, n * sizeof(T));
    };
    permute(p.position), permute(p.velocity), permute(p.omega), permute(p.compensation), permute(p.species),
        permute(p.id);
    if (p.acc.size() > 0) permute(p.acc), permute(p.alpha);
    if (p.orientation.size() > 0) permute(p.orientation), permute(p.orientation_compensation);
    if (p.ghost.size() > 0) permute(p.ghost);
    p.position_at_build.resize(n);
    par::copy_bytes(on, p.position_at_build.data(), p.position.data(), n * sizeof(Position));
    par::for_each(on, n, detail::Invert{order.data(), new_index.data()});

    for (shift = 0; cells >> shift > 4 * std::uint64_t{n} + 4096; ++shift) continue;
    const std::uint32_t groups = (cells >> shift) + 1;
    cell_start.resize(groups + 1);
    if constexpr (std::is_same_v<Backend, par::Cpu>)
        par::for_each(on, n + 1, detail::MarkCellStarts{key.data(), n, groups, shift, cell_start.data()});
    else
        par::for_each(on, groups + 1, detail::FindCellStart{key.data(), n, shift, cell_start.data()});
}

template <class Backend>
std::uint32_t Neighbours<Backend>::save(const Pairs<Backend>& pairs, const ParticleView& particles,
                                        bool rotation, bool internal, bool images)
{
    const Backend on;
    const PairView view{.i = pairs.i.data(),
                        .j = pairs.j.data(),
                        .law = nullptr,
                        .history = pairs.history.data(),
                        .rotation_history = pairs.rotation_history.data(),
                        .load = nullptr,
                        .torque = nullptr,
                        .in_contact = pairs.in_contact.data(),
                        .count = pairs.count,
                        .internal = pairs.internal.data(),
                        .image = pairs.image.size() > 0 ? pairs.image.data() : nullptr};
    const auto each_block = [&](SavedContact* to, Float4* of_rotation, Float4* of_internal,
                                Difference* apart) {
        constexpr std::uint32_t block = detail::SaveContacts::block;
        saved_count.resize(1);
        par::fill(on, saved_count.data(), 1, 0u);
        par::for_each(
            on, (pairs.count + block - 1) / block,
            detail::SaveContacts{view, saved_count.data(), to, of_rotation, of_internal, particles, apart});
    };
    each_block(nullptr, nullptr, nullptr, nullptr);
    std::uint32_t contacts = 0;
    par::copy_to_host(on, &contacts, saved_count.data(), sizeof contacts);
    saved.resize(contacts), saved_rotation.resize(rotation ? contacts : 0);
    saved_internal.resize(internal ? contacts : 0), saved_apart.resize(images ? contacts : 0);
    if (contacts > 0)
        each_block(saved.data(), rotation ? saved_rotation.data() : nullptr,
                   internal ? saved_internal.data() : nullptr, images ? saved_apart.data() : nullptr);
    return contacts;
}

template <class Backend>
void Neighbours<Backend>::find(const SearchInput& input, Particles<Backend>& p, Pairs<Backend>& pairs)
{
    const Backend on;
    const std::uint32_t n = p.count;
    const bool had_rotation = input.rotation_laws && pairs.rotation_history.size() > 0,
               had_internal = input.internal && pairs.internal.size() > 0;
    const Domain& domain = input.domain;
    const bool has_images = domain.has_images();
    const std::uint32_t contacts =
        save(pairs, particle_view(domain, p), had_rotation, had_internal, has_images);
    sort(input, p);

    const detail::Search<Backend> search{
        .grid = domain.grid,
        .position = p.position.data(),
        .velocity = p.velocity.data(),
        .omega = p.omega.data(),
        .species = p.species.data(),
        .cell_start = {key.data(), cell_start.data(), shift},
        .unit = static_cast<float>(domain.grid.unit),
        .skin = domain.skin,
        .small = domain.small,
        .largest = domain.largest,
        .surfaces = input.surfaces,
        .near = input.near,
        .rows = {p.position.data(), p.velocity.data(), n, domain, scratch.data()},
        .clump_of = input.clump_of,
        .id = p.id.data(),
        .ghost = p.ghost.size() > 0 ? p.ghost.data() : nullptr,
        .has_images = has_images,
        .short_axis = {domain.is_short(0) ? 1 : 0, domain.is_short(1) ? 1 : 0, domain.is_short(2) ? 1 : 0}};
    counts.resize(n);
    pairs.start.resize(n + 1);
    // The histories have been saved. Their memory keeps the partners that are found.
    static_assert(sizeof(Float4) % sizeof(std::uint32_t) == 0);
    const detail::FoundPartners found{
        reinterpret_cast<std::uint32_t*>(pairs.history.data()),
        has_images
            ? 0
            : static_cast<std::uint32_t>(pairs.history.bytes() / sizeof(std::uint32_t) / std::max(n, 1u))};
    par::for_each(on, n, detail::CountPairs<Backend>{search, counts.data(), found});
    // Pair indices have 31 bits. The exact sum is computed only if the bound n * maximum exceeds the limit.
    const double bound = n * static_cast<double>(par::largest(on, n, detail::AsFloat{counts.data()}));
    if (bound >= PairView::boundary_bit && detail::sum(on, counts.data(), n) >= PairView::boundary_bit)
        throw TooManyPairs();
    pairs.count = static_cast<std::uint32_t>(par::exclusive_scan(on, counts.data(), pairs.start.data(), n));
    pairs.i.resize(pairs.count), pairs.j.resize(pairs.count);
    pairs.in_contact.resize(pairs.count), pairs.image.resize(has_images ? pairs.count : 0);
    if (input.rotation_laws) pairs.rotation_history.resize(pairs.count);
    if (input.law_of != nullptr) pairs.law.resize(pairs.count);
    if (input.internal) pairs.internal.resize(pairs.count);

    constexpr bool lists_others = Pairs<Backend>::stores_all_loads;
    if constexpr (lists_others) par::fill(on, counts.data(), n, 0u);
    par::for_each(
        on, n,
        detail::FillPairs<Backend>{search, found, pairs.start.data(), pairs.i.data(), pairs.j.data(),
                                   lists_others ? counts.data() : nullptr, pairs.law.data(), input.law_of,
                                   input.materials, has_images ? pairs.image.data() : nullptr});
    if constexpr (lists_others) {
        pairs.other_start.resize(n + 1), pairs.other.resize(pairs.count);
        par::exclusive_scan(on, counts.data(), pairs.other_start.data(), n);
        par::fill(on, counts.data(), n, 0u);
        par::for_each(on, pairs.count,
                      detail::FillOthers{pairs.i.data(), pairs.j.data(), pairs.other_start.data(),
                                         counts.data(), pairs.other.data()});
        par::for_each(on, n, detail::SortRows{pairs.other_start.data(), pairs.other.data()});
        pairs.load.resize(pairs.count);
        par::fill(on, pairs.load.data(), pairs.count, Load{});
        if (input.rotation_laws) {
            pairs.torque.resize(pairs.count);
            par::fill(on, pairs.torque.data(), pairs.count, Float4{});
        }
    }

    pairs.history.resize(pairs.count);
    par::fill(on, pairs.history.data(), pairs.count, Float4{});
    par::fill(on, pairs.in_contact.data(), pairs.count, std::uint8_t{0});
    if (input.rotation_laws) par::fill(on, pairs.rotation_history.data(), pairs.count, Float4{});
    if (input.internal) par::fill(on, pairs.internal.data(), pairs.count, Float4{});
    par::for_each(on, contacts,
                  detail::RestoreContact{
                      saved.data(), had_rotation ? saved_rotation.data() : nullptr, new_index.data(),
                      pairs.start.data(), pairs.j.data(), pairs.history.data(),
                      input.rotation_laws ? pairs.rotation_history.data() : nullptr, pairs.in_contact.data(),
                      had_internal ? saved_internal.data() : nullptr, pairs.internal.data(), domain.grid,
                      p.position.data(), has_images ? saved_apart.data() : nullptr, pairs.image.data()});
}

}  // namespace hilda::granular
