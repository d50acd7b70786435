// SPDX-License-Identifier: GPL-3.0-or-later
/// The surfaces with which particles can be in contact: boundaries of a simple shape and the triangles of
/// meshes.

#pragma once

#include "granular/core/surfaces/mesh_view.hpp"

namespace hilda::granular {

/// Surfaces by number: surface first_triangle + t is the triangle t, one with a lower number is a boundary. A
/// boundary with Shape::mesh has no contacts under its own number.
struct Surfaces {
    static constexpr std::uint32_t first_triangle = 1 << 20;

    const Boundary* boundary = nullptr;
    MeshView mesh = {};

    HILDA_HD static bool is_triangle(std::uint32_t k) { return k >= first_triangle; }
    /// Number of the boundary to which surface k belongs
    HILDA_HD std::uint32_t boundary_of(std::uint32_t k) const
    {
        return is_triangle(k) ? mesh.triangle[k - first_triangle].boundary : k;
    }
    /// The closest point of surface k, for a sphere of the given radius [m] around `point`. The distance is
    /// no_contact_distance if k is a triangle that has no contact with the sphere.
    HILDA_HD Nearest nearest(std::uint32_t k, const Vec3& point, double radius) const
    {
        if (!is_triangle(k)) return granular::nearest(boundary[k], point);
        const std::uint32_t t = k - first_triangle;
        const Boundary& b = boundary[mesh.triangle[t].boundary];
        Nearest near = granular::nearest(mesh, t, rotated_back(b.p, point - b.r), radius);
        near.n = rotated(b.p, near.n);
        return near;
    }
    /// Whether n remains the normal of the contact with surface k: a plane or the face of a triangle, of a
    /// boundary that does not turn
    HILDA_HD bool keeps_normal(std::uint32_t k, const Vec3& n) const
    {
        const Boundary& b = boundary[boundary_of(k)];
        if (turns(b)) return false;
        if (!is_triangle(k)) return b.shape == Boundary::Shape::plane;
        const double cosine = n.dot(rotated(b.p, mesh.triangle[k - first_triangle].face.n));
        return cosine > 1 - 1e-12 || cosine < 1e-12 - 1;
    }
    /// The point of the triangle with the number k that is closest to `point`
    HILDA_HD Vec3 closest_point(std::uint32_t k, const Vec3& point) const
    {
        const std::uint32_t t = k - first_triangle;
        const Boundary& b = boundary[mesh.triangle[t].boundary];
        return b.r + rotated(b.p, granular::closest_point(mesh, t, rotated_back(b.p, point - b.r)));
    }
    /// Whether a sphere of the given radius around `point` may come into contact with surface k before they
    /// have approached by `skin`. With a triangle also if they then have moved relative to each other by
    /// `skin` in any direction.
    HILDA_HD bool is_near(std::uint32_t k, const Vec3& point, double radius, double skin) const
    {
        if (!is_triangle(k)) return distance_bound(boundary[k], point) < radius + skin;
        const std::uint32_t t = k - first_triangle;
        const Boundary& b = boundary[mesh.triangle[t].boundary];
        const Vec3 p = rotated_back(b.p, point - b.r);
        const MeshTriangle& T = mesh.triangle[t];
        const double height = T.face.height(p), reach = radius + skin;
        return height < reach && -height < reach && T.edge[0].height(p) < reach &&
               T.edge[1].height(p) < reach && T.edge[2].height(p) < reach &&
               (p - granular::closest_point(mesh, t, p)).norm() < reach &&
               distance_to_ownership(mesh, t, p) < 1.01 * skin;
    }
    /// Lever arm of a contact load about Boundary::r [m]: from there to the point of the surface that is
    /// closest to the centre of the particle, or to the one at `depth` below it [m]
    HILDA_HD Vec3 contact_lever(std::uint32_t k, const Vec3& centre, double radius, double depth) const
    {
        const Nearest near = nearest(k, centre, radius);
        return centre - (near.distance + depth) * near.n - boundary[boundary_of(k)].r;
    }
};

}  // namespace hilda::granular
