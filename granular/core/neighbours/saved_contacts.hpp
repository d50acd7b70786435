// SPDX-License-Identifier: GPL-3.0-or-later
/// Functors that save the histories of contacts before the list is replaced, and restore them in the new one.

#pragma once

#include "granular/core/neighbours/fetch_add.hpp"
#include "granular/core/neighbours/neighbours.hpp"

namespace hilda::granular::detail {

/// Saves the contacts among the pairs of a block, and those of rotation and internal variables where there
/// are any. Their order depends on the order in which the blocks are processed.
struct SaveContacts {
    static constexpr std::uint32_t block = 64;

    PairView pairs;
    std::uint32_t* count;  ///< number of contacts that are saved
    SavedContact* to;      ///< nullptr: the contacts are only counted
    Float4 *rotation, *internal;
    ParticleView particles;
    Difference* apart;  ///< nullptr: the pairs have no images

    HILDA_HD void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * block,
                            end = pairs.count - begin < block ? pairs.count : begin + block;
        std::uint32_t contacts = 0;
        for (std::uint32_t n = begin; n < end; ++n) contacts += pairs.in_contact[n] != 0 ? 1 : 0;
        std::uint32_t k = fetch_add(count, contacts);
        if (to == nullptr) return;
        for (std::uint32_t n = begin; n < end; ++n) {
            if (pairs.in_contact[n] == 0) continue;
            const Float4 u = pairs.history[n];
            to[k] = {pairs.i[n], pairs.j[n], u.x, u.y, u.z, u.w};
            if (rotation != nullptr) rotation[k] = pairs.rotation_history[n];
            if (internal != nullptr) internal[k] = pairs.internal[n];
            if (apart != nullptr && (pairs.j[n] & PairView::boundary_bit) == 0)
                apart[k] = pair_difference(particles, pairs, n);
            ++k;
        }
    }
};

/// Restores a saved history in the new list. Vectors change their sign if the order of the two particles is
/// reversed; the internal variables are numbers and do not. A history whose pair is not in the new list is
/// dropped. The images of a pair differ in the difference of the positions, which the search does not change.
struct RestoreContact {
    const SavedContact* saved;
    const Float4* saved_rotation;
    const std::uint32_t* new_index;
    const std::uint32_t *start, *j;
    Float4 *history, *rotation_history;
    std::uint8_t* in_contact;
    const Float4* saved_internal;
    Float4* internal;
    CellGrid grid;
    const Position* position;
    const Difference* saved_apart;  ///< nullptr: the pairs have no images
    const std::uint8_t* image;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const SavedContact s = saved[k];
        std::uint32_t a = new_index[s.i], b = s.j;
        float sign = 1;
        if ((b & PairView::boundary_bit) == 0) {
            b = new_index[b];
            if (b < a) {
                const std::uint32_t c = a;
                a = b, b = c, sign = -1;
            }
        }
        if (restore_to(a, b, sign, s, k)) return;
        // across a periodic boundary the pair may be listed in the other order
        if ((b & PairView::boundary_bit) == 0) restore_to(b, a, -sign, s, k);
    }
    HILDA_HD bool restore_to(std::uint32_t a, std::uint32_t b, float sign, const SavedContact& s,
                             std::uint32_t k) const
    {
        for (std::uint32_t n = start[a]; n < start[a + 1]; ++n) {
            if (j[n] != b || (saved_apart != nullptr && !is_image(a, b, n, sign, k))) continue;
            history[n] = {sign * s.x, sign * s.y, sign * s.z, s.w};
            in_contact[n] = 1;
            if (rotation_history != nullptr) {
                const Float4 t = saved_rotation != nullptr ? saved_rotation[k] : Float4{};
                rotation_history[n] = {sign * t.x, sign * t.y, sign * t.z, t.w};
            }
            if (saved_internal != nullptr) internal[n] = saved_internal[k];
            return true;
        }
        return false;
    }
    HILDA_HD bool is_image(std::uint32_t a, std::uint32_t b, std::uint32_t n, float sign,
                           std::uint32_t k) const
    {
        if ((b & PairView::boundary_bit) != 0) return true;
        const Difference d = difference(grid, position[a], position[b], image[n]), before = saved_apart[k];
        return sign > 0 ? d.x == before.x && d.y == before.y && d.z == before.z
                        : d.x == -before.x && d.y == -before.y && d.z == -before.z;
    }
};

}  // namespace hilda::granular::detail
