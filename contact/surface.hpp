// SPDX-License-Identifier: GPL-3.0-or-later
/// Implicit surfaces G(ᾱ) = 0: normal, curvature, support function and projection.

#pragma once

#include "lie/so3.hpp"

#include <optional>
#include <string>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

struct DrawingExtent;
struct PolygonMesh;

/// The surface of a body, in its own frame [m]. A derived class implements G, ∇G and ∇²G, which must be
/// defined in a neighbourhood of the surface. The geometry follows from them:
///
///     g = |∇G|,  u = ∇G / g,  n = σ u            outward unit normal of the body
///     ∂n/∂ᾱ = σ (I - u uᵀ) ∇²G / g               not symmetric
///     K = (I - n nᵀ) (σ ∇²G / g) (I - n nᵀ)      shape operator, symmetric, K n = 0
///
/// Curvature is positive where the body is convex: 1/R for a sphere, 0 for a plane, -1/R for a concave
/// sphere. Principal directions are not used: they are undefined at umbilic points. The (θ, φ) directions of
/// Fang (2022), Sec. A.4, are principal only on the symmetry planes of an ellipsoid or where a = b.
class Surface {
public:
    virtual ~Surface() = default;

    /// Name in messages and, for registered types, in model files
    virtual std::string name() const { return "surface"; }

    virtual double value(const Vec3& a) const = 0;   ///< G
    virtual Vec3 gradient(const Vec3& a) const = 0;  ///< ∇G
    virtual Mat3 hessian(const Vec3& a) const = 0;   ///< ∇²G
    struct Derivatives {
        double G;
        Vec3 gradient;
        Mat3 hessian;
    };
    /// G, ∇G and ∇²G together. Override it if they share work.
    virtual Derivatives derivatives(const Vec3& a) const { return {value(a), gradient(a), hessian(a)}; }
    /// σ: 1 if ∇G points out of the body, -1 for a concave surface (contact on the inside, such as a bowl)
    virtual double sigma() const { return 1; }

    /// n at ᾱ = a. lie::NumericalFailure "nonfinite" where ∇G vanishes, such as an apex or a centre; the same
    /// holds for the derivative and the curvatures below.
    Vec3 normal(const Vec3& a) const;
    /// ∂n/∂ᾱ [1/m]
    Mat3 normal_derivative(const Vec3& a) const;
    /// K [1/m]
    Mat3 shape_operator(const Vec3& a) const;
    /// Normal curvature tᵀ K t along the unit tangent t [1/m] (Euler's formula)
    double normal_curvature(const Vec3& a, const Vec3& t) const { return t.dot(shape_operator(a) * t); }
    /// Mean curvature, half the trace of K [1/m]
    double mean_curvature(const Vec3& a) const { return 0.5 * shape_operator(a).trace(); }

    /// True if G < 0 is a convex set and support() is implemented
    virtual bool convex() const { return false; }
    /// Support point: the point of the surface that is farthest along the unit vector u, where ∇G is parallel
    /// to u. Empty if there is no closed form. lie::NumericalFailure if the farthest point is not unique.
    virtual std::optional<Vec3> support(const Vec3&) const { return {}; }

    /// The point of the surface closest to a, by Newton's method for min |ᾱ - a|² in the tangent plane,
    /// combined with a correction along ∇G onto the surface. lie::NumericalFailure "contact_not_converged" if
    /// it does not converge.
    virtual Vec3 project(const Vec3& a) const;

    /// Characteristic length of the surface [m], used to scale tolerances. 0 if the surface has none, such as
    /// a plane.
    virtual double size() const = 0;

    /// Geodesic distance between two points at the straight distance `chord` [m], if it is a function of the
    /// chord alone. Otherwise the chord itself, which is shorter by the fraction (chord κ)²/24.
    virtual double arc(double chord) const { return chord; }

    /// False for a surface with an edge or a fixed contact point. Its only partner is a plane, and it cannot
    /// be part of an evolving contact.
    virtual bool is_smooth() const { return true; }
    /// Radius of a sphere about the origin of the frame that contains the body [m]; infinite if there is
    /// none. The default is that of the bounding box of a convex body from its support points, else infinite.
    virtual double bounding_radius() const;

    /// True for a surface of which only an extent is drawn. The default is an implicit surface with a
    /// coordinate half-axis that does not intersect it.
    virtual bool is_unbounded() const;
    /// Polygons that approximate the surface, at most about 500 points, outward for sigma() = 1. A point that
    /// is not found is NaN. The default samples a convex surface by its support function, which places the
    /// points by normal direction, an implicit surface along rays from its origin, and an unbounded one above
    /// and below the points of the plane z = 0, by projection where there is no such point. For output see
    /// tessellate().
    virtual PolygonMesh drawing(const DrawingExtent& extent) const;
};

}  // namespace hilda::contact
