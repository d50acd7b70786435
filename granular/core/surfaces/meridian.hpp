// SPDX-License-Identifier: GPL-3.0-or-later
/// Closest points of finite surfaces of revolution: frustum, disk and torus.
///
/// A point has the coordinates (ρ, z) in its meridian half-plane: its distance ρ ≥ 0 from the axis and its
/// place z along it. The closest point of a surface is in the same half-plane. It is on a face, or on a
/// circular edge between two faces or at the end of an open surface. Edges and the tip of a frustum have no
/// curvature of their own, as those of meshes.
///
/// The outside of a convex solid has one local minimum of the distance. The normal is continuous from a face
/// to an edge. A surface with particles on one side has no contact with those behind it, and an edge has none
/// with those behind the face that ends there.

#pragma once

#include "granular/backend/real.hpp"

#include <cstdint>

namespace hilda::granular {

constexpr double infinite_curvature = 1e300;   ///< of the apex of a cone [1/m]
constexpr double no_contact_distance = 1e300;  ///< distance of a surface without a closest point [m]

/// Which parts of a finite surface there are
enum SurfaceFlag : std::int32_t {
    two_sided_surface = 1,  ///< a disk, or a frustum without end faces, with particles on both sides
    open_first_end = 2,     ///< a frustum has no end face at `from`; its side ends at an edge
    open_second_end = 4,    ///< the same at `to`
    without_edge = 8        ///< a disk whose edge is covered by another surface
};

/// Distance [m], unit normal (n_ρ, n_z) and mean curvature [1/m] at the closest point; see Nearest
struct MeridianNearest {
    double distance, n_rho, n_z, curvature = 0;
};

/// The edge that is a circle of radius edge_rho at edge_z. The normal of a point on it is (n_ρ, n_z).
HILDA_HD inline MeridianNearest nearest_on_edge(double rho, double z, double edge_rho, double edge_z,
                                                double n_rho, double n_z)
{
    const double x = rho - edge_rho, y = z - edge_z, distance = sqrt(x * x + y * y);
    if (!(distance > 0)) return {0, n_rho, n_z};
    return {distance, x / distance, y / distance};
}

/// Side of a cone or cylinder from z = `from` with `radius` to z = `to` with `second_radius`, and its end
/// faces. The side has the normal (cosine, -sine) away from the axis.
struct MeridianFrustum {
    double radius, second_radius, from, to, cosine, sine;
    bool inside;         ///< the particles are inside; there are no end faces
    std::int32_t flags;  ///< of SurfaceFlag

    HILDA_HD double length() const { return (to - from) / cosine; }  ///< of the side, along the generator [m]
    /// Distance in front of the side seen from outside, and place along the generator from z = `from` on [m]
    HILDA_HD double height(double rho, double z) const { return (rho - radius) * cosine - (z - from) * sine; }
    HILDA_HD double along(double rho, double z) const { return (rho - radius) * sine + (z - from) * cosine; }

    HILDA_HD MeridianNearest nearest(double rho, double z) const
    {
        const double s = height(rho, z), t = along(rho, z);
        const bool two_sided = (flags & two_sided_surface) != 0;
        const double sign = (two_sided ? s < 0 : inside) ? -1 : 1;
        if (sign * s < 0) return behind_side(rho, z, s);
        if (t >= 0 && t <= length()) {
            const double at = radius + t * sine;
            return {sign * s, sign * cosine, -sign * sine,
                    sign * (at > 0 ? cosine / (2 * at) : infinite_curvature)};
        }
        const bool second = t > 0;
        if ((flags & (second ? open_second_end : open_first_end)) != 0) return edge(second, rho, z, sign);
        return inside ? none() : end(second, rho, z);
    }
    /// Lower bound of the distance at which a contact can begin [m]; changes by at most 1 m per m
    HILDA_HD double distance_bound(double rho, double z) const
    {
        if (!inside && (flags & two_sided_surface) == 0) {
            MeridianFrustum solid = *this;
            solid.flags = 0;
            return solid.nearest(rho, z).distance;
        }
        const double s = height(rho, z), t = along(rho, z);
        if (t >= 0 && t <= length()) return s < 0 ? -s : s;
        return edge(t > 0, rho, z, 1).distance;
    }

private:
    HILDA_HD MeridianNearest none() const { return {no_contact_distance, cosine, -sine}; }
    HILDA_HD MeridianNearest edge(bool second, double rho, double z, double sign) const
    {
        return nearest_on_edge(rho, z, second ? second_radius : radius, second ? to : from, sign * cosine,
                               -sign * sine);
    }
    /// End face with its edge, for a point beyond it
    HILDA_HD MeridianNearest end(bool second, double rho, double z) const
    {
        if (rho > (second ? second_radius : radius)) return edge(second, rho, z, 1);
        return second ? MeridianNearest{z - to, 0, 1} : MeridianNearest{from - z, 0, -1};
    }
    /// For a point behind the side, extended beyond its ends: beyond an end face, in the solid, or without a
    /// contact
    HILDA_HD MeridianNearest behind_side(double rho, double z, double s) const
    {
        if (inside) return none();
        const bool open_first = (flags & open_first_end) != 0, open_second = (flags & open_second_end) != 0;
        if (!open_first && z < from) return end(false, rho, z);
        if (!open_second && z > to) return end(true, rho, z);
        if (open_first || open_second) return none();
        if (s >= from - z && s >= z - to)
            return {s, cosine, -sine, cosine / (2 * (radius + along(rho, z) * sine))};
        return from - z > z - to ? MeridianNearest{from - z, 0, -1} : MeridianNearest{z - to, 0, 1};
    }
};

/// Disk of the radius `radius` at z = 0 with the normal (0, 1)
HILDA_HD inline MeridianNearest nearest_on_disk(double radius, std::int32_t flags, double rho, double z)
{
    const double sign = z < 0 ? -1 : 1;
    const MeridianNearest none = {no_contact_distance, 0, 1};
    if (z < 0 && (flags & two_sided_surface) == 0) return none;
    if (rho <= radius) return {sign * z, 0, sign};
    if ((flags & without_edge) != 0) return none;
    return nearest_on_edge(rho, z, radius, 0, 0, sign);
}
/// Distance from the disk on either side [m]
HILDA_HD inline double distance_from_disk(double radius, double rho, double z)
{
    return nearest_on_disk(radius, two_sided_surface, rho, z).distance;
}

/// Tube of the radius `radius` around the circle of radius `ring` in the plane z = 0; sign = -1: the
/// particles are inside. Mean curvature 1/2 (1/a + cos φ/ρ) at the angle φ of the tube, where the surface is
/// at ρ = ring + a cos φ.
HILDA_HD inline MeridianNearest nearest_on_torus(double radius, double ring, double sign, double rho,
                                                 double z)
{
    const double x = rho - ring, d = sqrt(x * x + z * z), scale = d > 0 ? 1 / d : 0;
    const double cosine = scale * x;
    return {sign * (d - radius), sign * cosine, sign * scale * z,
            sign * 0.5 * (1 / radius + cosine / (ring + radius * cosine))};
}

}  // namespace hilda::granular
