// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/mesh/mesh_file.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "lie/check.hpp"
#include "tests/fuzz/targets.hpp"

namespace hilda::fuzz {

void mesh(std::string_view input)
{
    for (const auto parse : {contact::parse_obj, contact::parse_stl}) try {
            contact::MeshFile file = parse(input, "mesh");
            if (const auto fault = contact::TriangleMesh::fault(file.vertices, file.triangles))
                throw lie::InvalidInput(file.message(*fault));
            contact::MeshSurface surface(
                contact::TriangleMesh(std::move(file.vertices), std::move(file.triangles)));
            surface.derivatives(contact::Vec3(0.1, 0.2, 0.3));
        } catch (const lie::InvalidInput&) {
        }
}

}  // namespace hilda::fuzz
