// SPDX-License-Identifier: GPL-3.0-or-later
/// Random numbers that are the same on all platforms. The distributions of the standard library differ
/// between compilers.

#pragma once

#include <cstdint>

namespace hilda::granular {

/// SplitMix64: hash of a counter, or of a state that is advanced by `step`       Steele, Lea and Flood (2014)
struct SplitMix {
    static constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;

    static std::uint64_t mixed(std::uint64_t state)
    {
        std::uint64_t z = state;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
};

}  // namespace hilda::granular
