// SPDX-License-Identifier: GPL-3.0-or-later
/// The meshes of a world in the memory of the host, with the neighbours and owners of their features.

#pragma once

#include "granular/core/surfaces/mesh_view.hpp"
#include "granular/core/surfaces/triangle_mesh.hpp"

namespace hilda::granular {

/// The arrays of MeshView
struct Meshes {
    std::vector<MeshTriangle> triangle;
    std::vector<Vec3> vertex, vertex_normal;
    std::vector<std::uint32_t> fan_start = {0}, fan;

    /// One mesh: triangles from `first` to `end` - 1, vertices from `first_vertex` to `end_vertex` - 1
    struct Part {
        std::uint32_t boundary, first, end, first_vertex, end_vertex;
        double radius;  ///< largest distance of a vertex from the origin of its frame [m]
    };
    std::vector<Part> part;  ///< in ascending order of the boundaries
    /// The mesh of a boundary; nullptr if it has none
    const Part* part_of(std::uint32_t boundary) const;

    /// Adds the mesh of a boundary, whose number is higher than those of the others. check_mesh() must not
    /// find a fault.
    void add(const TriangleMesh& mesh, std::uint32_t boundary, bool two_sided);

    std::size_t bytes() const;
    MeshView view() const
    {
        return {triangle.data(), vertex.data(), vertex_normal.data(), fan_start.data(), fan.data()};
    }
};

}  // namespace hilda::granular
