// SPDX-License-Identifier: GPL-3.0-or-later
/// Where two surfaces touch, or come nearest to each other.

#pragma once

#include "contact/shape.hpp"
#include "lie/check.hpp"
#include "lie/state.hpp"

#include <optional>

namespace hilda::contact {

using lie::Motion;

/// The points C_i and C_j in which the surfaces of bodies i and j have opposite normals and lie nearest to
/// each other; beyond touch, those between which they overlap most. All in the global frame.
struct ContactPoint {
    Vec3 C_i, C_j;  ///< one on each surface [m]
    Vec3 n;         ///< unit normal, INTO body i: C_i - C_j = gap n
    double gap;     ///< [m], negative where they overlap
    Mat3 K_i, K_j;  ///< shape operators there [1/m], see Surface
    /// Unit tangent of the edge with which a body touches, along which alone the point moves over it; zero where the
    /// body is smooth
    Vec3 edge_i = Vec3::Zero(), edge_j = Vec3::Zero();

    Vec3 C() const { return 0.5 * (C_i + C_j); }  ///< where loads act, on both bodies alike
};

/// Principal curvatures of a shape operator with the normal n [1/m]
struct Curvatures {
    double least, most;
};
Curvatures principal_curvatures(const Mat3& K, const Vec3& n);

/// The smaller principal curvature of K_i + K_j [1/m]: negative where a surface does not fit into the other
double least_curvature(const ContactPoint& contact_point);

/// Two surfaces that touch, in a pose in which they have no single touch: along a line, or where one does not fit into
/// the other. Of a start it says that the input is wrong, and not that a search has failed.
class NoUniqueContactPoint : public lie::NumericalFailure {
public:
    explicit NoUniqueContactPoint(const std::string& what) : NumericalFailure("contact_not_converged", what)
    {}
};

/// Contact points of an earlier instant, each in the frame of its body: where to begin.
struct Points {
    Vec3 c_i, c_j;
};

/// Finds the touch of one pair of surfaces. Constant: what it knows of the past it is told.
class Detector {
public:
    virtual ~Detector() = default;

    /// Bodies i and j at r, A. With `from` the search begins at those points and stays with that touch while the
    /// surfaces overlap there; without, or where it finds none, it begins from nothing. Where the bodies are apart
    /// and their nearest points are many, it is any one of those. lie::NumericalFailure "contact_not_converged" with
    /// pair-independent words (residual, iterations) where they may touch and no touch is found.
    virtual ContactPoint detect(const Motion& bi, const Motion& bj, const Points* from) const = 0;
};

/// The detector for a pair: in closed form where there is one, else by Newton's method on the common normal.
/// InvalidInput for a pair that has no single touch, such as two planes.
std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j);

}  // namespace hilda::contact
