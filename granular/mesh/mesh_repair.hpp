// SPDX-License-Identifier: GPL-3.0-or-later
/// Repairs of triangle meshes whose result does not depend on a choice.

#pragma once

#include "granular/core/surfaces/triangle_mesh.hpp"

namespace hilda::granular {

/// Changes of weld()
struct Welded {
    std::size_t vertices = 0;   ///< joined with another one at a distance above 0
    double distance = 0;        ///< the largest distance of two joined vertices [m]
    std::size_t triangles = 0;  ///< removed: those that had no area left, and copies of others
};

/// Joins vertices whose distance is at most 1e-9 of the largest edge of the box around the mesh: programs
/// write the corners of neighbouring triangles with different rounding errors. An edge between two such
/// corners would be two edges, with a contact each. Indices without a vertex remain.
Welded weld(TriangleMesh& mesh);

/// Removes triangles with the vertices of an earlier one, also of the opposite orientation, for a mesh whose
/// orientation has no meaning. Returns their number.
std::size_t remove_copies(TriangleMesh& mesh);

/// Turns triangles so that neighbours have the same orientation, each connected part as its first triangle,
/// and returns the number of turned ones. Edges with more than two triangles and surfaces with one side,
/// such as Möbius strips, remain for check_mesh().
std::size_t orient(TriangleMesh& mesh);

}  // namespace hilda::granular
