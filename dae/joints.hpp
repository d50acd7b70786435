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

/// Q stays in the plane through P with the normal of body i, and the normals are parallel: 2 DP1, 1 DP2
Blocks planar(int i, const Vec3& s_bar_i, const Vec3& normal_bar_i, int j, const Vec3& s_bar_j,
              const Vec3& normal_bar_j);
/// The pitch circles of two gears with parallel axes and the centres P and Q roll on each other: one row. R_i
/// > 0; R_j [m] is negative for an internal gear. Throws lie::InvalidInput for radii of zero and axes that
/// are not parallel in x.
Blocks gear(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, double R_i, int j, const Vec3& s_bar_j,
            const Vec3& axis_bar_j, double R_j, const State& x);
/// The axes are collinear, and body j moves along the axis by `pitch` [m] for each revolution relative to
/// body i: 2 DP1, 2 DP2, 1 RotationToTranslation. Throws lie::InvalidInput for axes that do not point in the
/// same direction in x.
Blocks screw(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
             const Vec3& axis_bar_j, double pitch, const State& x);
/// The pinion, body j with the centre Q, rolls on the rack, body i: Q moves along the direction by radius
/// times the rotation about the axis: 1 RotationToTranslation. Throws as screw(), and if the direction is not
/// perpendicular to the axis.
Blocks rack_and_pinion(int i, const Vec3& s_bar_i, const Vec3& direction_bar_i, const Vec3& axis_bar_i, int j,
                       const Vec3& s_bar_j, const Vec3& axis_bar_j, double radius, const State& x);

}  // namespace hilda::dae
