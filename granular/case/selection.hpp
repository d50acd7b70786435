// SPDX-License-Identifier: GPL-3.0-or-later
/// Particles that a stage removes or assigns to a group: those of a group, of a region, or of both.

#pragma once

#include "granular/reading/object_reader.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

class Groups;
class World;

/// A region of centres, with its boundary
struct CutRegion {
    enum class Shape { everywhere, box, cylinder, half_space } shape = Shape::everywhere;
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< corners of a box [m]
    Vec3 r = {0, 0, 0};     ///< centre of the base of a cylinder; a point of the plane of a half-space [m]
    Vec3 axis = {0, 0, 1};  ///< unit vector from the base of a cylinder, or into a half-space
    double radius = 0, length = 0;  ///< of a cylinder [m]

    bool contains(const Vec3& x) const;
};

/// The particles of a group whose centres are in a region. A clump is in the region that contains its centre
/// of mass, and in the group of its particles.
struct Selection {
    std::string group;  ///< empty: of any group and of none
    CutRegion region;
};

/// Reads a region with the keys of its type, and `group`. Throws io::PlacedError.
Selection read_selection(ObjectReader o);

/// The ids of the particles that one selection at least contains, in ascending order. A clump is selected
/// with all of its particles. Without groups (nullptr) no selection has a group.
std::vector<std::uint32_t> selected(const World& w, const Groups* groups,
                                    const std::vector<Selection>& selections);

}  // namespace hilda::granular
