// SPDX-License-Identifier: GPL-3.0-or-later
/// Particles attached to a boundary: they move rigidly with it.

#pragma once

#include "granular/core/boundary.hpp"
#include "granular/core/orientation.hpp"
#include "granular/core/particles.hpp"

namespace hilda::granular {

/// A particle that is attached to a boundary. No padding: checkpoints store the bytes.
struct AttachedParticle {
    std::uint32_t id, boundary;
    Vec3 X;  ///< centre relative to Boundary::r, in the frame of the boundary [m]
};

/// Pose and velocity of a boundary. The frame of a boundary is the global one when the first particle is
/// attached.
struct BoundaryPose {
    Vec3 r, v, omega;           ///< Boundary::r [m], its velocity [m/s], angular velocity [rad/s]; global
    EulerParameters<double> p;  ///< of the rotation from the frame of the boundary to the global frame
};

constexpr std::uint32_t not_listed = ~std::uint32_t{0};

/// Lists the index of particle k, if it is attached. For the call after a neighbour search.
struct FindAttached {
    const std::uint32_t* id;
    const AttachedParticle* attached;  ///< ordered by id
    std::uint32_t count;
    std::uint32_t* index;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t low = 0, high = count;
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            if (attached[middle].id < id[k])
                low = middle + 1;
            else
                high = middle;
        }
        if (low < count && attached[low].id == id[k]) index[low] = k;
    }
};

/// Sets position and velocities of an attached particle from the pose of its boundary:
///
///     r = r_b + A X,    v = v_b + ω_b × A X,    ω = ω_b
struct MoveAttached {
    CellGrid grid;
    const AttachedParticle* attached;
    const std::uint32_t* index;  ///< of the particle; not_listed if it was removed
    const BoundaryPose* pose;    ///< by boundary number
    Position* position;
    Float4 *velocity, *omega;
    Compensation* compensation;

    /// Adds the whole units of the way to x to `at`, and returns the remainder [units].
    HILDA_HD float approach(std::int32_t& at, std::int32_t cell, double x, int axis) const
    {
        const double width = grid.width[axis];
        double way = (x - grid.low[axis]) / grid.unit - cell * width - grid.local(at, cell, axis);
        if (grid.periodic[axis] != 0) {
            const double length = width * (grid.cells[axis] - 1) + grid.last[axis];
            way -= length * rint(way / length);
        }
        const double whole = rint(way);
        at = wrapped_sum(at, static_cast<std::int32_t>(whole));
        return static_cast<float>(way - whole);
    }

    HILDA_HD void operator()(std::uint32_t n) const
    {
        const std::uint32_t k = index[n];
        if (k == not_listed) return;
        const BoundaryPose b = pose[attached[n].boundary];
        const Vec3 d = rotated(b.p, attached[n].X), r = b.r + d, v = b.v + b.omega.cross(d);
        Position p = position[k];
        const Vec<float> remainder{approach(p.x, grid.x_of(p.cell), r.x, 0),
                                   approach(p.y, grid.y_of(p.cell), r.y, 1),
                                   approach(p.z, grid.z_of(p.cell), r.z, 2)};
        const SplitDisplacement<float> split = split_displacement(remainder, 0);
        position[k] = {p.cell, wrapped_sum(p.x, split.x), wrapped_sum(p.y, split.y),
                       wrapped_sum(p.z, split.z)};
        compensation[k] = {.displacement = split.remainder};
        velocity[k] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
                       velocity[k].w};
        omega[k] = {static_cast<float>(b.omega.x), static_cast<float>(b.omega.y),
                    static_cast<float>(b.omega.z), 0};
    }
};

}  // namespace hilda::granular
