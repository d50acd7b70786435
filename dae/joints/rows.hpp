// SPDX-License-Identifier: GPL-3.0-or-later
/// Rows that joints have in common.

#pragma once

#include "dae/block.hpp"

#include <memory>
#include <utility>

namespace hilda::dae {

template <class B, class... Arguments>
void add(Blocks& blocks, Arguments&&... arguments)
{
    blocks.push_back(std::make_unique<B>(std::forward<Arguments>(arguments)...));
}

/// axis/|axis|. Throws lie::InvalidInput for an axis of length zero.
Vec3 unit(const Vec3& axis);

/// Two unit vectors that form a right-handed orthonormal triad (first, second, axis) with the axis
struct Perpendicular {
    Vec3 first, second;
    explicit Perpendicular(const Vec3& axis);
};

/// Adds the rows of coinciding points: 3 CD
void coincide(Blocks& blocks, int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j);
/// Adds the rows of parallel axes: 2 DP1
void parallel(Blocks& blocks, int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j);
/// Adds the rows of a point Q of body j on the axis through P of body i: 2 DP2
void on_axis(Blocks& blocks, int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j);

}  // namespace hilda::dae
