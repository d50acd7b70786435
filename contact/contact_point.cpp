// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_point.hpp"

#include "contact/tangent_basis.hpp"

#include <cmath>

namespace hilda::contact {

Curvatures principal_curvatures(const Mat3& K, const Vec3& n)
{
    const Eigen::Matrix<double, 3, 2> T = tangent_basis(n);
    const Eigen::Matrix2d S = T.transpose() * K * T;
    const double mean = 0.5 * S.trace(), off = std::hypot(0.5 * (S(0, 0) - S(1, 1)), S(0, 1));
    return {mean - off, mean + off};
}

double least_curvature(const ContactPoint& contact_point)
{
    return principal_curvatures(contact_point.K_i + contact_point.K_j, contact_point.n).least;
}

}  // namespace hilda::contact
