// SPDX-License-Identifier: GPL-3.0-or-later
/// Notices about boundaries that are probably not what the author of a case means: meshes with coordinates in
/// other units or with normals that point away from the particles, and surfaces at a periodic side.

#pragma once

#include "granular/case/boundary_keys.hpp"
#include "granular/world/world.hpp"

#include <array>
#include <string>
#include <vector>

namespace hilda::granular {

/// Where the shape of a boundary does not change along an axis
struct UniformRange {
    double from, until;  ///< global coordinates [m]; from > until: nowhere
};

/// The box around a boundary, which may be infinite
BoundingBox bounds(const NamedBoundary& b);
/// The range along x, y or z (axis 0, 1 or 2) with the shape that the boundary has in the middle of its box
UniformRange uniform_range(const NamedBoundary& b, int axis);

class SurfaceNotices {
public:
    using Notices = std::vector<std::string>;

    /// Notes a mesh outside of the domain. `place`: of its entry, for all notices
    void add(const std::string& place, const NamedBoundary& b, const World& world, Notices& to);
    /// Notes boundaries that reach a periodic side and do not continue across it: a boundary has no images.
    /// `diameter`: of the largest particle [m]
    void check_periodic_sides(const World& world, double diameter, Notices& to) const;
    /// Notes meshes that are much larger than the domain or smaller than the particles, as with other units.
    void check_sizes(const World& world, double diameter, Notices& to) const;
    /// Notes particles outside of a closed mesh whose normals point inwards: they do not touch it.
    void check_sides(const World& world, Notices& to) const;

private:
    struct Surface {
        std::string place;
        bool is_mesh, faces_inwards;
        BoundingBox box;  ///< at the start
        std::array<UniformRange, 3> uniform;
    };
    std::vector<Surface> all;
};

}  // namespace hilda::granular
