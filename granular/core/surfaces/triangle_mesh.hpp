// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes: vertices and triangles, their faults, and the mass properties of the solid they enclose.

#pragma once

#include "granular/core/boundary.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hilda::granular {

/// A surface of triangles. Seen from the side of the particles the vertices of a triangle are
/// counterclockwise, so that the normal (b - a) × (c - a) points to them.
struct TriangleMesh {
    std::vector<Vec3> vertex;                            ///< [m], in the frame of the mesh
    std::vector<std::array<std::uint32_t, 3>> triangle;  ///< indices of the vertices a, b, c

    static constexpr std::size_t most_triangles = std::size_t{1} << 22;
};

/// The smallest box with edges along the axes around points; low > high without a point
struct BoundingBox {
    static constexpr double infinite = std::numeric_limits<double>::infinity();
    Vec3 low = {infinite, infinite, infinite}, high = {-infinite, -infinite, -infinite};

    void add(const Vec3& r);
};

/// Throws io::InvalidInput "NAME: ..." with the number of the triangle, counted from 0, if the mesh has no
/// triangle or too many, a vertex that is not finite, an index without vertex, a triangle without area, an
/// edge with more than two triangles unless `two_sided`, or two neighbours of opposite orientation.
void check_mesh(const TriangleMesh& mesh, const std::string& name, bool two_sided = false);

/// Number of edges with a single triangle; 0 for a closed mesh
std::size_t open_edges(const TriangleMesh& mesh);

/// Properties of the solid of unit density inside a closed mesh whose normals point outwards
struct MassProperties {
    double volume = 0;        ///< [m³]; negative if the normals point inwards
    Vec3 centre = {0, 0, 0};  ///< of mass [m]
    /// xx, yy, zz, xy, yz, zx of the inertia about the centre over the density [m⁵]
    std::array<double, 6> J{};
};
MassProperties mass_properties(const TriangleMesh& mesh);

}  // namespace hilda::granular
