// SPDX-License-Identifier: GPL-3.0-or-later
/// The local minima of the distance from a point to a triangle mesh, triangle by triangle.
///
/// Every local minimum of the distance belongs to one feature of the mesh: the inside of a triangle, an edge
/// or a vertex. A triangle owns its inside; an edge or a vertex is owned by the triangle with the lowest
/// number among those that share it. A triangle therefore decides by itself whether it has a contact, and
/// there is one contact for each local minimum. A point p is outside of a triangle across an edge if it is in
/// front of the plane through the edge that is perpendicular to the triangle and faces away from it.
///
/// - triangle: p is not outside across any of its edges, and not closer to the plane of a neighbour across a
///             smooth concave edge,
/// - edge ab:  p is outside of all its triangles, (p - a) · (b - a) > 0 and (p - b) · (a - b) > 0,
/// - vertex v: (p - v) · e ≤ 0 for all edges e that leave v.
///
/// An edge is smooth if the normals of its triangles differ by less than 20 degrees. On its concave side p is
/// above both triangles, at two minima of the distance from the triangles that approximate one minimum of a
/// curved surface. The closer triangle alone has the contact. The distance and the energy of the contact are
/// then continuous. Two contacts would double the force where an overlap δ > R θ²/2 exceeds the height of the
/// edge, with the angle θ between the normals; at 20 degrees that is an overlap of 6 % of R.
///
/// The triangles of an edge or vertex evaluate the same expressions, and the planes of an edge between
/// coplanar triangles have opposite coefficients, so that rounding errors do not lead to different decisions.

#pragma once

#include "granular/core/boundary.hpp"

namespace hilda::granular {

constexpr std::uint32_t no_triangle = ~std::uint32_t{0};

/// n · p = offset
struct MeshPlane {
    Vec3 n;                                                                    ///< unit normal
    double offset;                                                             ///< [m]
    HILDA_HD double height(const Vec3& p) const { return n.dot(p) - offset; }  ///< signed distance [m]
};

/// A triangle of a mesh, in its frame. Edge k leads from vertex k to vertex k + 1, modulo 3.
struct MeshTriangle {
    enum : std::uint32_t {
        two_sided = 1,
        owns_edge = 2,
        owns_vertex = 16,
        smooth_concave = 128,
        smooth_convex = 1024
    };

