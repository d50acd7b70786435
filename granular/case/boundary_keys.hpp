// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the boundaries of a case file, and their registered types.

#pragma once

#include "granular/case/motion.hpp"
#include "granular/core/surfaces/triangle_mesh.hpp"
#include "granular/mesh/solid_body.hpp"
#include "granular/reading/object_reader.hpp"
#include "io/schema/type_schema.hpp"

#include <optional>

namespace hilda::granular {

struct NamedBoundary {
    std::string name;
    Boundary boundary;
    std::optional<TriangleMesh> mesh = {};  ///< of a boundary with Shape::mesh
    bool two_sided = false;                 ///< whether the particles may be on both sides of the mesh
    BoundaryMotion motion = {};             ///< prescribed motion and load; the boundary number is not set
    std::string part_of = {};               ///< name of the body of which it is a part
    std::optional<SolidBody> solid = {};    ///< of a part with a density
    std::string notice = {};                ///< about repairs of the mesh
    bool sums_parts = false;                ///< whether the mass properties are the sums over the parts

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
    std::string place;  ///< description of the key r
    /// Reads the keys of the type, besides type, name, material, r and v. `boundary` holds these. Returns one
    /// boundary, or several with other names. Throws io::PlacedError.
    std::vector<NamedBoundary> (*read)(ObjectReader& o, NamedBoundary boundary);
};

/// Reads the keys of a boundary that may have a mass: omega, mass, inertia, free, F and T. `solid` replaces
/// the mass, and the inertia if there is no such key. A part of a body has none of the keys.
void read_body(ObjectReader& o, NamedBoundary& body, const std::optional<SolidBody>& solid = {});
/// Reads the density of a solid, which is of the density 1, if there is this key. Throws io::PlacedError if
/// there is a mass as well.
std::optional<SolidBody> read_density(ObjectReader& o, const SolidBody& solid, const io::About& about);

/// Displaces the place of a boundary, of numbers or formulas, by d [m].
void displace(NamedBoundary& b, const Vec3& d);

/// Makes a finite cylinder or cone of a boundary with axis and place, with the given radii at its ends [m],
/// and reads its further keys. Returns the frustum, and its end faces if the particles are inside.
std::vector<NamedBoundary> read_frustum(ObjectReader& o, NamedBoundary b, double radius,
                                        double second_radius);
/// Description of the key r of a boundary of which it is this point (BoundaryType::place)
std::string place_of(const std::string& point);
/// What the schema says about keys of several types
inline constexpr io::About
    about_radius = {"Radius [m].", "0.05"},
    about_inside = {"If true, the particles are inside of the surface; otherwise they are outside.", "true"},
    about_open_sides = {"Sides that are left open; at least one side must remain.", R"(["+z"])",
                        R"("maxItems": 5)"};

/// Reads one entry of `boundaries`, of this type. Returns one boundary, or the sides of a box, which are
/// planes with the names NAME-x, NAME+x, NAME-y, ... Throws io::InvalidInput.
std::vector<NamedBoundary> read_boundary(ObjectReader& o, const BoundaryType& type, const std::string& name);

}  // namespace hilda::granular
