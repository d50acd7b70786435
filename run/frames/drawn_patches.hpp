// SPDX-License-Identifier: GPL-3.0-or-later
/// The drawn patches of unbounded surfaces.

#pragma once

#include "run/frames/drawing.hpp"

namespace hilda::run {

/// The meshes of a drawing. An unbounded surface is drawn over the region, in its frame, of the bounding
/// spheres of the surfaces of other bodies and of the contact points, over all frames so far. The drawing
/// outlives this object.
class DrawnPatches {
public:
    explicit DrawnPatches(const Drawing& drawing);

    /// Extends the regions by a frame. Returns true if meshes() changes by it.
    bool extend(const Drawing::Frame& frame);
    /// True if the drawing has unbounded surfaces: its meshes depend on the frames.
    bool depend_on_frames() const { return !unbounded.empty(); }
    std::vector<Drawing::BodyMesh> meshes() const;

    /// Writes or reads the regions.
    void transfer(io::Archive& a);

private:
    /// Region of the other bodies of an unbounded surface
    struct Region {
        size_t surface;
        Eigen::AlignedBox3d box, whole;  ///< in the frame of the surface, and global [m]
    };

    void extend(Region& region, const Drawing::Frame& frame) const;
    Drawing::BodyMesh mesh(size_t surface, const DrawingExtent& extent) const;

    const Drawing& drawing;
    std::vector<double> radius;  ///< of each surface about its origin [m]; 0 for unbounded surfaces
    std::vector<Drawing::BodyMesh> surface_mesh;  ///< of each surface; of unbounded surfaces by meshes()
    std::vector<Region> unbounded;
};

}  // namespace hilda::run
