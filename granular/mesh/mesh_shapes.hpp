// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes of simple shapes. The normals point to the particles.
///
/// Lengths are in metres. All functions throw io::InvalidInput with the value for an argument that is not
/// finite or not in its range, and for a mesh of more than TriangleMesh::most_triangles triangles. An
/// argument `edge` > 0 is the largest edge of the rectangular cells into which a flat side is divided, each
/// of two triangles; with edge <= 0 a side is one cell.

#pragma once

#include "granular/core/surfaces/triangle_mesh.hpp"

#include <array>
#include <vector>

namespace hilda::granular {

/// The sides of a box, without those that are `open`, in the order -x, +x, -y, +y, -z, +z. The normals point
/// outwards, or into the box if `inside`. The sides share the vertices of their common edges.
TriangleMesh box_mesh(const Vec3& low, const Vec3& high, const std::array<bool, 6>& open, bool inside,
                      double edge);

/// The surface that a polyline of points (radius, z) sweeps in a revolution about the z axis, in `segments`
/// equal steps of the angle from the x axis on. A point of radius 0 becomes one vertex, and a line along the
/// axis has no triangles. If the last point equals the first one the polyline is closed, as that of a torus.
///
/// The particles are at the left of the direction of travel, if the radius points to the right and z upwards:
/// the normal in this half plane is the direction of travel turned by +90 degrees. A polyline that rises at
/// radius 1 is a cylinder with the particles inside. A closed polyline in counterclockwise order encloses the
/// particles; in clockwise order they are around the body.
///
/// The polyline must not intersect itself; this is not checked. All vertices are on the surface of
/// revolution, so that the volume converges with order 2 in 1 / segments.
TriangleMesh lathe_mesh(const std::vector<std::array<double, 2>>& profile, int segments);

/// The prism from z = 0 to `length` over a simple polygon of points (x, y) in counterclockwise order, at most
/// 10000. The normals point outwards. The ends are triangulated by ear clipping (Meisters 1975) without
/// further vertices; points on a straight line of the outline are vertices of the ends too. The time is
/// quadratic in the number of points.
TriangleMesh extrude_mesh(const std::vector<std::array<double, 2>>& outline, double length);

/// A rectangle about the origin in the plane z = 0 with the normal +z
TriangleMesh plate_mesh(double width_x, double width_y, double edge);

/// A sphere about the origin with the normals outwards: an icosahedron, whose triangles are divided into four
/// `divisions` times, at most 8, with all vertices on the sphere
TriangleMesh sphere_mesh(double radius, int divisions);

}  // namespace hilda::granular
