// SPDX-License-Identifier: GPL-3.0-or-later
/// Convex polytopes, flat plates and capsules, with or without a rounding radius.

#pragma once

#include "contact/surface.hpp"
#include "dae/shapes/convex_hull.hpp"

#include <array>
#include <string_view>
#include <vector>

namespace hilda::contact {

/// The convex hull of points, the core, with all points at most a radius away from it (Minkowski sum with a
/// ball). A core may be a solid, a plane polygon (a plate of thickness zero with two faces), a segment (with
/// a radius: a capsule) or a point (a ball).
///
///     G = max_k (n_k · ᾱ - d_k) - radius    inside of the core of a solid
///     G = distance to the core - radius     elsewhere
class Polytope final : public Surface {
public:
    struct Face {
        std::vector<int> vertex;  ///< counterclockwise, seen from outside
        std::vector<int> edge;    ///< edge[k] joins vertex[k] and the next one
        Vec3 n;                   ///< outward unit normal
        double d;                 ///< n · ᾱ = d on the face [m]
    };
    struct Edge {
        int a, b;                 ///< vertices
        std::array<int, 2> face;  ///< those that meet at it; -1 for the edge of a segment
    };

    /// The hull of these points [m]. InvalidInput for points that are not finite or coincide, and if a point
    /// is inside of the hull of the others, with its number and depth.
    /// Distances below `tolerance` times the largest distance from the first point are zero.
    explicit Polytope(std::vector<Vec3> points, double radius = 0, std::string name = "convex",
                      double tolerance = tolerance_of_vertices);
    static constexpr std::string_view where = "contact::Polytope";  ///< with which its messages begin
    static constexpr double tolerance_of_vertices = dae::hull_tolerance,
                            tolerance_of_files = dae::hull_tolerance_of_files;
    static Polytope box(const Vec3& lengths, double radius = 0);  ///< edge lengths [m], about the origin
    static Polytope capsule(double length, double radius);        ///< axis z, `length` between the centres
    static Polytope polygon(const std::vector<Eigen::Vector2d>& corners, double radius = 0);  ///< in z = 0

    std::string name() const override { return type; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    bool convex() const override { return true; }
    /// A vertex that is farthest along u, moved by the radius; one of them if there are several
    std::optional<Vec3> support(const Vec3& u) const override;
    Vec3 project(const Vec3& a) const override;
    /// Half of the smallest width of the core, across its faces for a solid, in its plane for a polygon, plus
    /// the radius
    double size() const override { return half_width + radius; }
    bool is_smooth() const override { return false; }
    double bounding_radius() const override { return farthest + radius; }
    PolygonMesh drawing(const DrawingExtent& extent) const override;

    /// Number of the vertex of the core that is farthest along u; the lowest of several
    int farthest_vertex(const Vec3& u) const;
    /// The part of the contact with a plane that a vertex stands for: the mean of its parts of the areas of
    /// its faces, weighted by the eighth power of n · u, with the direction u of the plane in the frame of
    /// the body. It is the part of a face that lies on the plane, and it is continuous in u.
    double share_of_vertex(int v, const Vec3& u) const;
    /// The point of the core closest to a point outside of it
    Vec3 closest_of_core(const Vec3& a) const;

    std::vector<Vec3> vertex;  ///< of the core [m]
    std::vector<Face> face;    ///< empty for a segment and a point
    std::vector<Edge> edge;

    /// The part of the area of a face that is near a vertex, see area_shares()
    struct FaceAtVertex {
        int face;
        double share;
    };
    std::vector<std::vector<FaceAtVertex>> faces_at;  ///< of each vertex; empty without faces
    const double radius;                              ///< [m]

private:
    bool is_solid() const { return face.size() > 2; }
    double depth_in_core(const Vec3& a, int& nearest_face) const;
    void set_shares();
    void set_sizes();

    std::string type;
    double half_width = 0, farthest = 0;
};

}  // namespace hilda::contact
