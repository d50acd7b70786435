// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/mesh/mesh_file.hpp"

#include "io/formats/mesh_file.hpp"

#include <map>

namespace hilda::granular {

TriangleMesh read_mesh(const std::string& path)
{
    constexpr std::size_t most_bytes = std::size_t{1} << 30;
    const io::MeshFile file = io::read_mesh_file(path, most_bytes, TriangleMesh::most_triangles);
    TriangleMesh mesh;
    mesh.vertex.reserve(file.vertices.size()), mesh.triangle.reserve(file.triangles.size());
    // The vertices of an OBJ file may be repeated for each face.
    std::map<std::array<double, 3>, std::uint32_t> known;
    std::vector<std::uint32_t> number;
    for (const auto& [x, y, z] : file.vertices) {
        const auto [at, is_new] = known.try_emplace({x + 0., y + 0., z + 0.},  // -0 becomes 0
                                                    static_cast<std::uint32_t>(mesh.vertex.size()));
        if (is_new) mesh.vertex.push_back({x, y, z});
        number.push_back(at->second);
    }
    for (const auto& [a, b, c] : file.triangles)
        mesh.triangle.push_back({number[static_cast<std::size_t>(a)], number[static_cast<std::size_t>(b)],
                                 number[static_cast<std::size_t>(c)]});
    return mesh;
}

}  // namespace hilda::granular
