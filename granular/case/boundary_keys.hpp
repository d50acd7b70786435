// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the boundaries of a case file, and their registered types.

#pragma once

#include "granular/case/object_reader.hpp"
#include "granular/mesh/triangle_mesh.hpp"
#include "io/type_schema.hpp"

#include <optional>

namespace hilda::granular {

struct NamedBoundary {
    std::string name;
    Boundary boundary;
    std::optional<TriangleMesh> mesh = {};  ///< of a boundary with Shape::mesh
    bool two_sided = false;                 ///< whether the particles may be on both sides of the mesh
    BoundaryMotion motion = {};             ///< prescribed motion and load; the boundary number is not set

    /// Whether the boundary moves under its loads or by a prescribed velocity
    bool moves() const
    {
        return boundary.mass > 0 || motion.r || motion.v || motion.omega || boundary.v.norm() > 0 ||
               boundary.omega.norm() > 0;
    }
};

/// A type of boundary. A file registers it by io::Registry<BoundaryType>::add.
struct BoundaryType {
    std::string name;  ///< value of the key "type"
    io::TypeSchema schema;
    /// Reads the keys of the type, besides type, name, material, r and v. `boundary` holds these. Returns one
    /// boundary, or several with other names. Throws io::PlacedError.
    std::vector<NamedBoundary> (*read)(ObjectReader& o, NamedBoundary boundary);
};

/// A homogeneous body
struct SolidBody {
    double mass;  ///< [kg]
    Inertia inertia;
};

/// Reads the keys of a boundary that may have a mass: omega, mass, inertia, free, F and T. `solid` replaces
/// the mass, and the inertia if there is no such key.
void read_body(ObjectReader& o, NamedBoundary& body, const std::optional<SolidBody>& solid = {});

/// Reads one entry of `boundaries`. Returns one boundary, or the sides of a box, which are planes with the
/// names NAME-x, NAME+x, NAME-y, ... Throws io::InvalidInput.
std::vector<NamedBoundary> read_boundary(ObjectReader& o, const std::string& name);

}  // namespace hilda::granular
