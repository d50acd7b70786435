// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes from Wavefront OBJ and STL files.

#pragma once

#include "contact/mesh/triangle_mesh.hpp"
#include "dae/shapes/point_reader.hpp"

#include <string_view>

namespace hilda::contact {

/// The vertices and triangles of a file, with the lines of the text for messages
struct MeshFile {
    static constexpr std::size_t max_bytes = dae::MeshKeys::max_bytes;
    static constexpr std::size_t max_triangles = dae::MeshKeys::max_triangles;

    std::string name;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    std::vector<int> vertex_line, triangle_line;  ///< counted from 1; empty for a binary file

    /// "FILE:LINE: WHAT" for a fault of this mesh, or "FILE: WHAT" without a line
    std::string message(const TriangleMesh::Fault& fault) const;
};

/// The functions of io/formats/mesh_file.hpp with these limits. The mesh is not checked, see
/// TriangleMesh::fault().
MeshFile read_mesh_file(const std::string& path);
MeshFile parse_obj(std::string_view text, const std::string& name);
MeshFile parse_stl(std::string_view bytes, const std::string& name);

}  // namespace hilda::contact
