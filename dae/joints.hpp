// SPDX-License-Identifier: GPL-3.0-or-later
/// Joints as lists of blocks.                                                Haug (1989), Secs. 9.4, 9.5
///
/// i and j are body numbers or `ground`. s_bar is the point of the joint [m] and axis_bar its axis, both in
/// the frame of the body. An axis may have any length. x holds the initial data, from which some joints take
/// relative positions.
///
/// All functions throw lie::InvalidInput for an axis of length zero.

#pragma once

#include "dae/block.hpp"

namespace hilda::dae {

class Driver;

/// The points coincide: 3 CD
Blocks spherical(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j);
/// The points coincide and the axes are parallel: 3 CD, 2 DP1
Blocks revolute(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                const Vec3& axis_bar_j);
/// The axes are collinear: 2 DP1, 2 DP2
Blocks cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                   const Vec3& axis_bar_j);
/// The axes are collinear and the bodies do not rotate relative to each other: 2 DP1, 2 DP2, 1 DP1
Blocks translational(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                     const Vec3& axis_bar_j, const State& x);
/// The points coincide and the axes are perpendicular: 3 CD, 1 DP1
Blocks universal(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                 const Vec3& axis_bar_j);
/// The point of body i slides along the axis of body j, and the revolute axis of body i is perpendicular to
/// that axis: 1 DP1, 2 DP2
Blocks revolute_cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                            const Vec3& axis_bar_j);
/// The relative pose remains that of x: 3 CD, 3 DP1. The point of the joint is the centre of mass of body j.
Blocks fixed(int i, int j, const State& x);
/// The distance of the points is `length` [m]: 1 D. Throws lie::InvalidInput unless it is positive.
Blocks distance(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, double length);
/// Body j rotates relative to body i about the axis by g(t) - g(x.t) [rad], right-handed: 1 DrivenHinge.
/// Throws lie::InvalidInput if the axes enclose more than about 26 degrees in x (cosine below 0.9).
Blocks hinge_driver(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const Driver& g,
                    const State& x);

}  // namespace hilda::dae
