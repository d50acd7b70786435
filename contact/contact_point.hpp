// SPDX-License-Identifier: GPL-3.0-or-later
/// The contact point of two surfaces: positions, normal, gap and curvatures.

#pragma once

#include "lie/check.hpp"
#include "lie/so3.hpp"

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// The points C_i and C_j at which the surfaces of bodies i and j have opposite normals and the distance
/// between the surfaces is smallest. If the surfaces overlap, the overlap between the points is largest. All
/// vectors are in the global frame.
struct ContactPoint {
    Vec3 C_i, C_j;  ///< the point on each surface [m]
    Vec3 n;         ///< unit normal, pointing into body i: C_i - C_j = gap n
    double gap;     ///< [m], negative if the surfaces overlap
    Mat3 K_i, K_j;  ///< shape operators at C_i and C_j [1/m], see Surface
    /// Unit tangent of the edge with which a body is in contact, such as the rim of a disk. The contact point
    /// then moves over that body along the edge only. Zero for a smooth surface.
    Vec3 edge_i = Vec3::Zero(), edge_j = Vec3::Zero();

    Vec3 C() const { return 0.5 * (C_i + C_j); }  ///< point of application of the loads on both bodies [m]
};

/// Principal curvatures of a surface [1/m]
struct Curvatures {
    double least, most;
};
/// The eigenvalues of the shape operator K [1/m] in the plane perpendicular to the unit normal n
Curvatures principal_curvatures(const Mat3& K, const Vec3& n);

/// The smaller principal curvature of K_i + K_j [1/m]. It is negative if one surface does not fit into the
/// other.
double least_curvature(const ContactPoint& contact_point);

/// The pose of two surfaces that may be in contact does not determine a single contact point: they are in
/// contact along a line, or one does not fit into the other. At the start of a run this exception means that
/// the input is wrong, while any other NumericalFailure means that the search failed.
class NoUniqueContactPoint : public lie::NumericalFailure {
public:
    explicit NoUniqueContactPoint(const std::string& what) : NumericalFailure("contact_not_converged", what)
    {}
};

}  // namespace hilda::contact
