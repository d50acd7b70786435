// SPDX-License-Identifier: GPL-3.0-or-later
/// Shape of a homogeneous body, for its mass properties and for pictures.

#pragma once

#include "lie/so3.hpp"

#include <string>
#include <vector>

namespace hilda::dae {

using lie::Mat3;

/// A solid. Its centre of mass is at the origin of the body frame. That of a convex polyhedron may be
/// elsewhere if the shape is for pictures only.
///
///     type        dimensions [m]                              position in the body frame
///     box         sides a, b, c                               sides along x, y, z
///     sphere      radius R
///     ellipsoid   semi-axes a, b, c                           semi-axes along x, y, z
///     cylinder    radius R, length L                          centre line along the axis
///     capsule     radius R, length L of the cylindrical part  centre line along the axis, with half spheres
///     cone        radius R of the base, height H              apex at 3/4 H along the axis, base at -H/4
///     convex      none; vertices and faces                    convex polyhedron
struct BodyShape {
    std::string type;
    std::vector<double> dimensions = {};
    int axis = 2;                              ///< of cylinder, capsule and cone: 0, 1, 2 for x, y, z
    std::vector<lie::Vec3> vertices = {};      ///< of a convex polyhedron [m], body frame
    std::vector<std::vector<int>> faces = {};  ///< numbers of the corners, counterclockwise seen from outside

    double volume() const;       ///< [m³]
    lie::Vec3 centroid() const;  ///< [m], body frame
    /// Inertia about the centre of mass of a homogeneous body of this mass [kg m²], body frame
    Mat3 inertia(double mass) const;

    /// Whether the type has an axis
    static bool has_axis(const std::string& type)
    {
        return type == "cylinder" || type == "capsule" || type == "cone";
    }
    /// The convex polyhedron with these corners [m], in any order. Distances below `tolerance` times their
    /// extent are zero. lie::InvalidInput for points in a plane, and if a point is inside of the hull of the
    /// others, with its number and depth.
    static BodyShape convex(std::vector<lie::Vec3> vertices, double tolerance);
    /// Number of dimensions of a type; 0 for a convex polyhedron and for an unknown type
    static std::size_t count(const std::string& type);
    static const std::vector<std::string>& types();
};

}  // namespace hilda::dae
