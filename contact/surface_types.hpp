// SPDX-License-Identifier: GPL-3.0-or-later
/// The registry of surface types and the reader of shapes in model files.

#pragma once

#include "contact/shape.hpp"
#include "dae/object_reader.hpp"
#include "dae/shapes/point_reader.hpp"
#include "io/registry.hpp"
#include "io/schema/type_schema.hpp"

namespace hilda::contact {

/// A surface type. The file of the surface registers it by io::Registry<SurfaceType>::add().
struct SurfaceType {
    std::string name;
    io::TypeSchema schema = {};
    /// Reads the keys of this type, lengths in m. Throws dae::PlacedError.
    std::shared_ptr<const Surface> (*read)(dae::ObjectReader& o);
    /// Key for the direction of the z axis of the surface frame, such as "normal" or "axis". Empty if there
    /// is none.
    std::string z = {};
    /// The examples of the schema show the format: they name a file, or have too few values.
    bool format_only = false;
};

}  // namespace hilda::contact

extern template class hilda::io::Registry<hilda::contact::SurfaceType>;

namespace hilda::contact {

/// Reads the shape under a key, such as
///
///     {"type": "sphere", "radius": 0.2, "concave": false, "position": [x, y, z], "A": [[...], [...], [...]]}
///
/// The pose is given in the body frame. `position` defaults to the origin of the body frame. The orientation
/// is one of A, p, axis_angle, euler_angles and the key SurfaceType::z, and defaults to the identity. If only
/// z is given, x and y are chosen by tangent_basis(). The canonical text has A. Throws dae::PlacedError.
Shape read_shape(dae::ObjectReader& parent, std::string_view key, const io::About& about = {});

/// The same, with the canonical text in `canonical` instead of a record in `parent`
Shape read_shape(dae::ObjectReader& parent, std::string_view key, const io::About& about,
                 io::Json& canonical);

/// Reads the key "concave" of many surfaces.
bool read_concave(dae::ObjectReader& o);

/// Records the keys of the registered surfaces for the schema of model files.
void record_surfaces(io::SchemaRecorder& recorder);

/// Reads the key "semi_axes": three positive lengths [m]
Vec3 read_semi_axes(dae::ObjectReader& o);

using dae::read_mesh_keys;
using dae::read_rows;

}  // namespace hilda::contact
