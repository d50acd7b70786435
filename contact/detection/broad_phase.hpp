// SPDX-License-Identifier: GPL-3.0-or-later
/// Broad phase of contact detection: the pairs of bodies whose bounding spheres are close to each other.

#pragma once

#include "lie/so3.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hilda::contact {

using lie::Vec3;

/// A pair of body numbers, i < j
struct Candidate {
    int i, j;

    friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// Spatial hashing of bounding spheres in a hierarchy of grids. The cells of the coarsest grid are slightly
/// larger than the largest diameter plus the margin, those of each further grid half as large. A sphere is in
/// the finest grid whose cells are larger than itself. All neighbours of a sphere that are in the same or a
/// coarser grid lie in the cell of its centre or in the 26 adjacent cells. Cells are stored in a hash table,
/// so the memory does not depend on the extent of the domain. The cost is O(N) for each size of the spheres,
/// and does not grow with the ratio of the sizes.
class BroadPhase {
public:
    /// The pairs with |centre_i - centre_j| < reach_i + reach_j + margin, sorted by i, then by j.
    ///
    /// `reach` [m] is the radius of the bounding sphere of a body about its centre [m]. Infinite means an
    /// unbounded body such as a floor: it forms a pair with every bounded body, but not with another
    /// unbounded one. Negative means that the body is ignored. Does not allocate after the buffers have grown
    /// to their final size. InvalidInput for a negative or infinite margin, a reach that is NaN, or arrays of
    /// different lengths; lie::NumericalFailure "nonfinite" if the centre of a bounded body is not finite.
    const std::vector<Candidate>& find(std::span<const Vec3> centre, std::span<const double> reach,
                                       double margin);

    long tests = 0;  ///< distances computed, for tests of growth

private:
    using Cell = std::array<std::int64_t, 3>;

    std::vector<Candidate> found;
    std::vector<int> unbounded;
    std::vector<int> level;  // grid of each body
    std::vector<Cell> cell;  // cell of each body in its grid
    // bodies sorted by bucket; bucket k holds sorted[first[k]] .. sorted[first[k + 1] - 1]
    std::vector<int> first, sorted;
};

}  // namespace hilda::contact
