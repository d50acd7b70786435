// SPDX-License-Identifier: GPL-3.0-or-later
/// Which of many bodies are near enough to touch.

#pragma once

#include "lie/so3.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hilda::contact {

using lie::Vec3;

/// Two bodies by their numbers, i < j
struct Candidate {
    int i, j;

    friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// Balls around the bodies, sorted into cubic cells a little wider than two of the largest balls and the margin: what is
/// within the margin of a ball lies in its own cell or in one of the 26 around it. Cells are found by a hash, so that a
/// ball that flies away costs nothing. O(N) for balls that do not differ much in size.
class BroadPhase {
public:
    /// Pairs with |centre_i - centre_j| < reach_i + reach_j + margin, in the order of i, then of j, however the cells lie.
    /// A reach [m] is the radius of a ball around the whole body; infinite for what is big, such as a bowl or a floor, which
    /// is a candidate with every ball but not with another of its kind; negative for a body that takes no part. Takes
    /// nothing from the heap once the buffers have grown. InvalidInput for a margin or reach that is none,
    /// lie::NumericalFailure "nonfinite" for a centre of a ball.
    const std::vector<Candidate>& find(std::span<const Vec3> centre, std::span<const double> reach,
                                       double margin);

private:
    using Cell = std::array<std::int64_t, 3>;

    std::vector<Candidate> found;
    std::vector<int> big;
    std::vector<Cell> cell;          // of each body
    std::vector<int> first, sorted;  // bodies by bucket, in their order
};

}  // namespace hilda::contact
