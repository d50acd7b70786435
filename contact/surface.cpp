// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface.hpp"

#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <limits>

namespace hilda::contact {

namespace {

// |∇G| below this fraction of |∇²G| times the size of the surface is treated as zero
constexpr double vanishing = 1e-12;

/// g = |∇G|. NumericalFailure if it vanishes.
double checked_norm(const Surface& surface, const Vec3& a, const Vec3& gradient, const Mat3& hessian)
{
    const double g = gradient.norm();
    if (!(g > vanishing * hessian.norm() * surface.size())) {
        std::ostringstream what;
        what.precision(6);
        what << "a surface has no normal at (" << a.x() << ", " << a.y() << ", " << a.z()
             << "): the gradient of G vanishes";
        throw lie::NumericalFailure("nonfinite", what.str());
    }
    return g;
}

}  // namespace

Vec3 Surface::normal(const Vec3& a) const
{
    const auto [G, gradient, hessian] = derivatives(a);
    return sigma() / checked_norm(*this, a, gradient, hessian) * gradient;
}

Mat3 Surface::normal_derivative(const Vec3& a) const
{
    const auto [G, gradient, hessian] = derivatives(a);
    const double g = checked_norm(*this, a, gradient, hessian);
    const Vec3 u = gradient / g;
    return sigma() / g * (hessian - u * (u.transpose() * hessian));
}

Mat3 Surface::shape_operator(const Vec3& a) const
{
    const auto [G, gradient, hessian] = derivatives(a);
    const double g = checked_norm(*this, a, gradient, hessian);
    const Vec3 u = gradient / g;
    const Mat3 P = Mat3::Identity() - u * u.transpose();
    return P * (sigma() / g * hessian) * P;
}

double Surface::bounding_radius() const
{
    if (!convex() || sigma() < 0) return std::numeric_limits<double>::infinity();
    Vec3 corner;  // of the bounding box
    for (int k = 0; k < 3; ++k)
        corner[k] = std::max((*support(Vec3::Unit(k)))[k], -(*support(-Vec3::Unit(k)))[k]);
    return corner.norm();
}

Vec3 Surface::project(const Vec3& a) const
{
    // update x ← x + T y - (G/g) u, with y from  Tᵀ(I + s ∇²G)(T y - (G/g) u) = Tᵀ(a - x),  s = (a - x)·u / g
    constexpr int max_iterations = 100;
    constexpr double tolerance = 1e-9;  // relative to the size; the remaining error is about its square
    Vec3 x = a;
    double correction = 0;
    for (int k = 0; k < max_iterations; ++k) {
        const auto [G, gradient, H] = derivatives(x);
        const double g = checked_norm(*this, x, gradient, H);
        const Vec3 u = gradient / g;
        // far from the surface the linearised distance G/g is inaccurate: bound it by the size
        const double normal_step = std::clamp(-G / g, -size() - a.norm(), size() + a.norm());
        const Eigen::Matrix<double, 3, 2> T = tangent_basis(u);
        const double s = (a - x).dot(u) / g;
        Eigen::Matrix2d M = s * T.transpose() * H * T;
        M.diagonal().array() += 1;
        Eigen::Vector2d y = T.transpose() * (a - x - s * normal_step * (H * u));
        if (M.determinant() > 0 && M.trace() > 0)
            y = M.inverse() * y;  // otherwise steepest descent: M is not positive definite
        const double length = y.norm(), max_length = 0.5 * size();
        if (length > max_length) y *= max_length / length;
        x += T * y + normal_step * u;
        correction = std::hypot(y.norm(), normal_step);
        if (correction <= tolerance * size()) return x;
    }
    std::ostringstream what;
    what << "the projection onto a surface did not converge: correction " << correction << " m after "
         << max_iterations << " iterations";
    throw lie::NumericalFailure("contact_not_converged", what.str());
}

}  // namespace hilda::contact
