// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/so3.hpp"

#include "lie/euler_parameters.hpp"

#include <Eigen/SVD>

namespace hilda::lie {

Mat3 exp(const Vec3& theta)
{
    const RotationCoefficients c(theta.squaredNorm());
    Mat3 A = c.cosc * theta * theta.transpose();
    const double cosine = 1 - c.cosc * theta.squaredNorm();
    A.diagonal().array() += cosine;
    const Vec3 s = c.sinc * theta;
    A(2, 1) += s.x(), A(1, 2) -= s.x();
    A(0, 2) += s.y(), A(2, 0) -= s.y();
    A(1, 0) += s.z(), A(0, 1) -= s.z();
    return A;
}

// Computed from the Euler parameters, which are accurate at all angles. acos((tr A - 1)/2) would lose half of
// the digits near 0 and π.
Vec3 log(const Mat3& A)
{
    const Vec4 p = euler_parameters(A);
    const Vec3 e = p.tail<3>();
    const double sin_half = e.norm();
    if (sin_half == 0) return Vec3::Zero();
    return 2 * std::atan2(sin_half, p[0]) / sin_half * e;  // e0 ≥ 0, so the angle is at most π
}

Mat3 right_jacobian(const Vec3& theta)
{
    const RotationCoefficients c(theta.squaredNorm());
    const Mat3 theta_tilde = tilde(theta);
    return Mat3::Identity() - c.cosc * theta_tilde + c.sincc * theta_tilde * theta_tilde;
}

Mat3 right_jacobian_inverse(const Vec3& theta)
{
    const double x2 = theta.squaredNorm();
    const RotationCoefficients c(x2);
    // k = (1 - (x/2) cot(x/2))/x² = (1 - sinc/(2 cosc))/x². The numerator cancels near zero: power series
    // there.
    double k = 0;
    if (x2 < 0.25) {
        k = 1.0 / 12 +
            x2 * (1.0 / 720 + x2 * (1.0 / 30240 +
                                    x2 * (1.0 / 1209600 + x2 * (1.0 / 47900160 + x2 * (691.0 / 1307674368000 +
                                                                                       x2 / 74724249600)))));
    } else {
        k = (1 - c.sinc / (2 * c.cosc)) / x2;
    }
    const Mat3 theta_tilde = tilde(theta);
    return Mat3::Identity() + 0.5 * theta_tilde + k * theta_tilde * theta_tilde;
}

Mat3 nearest_rotation(const Mat3& B)
{
    const Eigen::JacobiSVD<Mat3> svd(B, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vec3 sign(1, 1, 1);
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign[2] = -1;
    return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

Mat3 orthonormalised(const Mat3& A) { return A * (1.5 * Mat3::Identity() - 0.5 * A.transpose() * A); }

double orthogonality_error(const Mat3& A) { return (A.transpose() * A - Mat3::Identity()).norm(); }

}  // namespace hilda::lie
