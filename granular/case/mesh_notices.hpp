// SPDX-License-Identifier: GPL-3.0-or-later
/// Notices about meshes that are probably not what the author of a case means: coordinates in other units,
/// a place outside of the domain, normals that point away from the particles.

#pragma once

#include "granular/case/boundary_keys.hpp"
#include "granular/world/world.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

class MeshNotices {
public:
    using Notices = std::vector<std::string>;

    /// Notes a mesh that reaches a periodic side, across which it has no images, or is outside of the domain.
    /// `place`: of its entry, for all notices
    void add(const std::string& place, const NamedBoundary& b, const World& world, Notices& to);
    /// Notes meshes that are much larger than the domain or smaller than the particles, as with other units.
    void check_sizes(const World& world, double diameter, Notices& to) const;
    /// Notes particles outside of a closed mesh whose normals point inwards: they do not touch it.
    void check_sides(const World& world, Notices& to) const;

private:
    struct Mesh {
        std::string place;
        BoundingBox box;  ///< at the start
        bool faces_inwards;
    };
    std::vector<Mesh> all;
};

}  // namespace hilda::granular
