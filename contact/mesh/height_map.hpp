// SPDX-License-Identifier: GPL-3.0-or-later
/// Terrain from samples: a bicubic spline with two continuous derivatives.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = z - f(x, y), with the body below. With u and v the position within the cell (i, j) of the grid, in cells,
///
///     f(x, y) = Σ c_(i+k)(j+l) B_k(u) B_l(v),   k, l = 0..3
///
/// where B are the uniform cubic B-splines and c the coefficients for which f passes through the samples. At its ends
/// the spline is not-a-knot: the two outermost cells are one cubic. It is then exact for every polynomial of degree 3
/// in x and in y, and for a smooth f the errors of f, ∇f and ∇²f fall with the fourth, third and second power
/// of the spacing, up to the edge. The natural spline, with f'' = 0 there, has a curvature at the edge that does not
/// converge.
///
/// B-splines rather than slopes or 16 coefficients per cell: f has two continuous derivatives whatever the rounding
/// of c, and a sample costs one number.
///
/// Outside of the grid there is no surface: every evaluation throws lie::NumericalFailure with the point.
class HeightMap final : public Surface {
public:
    /// heights(i, j) = f(x_0 + i Δx, y_0 + j Δy) [m], with the corner (x_0, y_0) and the spacing (Δx, Δy).
    /// InvalidInput unless there are at least 4 samples either way, all are finite, and the spacing is positive.
    HeightMap(const Eigen::MatrixXd& heights, const Eigen::Vector2d& corner, const Eigen::Vector2d& spacing);

    /// Samples a function f(x, y) at n_x times n_y points, corners included. InvalidInput as above.
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
    /// NumericalFailure "contact_not_converged" where the nearest point is on the edge of the grid
    Vec3 project(const Vec3& a) const override;
    /// Half the shorter side of the grid
    double size() const override { return length; }

    const Eigen::Vector2d corner, spacing;

private:
    struct Height {
        double f;
        Eigen::Vector2d slope;
        Eigen::Matrix2d bend;
    };
    /// f, ∇f, ∇²f at a point of the grid
    Height at(const Eigen::Vector2d& x) const;
    Eigen::Vector2d extent() const;
    /// A point from which Newton's method finds the nearest one
    Eigen::Vector2d near_sample(const Vec3& a) const;

    const Eigen::MatrixXd c;  // c(i + 1, j + 1) belongs to the sample (i, j)
    const double length;
};

}  // namespace hilda::contact
