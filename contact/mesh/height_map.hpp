// SPDX-License-Identifier: GPL-3.0-or-later
/// Height map: a surface z = f(x, y) interpolated from samples by a bicubic spline with two continuous
/// derivatives.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = z - f(x, y), with the body below the surface. In the cell (i, j) of the grid, with local coordinates
/// u, v in [0, 1],
///
///     f(x, y) = Σ c_(i+k)(j+l) B_k(u) B_l(v),   k, l = 0..3
///
/// where B are the uniform cubic B-splines and c the coefficients for which f interpolates the samples. The
/// end condition is not-a-knot: the two outermost cells share one cubic. The spline is then exact for
/// polynomials of degree 3 in x and in y. For a smooth f the errors of f, ∇f and ∇²f are of order 4, 3 and 2
/// in the spacing, up to the edge. The natural spline (f'' = 0 at the edge) is not used because its curvature
/// at the edge does not converge.
///
/// B-spline coefficients are stored rather than slopes at the samples or 16 coefficients per cell: f then has
/// two continuous derivatives even with rounded coefficients, and one number per sample is sufficient.
///
/// The surface is defined on the grid only: every evaluation outside throws lie::NumericalFailure "nonfinite"
/// with the point.
class HeightMap final : public Surface {
public:
    /// heights(i, j) = f(x_0 + i Δx, y_0 + j Δy) [m], with the corner (x_0, y_0) and the spacing (Δx, Δy)
    /// [m]. InvalidInput unless there are at least 4 samples in each direction, all are finite, and the
    /// spacing is positive.
    HeightMap(const Eigen::MatrixXd& heights, const Eigen::Vector2d& corner, const Eigen::Vector2d& spacing);

    /// Samples a function f(x, y) at n_x by n_y points of the rectangle [lower, upper]. InvalidInput as
    /// above.
    template <class F>
    static HeightMap sampled(const F& f, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper, int n_x,
                             int n_y)
    {
        Eigen::MatrixXd heights(n_x, n_y);
        const Eigen::Vector2d spacing = (upper - lower).cwiseQuotient(Eigen::Vector2d(n_x - 1, n_y - 1));
        for (int i = 0; i < n_x; ++i)
            for (int j = 0; j < n_y; ++j)
                heights(i, j) = f(lower.x() + i * spacing.x(), lower.y() + j * spacing.y());
        return {heights, lower, spacing};
    }

    std::string name() const override { return "height-map"; }
    double value(const Vec3& a) const override { return derivatives(a).G; }
    Vec3 gradient(const Vec3& a) const override { return derivatives(a).gradient; }
    Mat3 hessian(const Vec3& a) const override { return derivatives(a).hessian; }
    Derivatives derivatives(const Vec3& a) const override;
    /// NumericalFailure "contact_not_converged" if the closest point lies on the edge of the grid
    Vec3 project(const Vec3& a) const override;
    /// Half the shorter side of the grid [m]
    double size() const override { return length; }
    bool is_unbounded() const override { return true; }

    const Eigen::Vector2d corner, spacing;

private:
    struct Height {
        double f;
        Eigen::Vector2d gradient;
        Eigen::Matrix2d hessian;
    };
    /// f, ∇f and ∇²f at a point x of the grid
    Height at(const Eigen::Vector2d& x) const;
    Eigen::Vector2d extent() const;
    /// Starting point of Newton's method in project(): the closest sample, or the point above or below a
    Eigen::Vector2d nearest_sample(const Vec3& a) const;

    const Eigen::MatrixXd c;  // B-spline coefficients; c(i + 1, j + 1) belongs to sample (i, j)
    const double length;
};

}  // namespace hilda::contact
