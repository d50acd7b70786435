// SPDX-License-Identifier: GPL-3.0-or-later
/// Euler parameters p = (e0, e) of unit length; e0 is the scalar part.           Fang (2022), Eqs. 2.1a, 2.20

#pragma once

#include "lie/so3.hpp"

namespace hilda::lie {

using Vec4 = Eigen::Vector4d;
using Mat34 = Eigen::Matrix<double, 3, 4>;

/// A(p) = (2 e0² - 1) I + 2 (e eᵀ + e0 ẽ)                                                     Eq. 2.1a
inline Mat3 rotation(const Vec4& p)
{
    const Vec3 e = p.tail<3>();
    return (2 * p[0] * p[0] - 1) * Mat3::Identity() + 2 * (e * e.transpose() + p[0] * tilde(e));
}

/// E(p) = [-e, e0 I + ẽ]: the angular velocity in the global frame is ω = 2 E ṗ.
inline Mat34 E(const Vec4& p)
{
    Mat34 E;
    E << -p.tail<3>(), p[0] * Mat3::Identity() + tilde(p.tail<3>());
    return E;
}

/// G(p) = [-e, e0 I - ẽ]: in the body frame ω̄ = 2 G ṗ and ṗ = ½ Gᵀ ω̄. A = E Gᵀ.                 Eq. 2.20
inline Mat34 G(const Vec4& p)
{
    Mat34 G;
    G << -p.tail<3>(), p[0] * Mat3::Identity() - tilde(p.tail<3>());
    return G;
}

/// The Euler parameters of a rotation, with e0 ≥ 0. Shepperd's method: division by the largest of the four,
/// which is accurate at all angles.
inline Vec4 euler_parameters(const Mat3& A)
{
    const double trace = A.trace();
    const Vec4 four_squares(1 + trace, 1 + 2 * A(0, 0) - trace, 1 + 2 * A(1, 1) - trace,
                            1 + 2 * A(2, 2) - trace);
    int largest = 0;
    four_squares.maxCoeff(&largest);

    Vec4 p;  // not yet normalised
    switch (largest) {
        case 0:
            p << four_squares[0], A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1);
            break;
        case 1:
            p << A(2, 1) - A(1, 2), four_squares[1], A(1, 0) + A(0, 1), A(0, 2) + A(2, 0);
            break;
        case 2:
            p << A(0, 2) - A(2, 0), A(1, 0) + A(0, 1), four_squares[2], A(2, 1) + A(1, 2);
            break;
        default:
            p << A(1, 0) - A(0, 1), A(0, 2) + A(2, 0), A(2, 1) + A(1, 2), four_squares[3];
            break;
    }
    p.normalize();
    return p[0] < 0 ? Vec4(-p) : p;
}

}  // namespace hilda::lie
