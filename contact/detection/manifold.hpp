// SPDX-License-Identifier: GPL-3.0-or-later
/// The contact points of a pair of bodies that touch at several places.

#pragma once

#include "contact/contact_point.hpp"

#include <array>
#include <cstdint>

namespace hilda::contact {

/// One of the contact points of a pair
struct ManifoldPoint {
    ContactPoint at;
    /// The parts of the bodies that touch, such as the number of a vertex. The same parts have the same
    /// number in all poses. Ascending in a manifold
    std::uint32_t feature = 0;
    /// The part of the contact that the point stands for, in [0, 1]: the part of the common area of two faces
    /// that is near the point. Resultants of loads with these shares act at the centroid of the area.
    double share = 1;
};

/// Up to eight contact points
class Manifold {
public:
    static constexpr int most = 8;

    /// Detector::detect_all() may replace many corners of a face by eight points, at the corners that are
    /// farthest in some directions. If this is true, corners that overlap are merged with those near them
    /// instead: k corners with the shares s_k, overlaps δ_k and places x_k become the point with
    ///
    ///     share (Σ s_k δ_k)²/Σ s_k δ_k²,   place Σ s_k δ_k x_k/Σ s_k δ_k,   overlap Σ s_k δ_k²/Σ s_k δ_k.
    ///
    /// A linear normal force has the same resultant, moment and energy as those of all corners.
    bool mean_places = false;

    void clear() { count = 0; }
    bool empty() const { return count == 0; }
    int size() const { return count; }
    const ManifoldPoint& operator[](int k) const { return point[static_cast<std::size_t>(k)]; }
    ManifoldPoint* begin() { return point.data(); }
    ManifoldPoint* end() { return point.data() + count; }
    const ManifoldPoint* begin() const { return point.data(); }
    const ManifoldPoint* end() const { return point.data() + count; }
    void push_back(const ManifoldPoint& p) { point[static_cast<std::size_t>(count++)] = p; }
    void sort();  ///< by features

private:
    std::array<ManifoldPoint, most> point;
    int count = 0;
};

}  // namespace hilda::contact
