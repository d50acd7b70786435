// SPDX-License-Identifier: GPL-3.0-or-later
/// Random numbers that are the same on all platforms. The distributions of the standard library differ
/// between compilers.

#pragma once

#include "granular/backend/real.hpp"

#include <cmath>
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

/// A sequence of random numbers
class Random {
public:
    explicit Random(std::uint64_t seed) : state(seed) {}
    double number()  ///< uniform in [0, 1)
    {
        return static_cast<double>(SplitMix::mixed(state += SplitMix::step) >> 11) * 0x1p-53;
    }
    double number(double low, double high) { return low + (high - low) * number(); }
    Vec<double> direction()
    {
        const double z = number(-1, 1), angle = number(0, 2 * M_PI), across = std::sqrt(1 - z * z);
        return {across * std::cos(angle), across * std::sin(angle), z};
    }

    std::uint64_t state;
};

}  // namespace hilda::granular
