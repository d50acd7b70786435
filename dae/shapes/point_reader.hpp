// SPDX-License-Identifier: GPL-3.0-or-later
/// Readers of points in a model file: rows of numbers, and the keys of a mesh file.

#pragma once

#include "dae/object_reader.hpp"

namespace hilda::dae {

/// The keys "file" and "scale" of a surface or a shape with the points of a mesh file
struct MeshKeys {
    static constexpr std::size_t max_bytes = std::size_t{64} << 20, max_triangles = 200000;

    std::string path;  ///< to open
    double scale = 1;  ///< of the coordinates
};
/// Notes them for the schema. `about_file`: description of "file"
void note_mesh_keys(ObjectReader& o, std::string_view about_file);
/// Notes and reads them. "file" is required unless it was looked for before.
MeshKeys read_mesh_keys(ObjectReader& o, std::string_view about_file = {});
/// The corners of the mesh file times the scale [m]. Throws io::InvalidInput "FILE:LINE: ...".
std::vector<Vec3> read_mesh_points(const MeshKeys& keys);

/// Reads a list of rows of numbers, all of the same length, as a matrix. `width` is the required length of a
/// row; without it the first row sets the length. About::rest has the schema of a row. Throws PlacedError.
Eigen::MatrixXd read_rows(ObjectReader& o, std::string_view key, std::optional<std::size_t> width,
                          const io::About& about);

}  // namespace hilda::dae
