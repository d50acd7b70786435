// SPDX-License-Identifier: GPL-3.0-or-later
/// Joints as lists of blocks. i and j are body numbers or `ground`; s_bar the joint's point and axis_bar its
/// axis in the frame of each body. `x` is the start, for joints that keep what the start shows. Haug (1989),
/// Secs. 9.4, 9.5
///
/// Each throws InvalidInput for an axis of length zero.

#pragma once

#include "dae/model.hpp"

namespace hilda::dae {

class Driver;

/// The points coincide: 3 CD
Blocks spherical(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j);
/// The points coincide and the axes are parallel: 3 CD, 2 DP1
Blocks revolute(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                const Vec3& axis_bar_j);
/// The axes are one line: 2 DP1, 2 DP2
Blocks cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                   const Vec3& axis_bar_j);
/// The axes are one line and the bodies do not turn about it: 2 DP1, 2 DP2, 1 DP1
Blocks translational(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                     const Vec3& axis_bar_j, const State& x);
/// The points coincide and the axes stay perpendicular: 3 CD, 1 DP1
Blocks universal(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                 const Vec3& axis_bar_j);
/// A point of body i, with a revolute axis through it, slides along the perpendicular cylindrical axis of
/// body j: 1 DP1, 2 DP2
Blocks revolute_cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                            const Vec3& axis_bar_j);
/// The relative pose stays that of the start: 3 CD, 3 DP1
Blocks fixed(int i, int j, const State& x);
/// The points stay at the distance length [m] > 0: 1 D
Blocks distance(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, double length);
/// Body j turns about the axis of body i, right-handed, by g(t) - g(x.t) since the start: 1 DrivenHinge
Blocks hinge_driver(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const Driver& g,
                    const State& x);

}  // namespace hilda::dae
