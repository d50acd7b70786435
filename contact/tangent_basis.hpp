// SPDX-License-Identifier: GPL-3.0-or-later
/// An orthonormal basis of the plane perpendicular to a unit vector.

#pragma once

#include "lie/so3.hpp"

namespace hilda::contact {

/// T (3x2) with TᵀT = I and Tᵀn = 0 for a unit vector n; (T_1, T_2, n) is right-handed. Method of Duff et al.
/// (2017). It is accurate to round-off for every n and discontinuous where n_z changes its sign.
inline Eigen::Matrix<double, 3, 2> tangent_basis(const lie::Vec3& n)
{
    const double sign = std::copysign(1.0, n.z());
    const double a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
    Eigen::Matrix<double, 3, 2> T;
    T << 1 + sign * n.x() * n.x() * a, b, sign * b, sign + n.y() * n.y() * a, -sign * n.x(), -n.y();
    return T;
}

}  // namespace hilda::contact
