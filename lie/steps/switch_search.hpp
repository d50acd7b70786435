// SPDX-License-Identifier: GPL-3.0-or-later
/// Zeros of the switching functions of a system within a step.

#pragma once

#include "lie/state.hpp"

#include <functional>
#include <vector>

namespace hilda::lie {

class System;

/// Finds where a switching function (System::switching) changes its sign within a step, on a path between
/// its ends: by default the cubic polynomials of set_between(). Where a function has one sign, it is looked
/// at inside as well: where the slopes of |g| at two neighbours of nine equidistant places point inwards,
/// its minimum is located, so that a stop that a body touches and leaves, or flies through, within one step
/// is found.
class SwitchSearch {
public:
    explicit SwitchSearch(const System& system);

    /// Whether the system has switching functions
    bool is_needed() const { return count > 0; }

    /// The places on both sides of the first change of a sign: s, from 0 to 1, with the signs of `from`, and
    /// `after` with another sign. {1, 1} if there is none.
    struct Crossing {
        double s = 1, after = 1;
        bool found() const { return s < 1; }
    };
    /// Sets the state at the fraction s of a step.
    using Path = std::function<void(double s, State& x)>;
    /// From the fraction `begin` on: a crossing of the step before lies at its end, up to rounding.
    Crossing first(const State& from, const State& to, double begin = 0);
    Crossing first(const State& to, const Path& path, double begin = 0);

    /// Whether a function has different signs in two states. Zero and values that are not numbers have none.
    bool differ(const State& a, const State& b);

private:
    double value(std::size_t k, double s, const Path& path);
    void set_values(const State& at, std::vector<double>& g) const;
    void search(std::size_t k, const Path& path, Crossing& crossing);
    bool may_have_minimum(std::size_t k, const Path& path, int n);
    bool search_minimum(std::size_t k, const Path& path, int n, Crossing& crossing);
    void bracket(std::size_t k, const Path& path, double a, double g_a, double b, double g_b,
                 Crossing& crossing);

    static constexpr int parts = 8;

    const System& system;
    const std::size_t count;
    double begin = 0;
    /// The place n, from 0 to `parts`
    double place(int n) const { return n == 0 ? begin : static_cast<double>(n) / parts; }
    State x;                            ///< workspace
    std::vector<double> at[parts + 1];  ///< the values at the places
    std::vector<double> g;
};

}  // namespace hilda::lie
