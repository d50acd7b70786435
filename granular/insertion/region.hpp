// SPDX-License-Identifier: GPL-3.0-or-later
/// Regions into which particles are inserted.

#pragma once

#include "granular/backend/split_mix.hpp"
#include "granular/reading/object_reader.hpp"

namespace hilda::granular {

/// A box, a cylinder or a disk. It contains the whole particles; those of a disk have their centres on it.
struct InsertionRegion {
    enum class Shape { box, cylinder, disk } shape = Shape::box;
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< corners of a box [m]
    Vec3 r = {0, 0, 0};                      ///< centre of the base of a cylinder, or of a disk [m]
    Vec3 axis = {0, 0, 1};                   ///< unit vector from the base of a cylinder; normal of a disk
    double radius = 0, length = 0;           ///< of a cylinder or disk; a disk has the length 0 [m]

    /// A centre of a particle of radius R, uniformly distributed over those that are possible. Three random
    /// numbers.
    Vec3 centre(double R, Random& random) const;
    /// Lower and upper corner of a box that contains the particles whose centres are possible, of radius R
    std::pair<Vec3, Vec3> bounds(double R) const;
    /// "box from (0, 0, 0.1) to (0.1, 0.1, 0.2)"
    std::string description() const;
};

/// Reads a region that has place for a particle of radius R. Throws io::InvalidInput.
InsertionRegion read_region(ObjectReader o, double R);

}  // namespace hilda::granular
