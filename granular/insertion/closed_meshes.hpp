// SPDX-License-Identifier: GPL-3.0-or-later
/// The sides of closed meshes: a particle that touches no triangle may still be inside of a solid.

#pragma once

#include "granular/world/world.hpp"

namespace hilda::granular {

/// The closed one-sided meshes of a world, in the places of their boundaries at the construction
class ClosedMeshes {
public:
    explicit ClosedMeshes(const World& world);

    /// Whether a point is on the side of the particles of all meshes: outside of those whose normals point
    /// out of a solid, inside of those whose normals point inwards. Points on a triangle have any result.
    bool allow(const Vec3& point) const;

private:
    struct Triangle {
        Vec3 a, b, c;
    };
    /// A mesh in its own frame. A ray along x passes the triangles of one cell of a grid over y and z.
    struct Mesh {
        const Boundary* boundary = nullptr;
        bool is_container = false;
        std::vector<Triangle> triangles;
        double low_y = 0, low_z = 0, width_y = 0, width_z = 0;  ///< of the grid and of a cell [m]
        int cells = 1;                                          ///< along y and z
        std::vector<std::vector<std::uint32_t>> in_cell;

        void make_grid();
        int winding(const Vec3& point) const;
    };
    std::vector<Mesh> meshes;
};

}  // namespace hilda::granular
