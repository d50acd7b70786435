// SPDX-License-Identifier: GPL-3.0-or-later
/// A smooth surface G(ᾱ) = 0: three formulas, and the geometry that follows from them.

#pragma once

#include "lie/so3.hpp"

#include <optional>
#include <string>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// The boundary of a body, in a frame of its own [m]. Derive with G, ∇G and ∇²G; they must be good in a
/// neighbourhood of the surface. Everything else follows:
///
///     g = |∇G|,  u = ∇G / g,  n = σ u            unit normal, out of the body
///     ∂n/∂ᾱ = σ (I - u uᵀ) ∇²G / g               not symmetric
///     K = (I - n nᵀ) (σ ∇²G / g) (I - n nᵀ)      shape operator, symmetric, K n = 0
///
/// A curvature is positive where the body is convex: 1/R on a ball, 0 on a plane, -1/R in a bowl. Principal
/// directions are not used: they are undefined at umbilics, and Fang (2022), A.4 has them only where a = b.
class Surface {
public:
    virtual ~Surface() = default;

    virtual std::string name() const { return "surface"; }  ///< in messages and in the model file

    virtual double value(const Vec3& a) const = 0;   ///< G
    virtual Vec3 gradient(const Vec3& a) const = 0;  ///< ∇G
    virtual Mat3 hessian(const Vec3& a) const = 0;   ///< ∇²G
    struct Derivatives {
        double G;
        Vec3 gradient;
        Mat3 hessian;
    };
    /// All three at once, for who can compute them together
    virtual Derivatives derivatives(const Vec3& a) const { return {value(a), gradient(a), hessian(a)}; }
    /// σ: 1 where ∇G points out of the body, -1 for a hollow such as a bowl
    virtual double sigma() const { return 1; }

    /// n. lie::NumericalFailure where ∇G vanishes: an apex, a centre.
    Vec3 normal(const Vec3& a) const;
    /// ∂n/∂ᾱ [1/m]
    Mat3 normal_derivative(const Vec3& a) const;
    /// K [1/m]
    Mat3 shape_operator(const Vec3& a) const;
    /// tᵀ K t of a unit tangent t [1/m]: Euler's formula
    double normal_curvature(const Vec3& a, const Vec3& t) const { return t.dot(shape_operator(a) * t); }
    /// Half the trace of K [1/m]
    double mean_curvature(const Vec3& a) const { return 0.5 * shape_operator(a).trace(); }

    /// Whether G < 0 is a convex set, and support() knows its boundary
    virtual bool convex() const { return false; }
    /// The point with ∇G along the unit vector u, where that is a closed form: of all points the furthest along
    /// u. Nothing where it is not; lie::NumericalFailure where the furthest points are many.
    virtual std::optional<Vec3> support(const Vec3&) const { return {}; }

    /// The point of the surface nearest to a: Newton's method on |ᾱ - a|² over the tangent plane, started down
    /// the gradient. lie::NumericalFailure "contact_not_converged" where it finds none.
    virtual Vec3 project(const Vec3& a) const;

    /// A length that tells the size of the surface [m], by which tolerances are scaled; 0 for a plane, which has none
    virtual double size() const = 0;

    /// Length along the surface between two of its points that are `chord` apart, where that is a function of
    /// the chord; else the chord, which is shorter by a part (chord κ)²/24.
    virtual double arc(double chord) const { return chord; }
};

}  // namespace hilda::contact
