// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes from Wavefront OBJ and STL files.

#pragma once

#include "contact/mesh/triangle_mesh.hpp"

#include <string_view>

namespace hilda::contact {

/// The vertices and triangles of a file, with the lines of the text for messages
struct MeshFile {
    static constexpr std::size_t max_bytes = std::size_t{64} << 20;
    static constexpr std::size_t max_triangles = 200000;

    std::string name;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    std::vector<int> vertex_line, triangle_line;  ///< counted from 1; empty for a binary file

    /// "FILE:LINE: WHAT" for a fault of this mesh, or "FILE: WHAT" without a line
    std::string message(const TriangleMesh::Fault& fault) const;
};

/// Reads a mesh file by its ending, .obj or .stl, in upper or lower case. The line ends are those of Unix or
/// Windows. Throws lie::InvalidInput "FILE:LINE: what is wrong, the value" for a file that cannot be read,
/// that has more than max_bytes or max_triangles, or that is not of its format. The mesh is not checked, see
/// TriangleMesh::fault().
MeshFile read_mesh_file(const std::string& path);

/// An OBJ text. The lines v (x, y, z) and f (vertex numbers from 1, or negative ones from the last vertex)
/// are read, a polygon is split into a fan of triangles; other lines are ignored.
MeshFile parse_obj(std::string_view text, const std::string& name);

/// An STL file, binary if its length is 84 + 50 n bytes for the n triangles of its header, otherwise text.
/// Corners with equal coordinates become one vertex. The normals of the file are ignored: the order of the
/// corners counts.
MeshFile parse_stl(std::string_view bytes, const std::string& name);

}  // namespace hilda::contact
