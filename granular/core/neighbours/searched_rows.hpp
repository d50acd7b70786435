// SPDX-License-Identifier: GPL-3.0-or-later
/// The rows of particles that the search of a small particle tests.

#pragma once

#include "granular/core/neighbours/neighbours.hpp"

#ifndef __CUDACC__
#include "granular/backend/pack.hpp"

#include <cstring>
#include <limits>
#endif

namespace hilda::granular::detail {

/// The back ends other than the CPU test one particle after the other and need no copy.
template <class Backend>
struct SearchedRows {
    static constexpr bool in_packs = false;
    static constexpr std::size_t padding = 0;  ///< additional elements of `memory`

    SearchedRows(const Position*, const Float4*, std::uint32_t, const Domain&, Float4*) {}
};

#ifndef __CUDACC__
/// The CPU tests a pack of consecutive particles at a time. Their coordinates and radii are copied to arrays
/// of their own.
template <>
struct SearchedRows<par::Cpu> {
    static constexpr bool in_packs = true;
    static constexpr std::size_t padding = lanes / 4;  // a pack may read beyond the last radius

    /// Copies the particles to `memory` of n + padding elements.
    SearchedRows(const Position* position, const Float4* velocity, std::uint32_t n, const Domain& domain,
                 Float4* memory)
        : unit(static_cast<float>(domain.grid.unit)), x(reinterpret_cast<std::int32_t*>(memory)), y(x + n),
          z(y + n), radius(reinterpret_cast<float*>(z + n))
    {
        const float none = std::numeric_limits<float>::quiet_NaN(), small = domain.small;
        par::for_each(par::Cpu(), n, [=, *this](std::uint32_t k) {
            const Position at = position[k];
            x[k] = at.x, y[k] = at.y, z[k] = at.z;
            radius[k] = velocity[k].w > small ? none : velocity[k].w;
        });
    }

    /// Calls f(j) for the small particles j from `first` to `last` - 1, all of the same periodic image as
    /// `first`, whose surfaces are closer than the skin to that of a particle at `at`. at_first: position of
    /// `first`; radius_and_skin: of the particle [m].
    template <class F>
    void range(const CellGrid& grid, const Position& at, const Position& at_first, float radius_and_skin,
               std::uint32_t first, std::uint32_t last, const F& f) const
    {
        const Difference d = difference(grid, at, at_first);
        const std::int32_t at_x = wrapped_sum(at_first.x, d.x), at_y = wrapped_sum(at_first.y, d.y),
                           at_z = wrapped_sum(at_first.z, d.z);  // of the image
        for (std::uint32_t j = first; j < last; j += lanes) {
            const auto distance = [&](std::int32_t from, const std::int32_t* to) {
                Ints::Unsigned words;
                std::memcpy(&words, to + j, sizeof words);
                return Pack(unit) * to_float(Ints{Ints::V(static_cast<std::uint32_t>(from) - words)});
            };
            const Pack dx = distance(at_x, x), dy = distance(at_y, y), dz = distance(at_z, z);
            Pack limit;
            std::memcpy(&limit, radius + j, sizeof limit);
            limit += Pack(radius_and_skin);
            unsigned found = bits(dx * dx + dy * dy + dz * dz < limit * limit);  // NaN: no
            if (last - j < lanes) found &= (1u << (last - j)) - 1;
            for (; found != 0; found &= found - 1) f(j + static_cast<std::uint32_t>(__builtin_ctz(found)));
        }
    }

private:
    float unit;
    std::int32_t *x, *y, *z;
    float* radius;  ///< NaN for a large particle
};
#endif

}  // namespace hilda::granular::detail
