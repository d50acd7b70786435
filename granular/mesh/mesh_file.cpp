// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/mesh/mesh_file.hpp"

#include "io/formats/mesh_file.hpp"

namespace hilda::granular {

TriangleMesh read_mesh(const std::string& path)
{
    constexpr std::size_t most_bytes = std::size_t{1} << 30;
    const io::MeshFile file = io::read_mesh_file(path, most_bytes, TriangleMesh::most_triangles);
    TriangleMesh mesh;
    mesh.vertex.reserve(file.vertices.size()), mesh.triangle.reserve(file.triangles.size());
    for (const auto& [x, y, z] : file.vertices) mesh.vertex.push_back({x, y, z});
    for (const auto& [a, b, c] : file.triangles)
        mesh.triangle.push_back(
            {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
    return mesh;
}

}  // namespace hilda::granular
