// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes from Wavefront OBJ and STL files.

#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::io {

/// The vertices and triangles of a file, with the lines of the text for messages
struct MeshFile {
    std::string name;
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<int, 3>> triangles;
    std::vector<int> vertex_line, triangle_line;  ///< counted from 1; empty for a binary file
};

/// Reads a mesh file by its ending, .obj or .stl, in upper or lower case. The line ends are those of Unix or
/// Windows. Throws InvalidInput "FILE:LINE: what is wrong, the value" for a file that cannot be read, that
/// has more than max_bytes or more than `most` triangles, or that is not of its format. Vertices with equal
/// coordinates become one. The mesh is not checked.
MeshFile read_mesh_file(const std::string& path, std::size_t max_bytes, std::size_t most);

/// An OBJ text. The lines v (x, y, z) and f (vertex numbers from 1, or negative ones from the last vertex)
/// are read, a convex polygon is split into a fan of triangles; other lines are ignored.
MeshFile parse_obj(std::string_view text, const std::string& name, std::size_t most);

/// An STL file, binary if its length is 84 + 50 n bytes for the n triangles of its header, otherwise text.
/// The normals of the file are ignored: the order of the corners counts.
MeshFile parse_stl(std::string_view bytes, const std::string& name, std::size_t most);

}  // namespace hilda::io
