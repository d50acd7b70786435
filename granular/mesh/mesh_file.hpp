// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes from files.

#pragma once

#include "granular/core/surfaces/triangle_mesh.hpp"

namespace hilda::granular {

/// Reads an OBJ or STL file; see io/formats/mesh_file.hpp. The coordinates are in m. The mesh is not checked,
/// see check_mesh(). Throws io::InvalidInput.
TriangleMesh read_mesh(const std::string& path);

}  // namespace hilda::granular
