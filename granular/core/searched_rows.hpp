// SPDX-License-Identifier: GPL-3.0-or-later
/// Data of the particles in the order in which the neighbour search tests them.

#pragma once

#include "granular/core/neighbours.hpp"

namespace hilda::granular::detail {

/// The rows of particles that the search of a small particle tests. The CPU tests a pack of them at a time;
/// see searched_rows_cpu.hpp. The other back ends test one particle after the other and need no copy.
template <class Backend>
struct SearchedRows {
    static constexpr bool in_packs = false;
    static constexpr std::size_t padding = 0;  ///< additional elements of `memory`

    SearchedRows(const Position*, const Float4*, std::uint32_t, const Domain&, Float4*) {}
};

}  // namespace hilda::granular::detail