    std::uint32_t vertex[3];
    /// The triangle on the other side of each edge, or no_triangle. The triangles of an edge with more than
    /// two, in a two-sided mesh, form a ring.
    std::uint32_t across[3];
    std::uint32_t boundary;  ///< number of the boundary to which the mesh belongs
    /// two_sided, owns_edge << k, owns_vertex << k; smooth_concave << k or smooth_convex << k, seen from the
    /// front, if edge k is smooth and not within a plane
    std::uint32_t flags;
    MeshPlane face;
    MeshPlane edge[3];  ///< perpendicular to the triangle; the normals point away from it
};

/// The triangles of all meshes. The edges that leave vertex v lead to the vertices
/// fan[fan_start[v]] … fan[fan_start[v + 1] - 1].
struct MeshView {
    const MeshTriangle* triangle = nullptr;
    const Vec3* vertex = nullptr;         ///< [m], in the frame of the mesh
    const Vec3* vertex_normal = nullptr;  ///< sum of the normals at a vertex, weighted by their angles
    const std::uint32_t *fan_start = nullptr, *fan = nullptr;
};

namespace detail {

/// The number of the edge of a triangle that leaves vertex v
HILDA_HD inline int edge_from(const MeshTriangle& T, std::uint32_t v)
{
    return T.vertex[0] == v ? 0 : T.vertex[1] == v ? 1 : 2;
}

/// The number of the edge of a triangle between the vertices u and v
HILDA_HD inline int edge_between(const MeshTriangle& T, std::uint32_t u, std::uint32_t v)
{
    const int k = edge_from(T, v);
    return T.vertex[k == 2 ? 0 : k + 1] == u ? k : edge_from(T, u);
}

/// Calls f(triangle, number of the edge) for the other triangles at edge k of the triangle t.
template <class F>
HILDA_HD void each_across(const MeshView& mesh, std::uint32_t t, int k, const F& f)
{
    const MeshTriangle& T = mesh.triangle[t];
    const std::uint32_t u = T.vertex[k], v = T.vertex[k == 2 ? 0 : k + 1];
    for (std::uint32_t next = T.across[k]; next != no_triangle && next != t;) {
        const MeshTriangle& other = mesh.triangle[next];
        const int edge = edge_between(other, u, v);
        f(other, edge);
        next = other.across[edge];
    }
}

/// Whether p, which is above the triangle t at the given height, is closer to the plane of a neighbour across
/// a smooth edge that is concave on this side: it is then beyond the plane that bisects the edge. Of two
/// triangles at the same height the one with the lower number is the closer one.
HILDA_HD inline bool has_closer_neighbour(const MeshView& mesh, std::uint32_t t, const Vec3& p, double height)
{
    const MeshTriangle& T = mesh.triangle[t];
    const double sign = height < 0 ? -1 : 1;
    const std::uint32_t concave = height < 0 ? MeshTriangle::smooth_convex : MeshTriangle::smooth_concave;
    for (int k = 0; k < 3; ++k) {
        if ((T.flags & concave << k) == 0) continue;
        const double other = sign * mesh.triangle[T.across[k]].face.height(p), own = sign * height;
        if (other < own || (other == own && T.across[k] < t)) return true;
    }
    return false;
}

/// The minimum at the closest point q on a feature whose normals have the sum `normal`
HILDA_HD inline Nearest minimum_at(const Vec3& p, const Vec3& q, const Vec3& normal, bool two_sided)
{
    const Vec3 d = p - q;
    const double distance = d.norm();
    if (d.dot(normal) < 0 && !two_sided) return {no_contact_distance, normal};
    if (!(distance > 0)) return {0, (1 / normal.norm()) * normal};
    return {distance, (1 / distance) * d};
}

}  // namespace detail

/// The local minimum of the distance that the triangle t owns, for a point in the frame of the mesh: its
/// distance and the unit vector from the closest point to p. The distance is no_contact_distance if t owns
/// none, if the distance is `reach` or more, or if p is behind a mesh that is not two-sided.
HILDA_HD inline Nearest nearest(const MeshView& mesh, std::uint32_t t, const Vec3& p, double reach)
{
    const MeshTriangle& T = mesh.triangle[t];
    const Nearest none = {no_contact_distance, T.face.n};
    const double height = T.face.height(p);
    if (!(height < reach && height > -reach)) return none;
    const bool two_sided = (T.flags & MeshTriangle::two_sided) != 0;
    const double outside[3] = {T.edge[0].height(p), T.edge[1].height(p), T.edge[2].height(p)};
    if (outside[0] < 0 && outside[1] < 0 && outside[2] < 0) {
        if ((height < 0 && !two_sided) || detail::has_closer_neighbour(mesh, t, p, height)) return none;
        return height < 0 ? Nearest{-height, -T.face.n} : Nearest{height, T.face.n};
    }
    if (outside[0] >= reach || outside[1] >= reach || outside[2] >= reach) return none;
    for (int k = 0; k < 3; ++k) {
        if (outside[k] < 0 || (T.flags & MeshTriangle::owns_edge << k) == 0) continue;
        const std::uint32_t u = T.vertex[k], v = T.vertex[k == 2 ? 0 : k + 1];
        const Vec3 a = mesh.vertex[u], b = mesh.vertex[v], e = b - a;
        const double along = (p - a).dot(e);
        if (!(along > 0 && (p - b).dot(a - b) > 0)) continue;
        Vec3 normal = T.face.n;
        bool is_outside = true;
        detail::each_across(mesh, t, k, [&](const MeshTriangle& other, int edge) {
            is_outside = is_outside && !(other.edge[edge].height(p) < 0);
            if (!two_sided) normal += other.face.n;
        });
        if (!is_outside) continue;
        return detail::minimum_at(p, a + (along / e.dot(e)) * e, normal, two_sided);
    }
    for (int k = 0; k < 3; ++k) {
        if ((T.flags & MeshTriangle::owns_vertex << k) == 0) continue;
        const std::uint32_t v = T.vertex[k];
        const Vec3 at = mesh.vertex[v], d = p - at;
        bool is_closest = true;
        for (std::uint32_t m = mesh.fan_start[v]; is_closest && m < mesh.fan_start[v + 1]; ++m)
            is_closest = d.dot(mesh.vertex[mesh.fan[m]] - at) <= 0;
        if (is_closest) return detail::minimum_at(p, at, mesh.vertex_normal[v], two_sided);
    }
    return none;
}

namespace detail {

/// Lower bound of the distance from p to the planes that bisect the smooth edges of the triangle t which are
/// concave on the front, or on the back for sign = -1 [m]: negative if p is beyond one of these planes,
/// closer to the plane of the neighbour
HILDA_HD inline double distance_to_bisector(const MeshView& mesh, std::uint32_t t, const Vec3& p, double sign)
{
    const MeshTriangle& T = mesh.triangle[t];
    const std::uint32_t concave = sign < 0 ? MeshTriangle::smooth_convex : MeshTriangle::smooth_concave;
    double least = no_contact_distance;
    for (int k = 0; k < 3; ++k) {
        if ((T.flags & concave << k) == 0) continue;
        const MeshPlane& other = mesh.triangle[T.across[k]].face;
        // between triangles that are almost coplanar, heights over the angle would show rounding errors
        const double angle = (other.n - T.face.n).norm(), least_angle = 1e-3;
        const double distance =
            sign * (other.height(p) - T.face.height(p)) / (angle > least_angle ? angle : least_angle);
        if (distance < least) least = distance;
    }
    return least;
}

}  // namespace detail

/// Distance by which a point may move from p in any direction while the triangle t keeps a local minimum in
/// its inside, on the same side [m]; not positive if it has none there now
HILDA_HD inline double distance_in_face(const MeshView& mesh, std::uint32_t t, const Vec3& p)
{
    const MeshTriangle& T = mesh.triangle[t];
    const double height = T.face.height(p);
    double least = (T.flags & MeshTriangle::two_sided) != 0 && height < 0 ? -height : height;
    for (const MeshPlane& edge : T.edge) {
        const double inside = -edge.height(p);
        if (inside < least) least = inside;
    }
    if (!(least > 0)) return least;
    const double to_bisector = detail::distance_to_bisector(mesh, t, p, height < 0 ? -1 : 1);
    return to_bisector < least ? to_bisector : least;
}

/// Distance by which a point must move from p at least before the triangle t can own a local minimum [m]: the
/// largest violation of the conditions of nearest(), for the feature with the smallest one. Not positive if
/// it may own one now.
HILDA_HD inline double distance_to_ownership(const MeshView& mesh, std::uint32_t t, const Vec3& p)
{
    const MeshTriangle& T = mesh.triangle[t];
    const auto raise = [](double& to, double x) {
        if (x > to) to = x;
    };
    const double outside[3] = {T.edge[0].height(p), T.edge[1].height(p), T.edge[2].height(p)};
    double least = outside[0];
    raise(least, outside[1]), raise(least, outside[2]);
    if ((T.flags & MeshTriangle::two_sided) == 0)
        raise(least, -T.face.height(p)), raise(least, -detail::distance_to_bisector(mesh, t, p, 1));
    for (int k = 0; k < 3; ++k) {
        if (-outside[k] >= least || (T.flags & MeshTriangle::owns_edge << k) == 0) continue;
        const std::uint32_t u = T.vertex[k], v = T.vertex[k == 2 ? 0 : k + 1];
        const Vec3 a = mesh.vertex[u], b = mesh.vertex[v], e = (1 / (b - a).norm()) * (b - a);
        double violation = -outside[k];
        raise(violation, (a - p).dot(e)), raise(violation, (p - b).dot(e));
        detail::each_across(mesh, t, k, [&](const MeshTriangle& other, int edge) {
            raise(violation, -other.edge[edge].height(p));
        });
        if (violation < least) least = violation;
    }
    for (int k = 0; k < 3; ++k) {
        if ((T.flags & MeshTriangle::owns_vertex << k) == 0) continue;
        const std::uint32_t v = T.vertex[k];
        const Vec3 at = mesh.vertex[v], d = p - at;
        double violation = -no_contact_distance;
        for (std::uint32_t m = mesh.fan_start[v]; violation < least && m < mesh.fan_start[v + 1]; ++m) {
            const Vec3 e = mesh.vertex[mesh.fan[m]] - at;
            raise(violation, d.dot(e) / e.norm());
        }
        if (violation < least) least = violation;
    }
    return least;
}

/// The point of the triangle t that is closest to p, in the frame of the mesh.     Ericson (2005), Sec. 5.1.5
HILDA_HD inline Vec3 closest_point(const MeshView& mesh, std::uint32_t t, const Vec3& p)
{
    const MeshTriangle& T = mesh.triangle[t];
    const Vec3 a = mesh.vertex[T.vertex[0]], b = mesh.vertex[T.vertex[1]], c = mesh.vertex[T.vertex[2]];
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
                 d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0) return a;
    if (d3 >= 0 && d4 <= d3) return b;
    if (d6 >= 0 && d5 <= d6) return c;
    const double to_c = d1 * d4 - d3 * d2, to_b = d5 * d2 - d1 * d6, to_a = d3 * d6 - d5 * d4;
    if (to_c <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
    if (to_b <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
    if (to_a <= 0 && d4 >= d3 && d5 >= d6) return b + ((d4 - d3) / (d4 - d3 + d5 - d6)) * (c - b);
    return a + (1 / (to_a + to_b + to_c)) * (to_b * ab + to_c * ac);
}

}  // namespace hilda::granular
