// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface.hpp"

#include "lie/check.hpp"

#include <Eigen/LU>

namespace hilda::contact {

namespace {

constexpr double vanishing =
    1e-12;  // ∇G of this size, over that of ∇²G times the size of the surface, is none

struct Normal {
    double g;  // |∇G|
    Vec3 u;    // ∇G / g
};

Normal normal_at(const Surface& surface, const Vec3& a)
{
    const Vec3 gradient = surface.gradient(a);
    const double g = gradient.norm();
    if (!(g > vanishing * surface.hessian(a).norm() * surface.size())) {
        std::ostringstream what;
        what.precision(6);
        what << "the gradient of a surface vanishes at (" << a.x() << ", " << a.y() << ", " << a.z() << ")";
        throw lie::NumericalFailure("nonfinite", what.str());
    }
    return {g, gradient / g};
}

}  // namespace

Vec3 Surface::normal(const Vec3& a) const { return sigma() * normal_at(*this, a).u; }

Mat3 Surface::normal_derivative(const Vec3& a) const
{
    const auto [g, u] = normal_at(*this, a);
    return sigma() / g * (Mat3::Identity() - u * u.transpose()) * hessian(a);
}

Mat3 Surface::shape_operator(const Vec3& a) const
{
    const auto [g, u] = normal_at(*this, a);
    const Mat3 P = Mat3::Identity() - u * u.transpose();
    return P * (sigma() / g * hessian(a)) * P;
}

Vec3 Surface::project(const Vec3& a) const
{
    // ᾱ - a + s ∇G = 0, G = 0
    constexpr int most = 50;
    Vec3 x = a;
    double s = 0, correction = 0;
    for (int k = 0; k < most; ++k) {
        const Vec3 gradient = this->gradient(x);
        Eigen::Matrix4d J;
        J << Mat3::Identity() + s * hessian(x), gradient, gradient.transpose(), 0;
        Eigen::Vector4d e;
        e << x - a + s * gradient, value(x);
        const Eigen::Vector4d d = J.partialPivLu().solve(e);
        x -= d.head<3>();
        s -= d[3];
        correction = d.head<3>().norm();
        if (correction <= 1e-15 * (size() + x.norm())) return x;
    }
    std::ostringstream what;
    what << "no nearest point on a surface: correction " << correction << " m after " << most
         << " iterations";
    throw lie::NumericalFailure("contact_not_converged", what.str());
}

}  // namespace hilda::contact
