// SPDX-License-Identifier: GPL-3.0-or-later
/// The surfaces that a model file knows by name.

#pragma once

#include "contact/shape.hpp"
#include "dae/object_reader.hpp"

#include <vector>

namespace hilda::contact {

/// A kind of surface as it stands in the list
struct SurfaceType {
    std::string name;
    /// Reads the keys of this kind, lengths in m. Throws dae::PlacedError.
    std::shared_ptr<const Surface> (*read)(dae::ObjectReader& o);
    /// The key that gives the direction of z of its frame, such as "normal", where z has a name
    std::string z = {};
};

/// By name
const std::vector<SurfaceType>& surface_types();

/// Puts a kind of surface into the list: the last line of its file.
bool register_surface(SurfaceType type);

/// The shape under a key, such as
///
///     {"type": "sphere", "radius": 0.2, "concave": false, "position": [x, y, z], "A": [[...], [...], [...]]}
///
/// with its pose in the body: position, by default its origin; orientation as one of A, p, axis_angle and the key of
/// its kind for z, in the body frame, with x and y then anywhere; by default that of the body. The canonical text
/// has A. Throws dae::PlacedError.
Shape read_shape(dae::ObjectReader& parent, std::string_view key);

/// Three positive lengths, for who reads an ellipsoid
Vec3 read_semi_axes(dae::ObjectReader& o);

/// A list of lists of numbers, all of one length, as the rows of a matrix; for who reads samples or a mesh. `width` is
/// that length, where it must be a certain one.
Eigen::MatrixXd read_rows(dae::ObjectReader& o, std::string_view key, std::optional<std::size_t> width = {});

}  // namespace hilda::contact
