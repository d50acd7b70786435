// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/mesh/mesh_file.hpp"

#include "io/formats/mesh_file.hpp"

#include <utility>

namespace hilda::contact {

namespace {

MeshFile converted(io::MeshFile from)
{
    MeshFile mesh{.name = std::move(from.name),
                  .vertices = {},
                  .triangles = std::move(from.triangles),
                  .vertex_line = std::move(from.vertex_line),
                  .triangle_line = std::move(from.triangle_line)};
    mesh.vertices.reserve(from.vertices.size());
    for (const auto& x : from.vertices) mesh.vertices.emplace_back(x[0], x[1], x[2]);
    return mesh;
}

}  // namespace

std::string MeshFile::message(const TriangleMesh::Fault& fault) const
{
    const std::vector<int>& lines = fault.of_vertices ? vertex_line : triangle_line;
    const auto k = static_cast<std::size_t>(fault.number);
    const bool has_line = fault.number >= 0 && k < lines.size();
    return name + (has_line ? ":" + std::to_string(lines[k]) : "") + ": " + fault.what;
}

MeshFile parse_obj(std::string_view text, const std::string& name)
{
    return converted(io::parse_obj(text, name, MeshFile::max_triangles));
}

MeshFile parse_stl(std::string_view bytes, const std::string& name)
{
    return converted(io::parse_stl(bytes, name, MeshFile::max_triangles));
}

MeshFile read_mesh_file(const std::string& path)
{
    return converted(io::read_mesh_file(path, MeshFile::max_bytes, MeshFile::max_triangles));
}

}  // namespace hilda::contact
