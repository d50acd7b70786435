// SPDX-License-Identifier: GPL-3.0-or-later
/// Shape of a homogeneous body, for its mass properties and for pictures.

#pragma once

#include "lie/so3.hpp"

#include <string>
#include <vector>

namespace hilda::dae {

using lie::Mat3;

/// A solid with its centre of mass at the origin of the body frame.
///
///     type        dimensions [m]                              position in the body frame
///     box         sides a, b, c                               sides along x, y, z
///     sphere      radius R
///     ellipsoid   semi-axes a, b, c                           semi-axes along x, y, z
///     cylinder    radius R, length L                          centre line along the axis
///     cone        radius R of the base, height H              apex at 3/4 H along the axis, base at -H/4
struct BodyShape {
    std::string type;
    std::vector<double> dimensions;
    int axis = 2;  ///< of cylinder and cone: 0, 1, 2 for x, y, z

    double volume() const;  ///< [m³]
    /// Inertia about the centre of mass of a homogeneous body of this mass [kg m²], body frame
    Mat3 inertia(double mass) const;

    /// Whether the type has an axis
    static bool has_axis(const std::string& type) { return type == "cylinder" || type == "cone"; }
    /// Number of dimensions of a type; 0 for an unknown type
    static std::size_t count(const std::string& type);
    static const std::vector<std::string>& types();
};

}  // namespace hilda::dae
