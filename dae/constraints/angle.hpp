// SPDX-License-Identifier: GPL-3.0-or-later
/// The angle of a vector about an axis of a body, with its derivatives, counted over any number of
/// revolutions.

#pragma once

#include "dae/constraint.hpp"

namespace hilda::dae {

/// Two perpendicular unit vectors fixed in a body, from which and towards which an angle about their normal
/// u × w is measured
struct AngleFrame {
    Vec3 u_bar, w_bar;
};

/// The angle φ = atan2(v · w, v · u) [rad] of a vector v of two bodies i and j, where u and w are fixed in
/// body i
struct Angle {
    double value = 0;     ///< φ
    Variation variation;  ///< δφ
    double rate = 0;      ///< φ̇
    /// φ̈ for zero accelerations: φ̈ = variation · v̇ + quadratic
    double quadratic = 0;
};

/// Of the angles that differ by whole revolutions, the one nearest to `near`
double nearest_revolution(double angle, double near);

/// Angle of the vector v = A_j ā_j, which is fixed in body j
Angle angle_of_vector(const AngleFrame& frame, const Motion& bi, const Motion& bj, const Vec3& a_bar_j,
                      double near);
/// Angle of the vector v from the point P of body i to the point Q of body j. Not defined if v is parallel to
/// the axis.
Angle angle_of_points(const AngleFrame& frame, const Motion& bi, const Vec3& s_bar_i, const Motion& bj,
                      const Vec3& s_bar_j, double near);

}  // namespace hilda::dae
