// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/polytope.hpp"

#include "contact/surfaces/area_shares.hpp"
#include "contact/surfaces/positive.hpp"
#include "contact/tessellation.hpp"
#include "dae/shapes/convex_hull.hpp"
#include "io/json.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace hilda::contact {

namespace {

constexpr const char* polytope_name = Polytope::where.data();
constexpr double coincident = Polytope::tolerance_of_vertices;

Vec3 closest_of_segment(const Vec3& a, const Vec3& p, const Vec3& q)
{
    const Vec3 d = q - p;
    return p + std::clamp((a - p).dot(d) / d.squaredNorm(), 0., 1.) * d;
}

}  // namespace

Polytope::Polytope(std::vector<Vec3> points, double r, std::string name, double relative_tolerance)
    : vertex(std::move(points)), radius(r), type(std::move(name))
{
    if (!(radius >= 0) || !std::isfinite(radius))
        lie::reject(polytope_name, "the radius must not be negative", radius);
    if (vertex.empty()) lie::reject(polytope_name, "a " + type + " needs vertices", "none");
    for (std::size_t k = 0; k < vertex.size(); ++k)
        if (!vertex[k].allFinite())
            lie::reject(polytope_name, "vertex " + std::to_string(k) + " must be finite",
                        vertex[k].transpose());
    for (const Vec3& v : vertex) farthest = std::max(farthest, v.norm());
    const double tolerance = relative_tolerance * dae::extent(vertex);
    for (std::size_t k = 0; k < vertex.size(); ++k)
        for (std::size_t l = 0; l < k; ++l)
            if (!((vertex[k] - vertex[l]).norm() > tolerance))
                lie::reject(polytope_name, "the vertices must differ",
                            "vertices " + std::to_string(l) + " and " + std::to_string(k) + " at one place");

    std::map<std::pair<int, int>, int> face_left_of;  // of an edge in the direction of the face
    const std::vector<std::vector<int>> faces = dae::convex_hull(vertex, tolerance);
    for (const std::vector<int>& corners : faces) {
        const auto number = static_cast<int>(face.size());
        const Vec3 n = dae::area_vector(corners, vertex).normalized();
        face.push_back({corners, {}, n, n.dot(vertex[static_cast<std::size_t>(corners[0])])});
        for (std::size_t k = 0; k < corners.size(); ++k)
            face_left_of[{corners[k], corners[(k + 1) % corners.size()]}] = number;
    }
    for (const auto& [ends, left] : face_left_of)
        if (ends.first < ends.second)
            edge.push_back({ends.first, ends.second, {left, face_left_of.at({ends.second, ends.first})}});
    for (Face& f : face)
        for (std::size_t k = 0; k < f.vertex.size(); ++k) {
            const auto [a, b] = std::minmax(f.vertex[k], f.vertex[(k + 1) % f.vertex.size()]);
            const auto found = std::lower_bound(
                edge.begin(), edge.end(), std::pair(a, b),
                [](const Edge& e, const std::pair<int, int>& ends) { return std::pair(e.a, e.b) < ends; });
            f.edge.push_back(static_cast<int>(found - edge.begin()));
        }
    if (face.empty() && vertex.size() > 2)
        lie::reject(polytope_name, "the vertices must not lie on a line", vertex.size());
    if (vertex.size() == 2) edge.push_back({0, 1, {-1, -1}});

    std::vector<char> is_corner(vertex.size(), face.empty() ? 1 : 0);
    for (const Face& f : face)
        for (const int v : f.vertex) is_corner[static_cast<std::size_t>(v)] = 1;
    if (is_solid())
        if (const auto inside = dae::inside_point(vertex, faces, 2 * tolerance); inside)
            lie::reject(polytope_name, "the vertices must be those of a convex body",
                        "vertex " + std::to_string(inside->number) + ", which lies " +
                            io::shortest(inside->depth) + " m inside of their hull");
    // Points of faces that are not corners are left out.
    std::vector<int> number(vertex.size(), -1);
    std::vector<Vec3> corners;
    for (std::size_t k = 0; k < vertex.size(); ++k)
        if (is_corner[k] != 0) number[k] = static_cast<int>(corners.size()), corners.push_back(vertex[k]);
    const auto renumber = [&](int& v) { v = number[static_cast<std::size_t>(v)]; };
    for (Face& f : face) std::for_each(f.vertex.begin(), f.vertex.end(), renumber);
    for (Edge& e : edge) renumber(e.a), renumber(e.b);
    vertex = std::move(corners);
    set_shares();
    set_sizes();
}

void Polytope::set_shares()
{
    if (face.empty()) return;
    faces_at.resize(vertex.size());
    std::vector<Vec3> outline;
    std::vector<double> share;
    for (std::size_t f = 0; f < face.size(); ++f) {
        outline.clear();
        for (const int v : face[f].vertex) outline.push_back(vertex[static_cast<std::size_t>(v)]);
        area_shares(outline, share);
        for (std::size_t k = 0; k < share.size(); ++k)
            faces_at[static_cast<std::size_t>(face[f].vertex[k])].push_back({static_cast<int>(f), share[k]});
    }
}

double Polytope::share_of_vertex(int v, const Vec3& u) const
{
    if (face.empty()) return 1. / static_cast<double>(vertex.size());
    double sum = 0, of_shares = 0, mean = 0;
    const std::vector<FaceAtVertex>& around = faces_at[static_cast<std::size_t>(v)];
    for (const FaceAtVertex& at : around) {
        const double cosine = std::max(0., face[static_cast<std::size_t>(at.face)].n.dot(u)),
                     square = cosine * cosine, weight = square * square * square * square;
        sum += weight, of_shares += weight * at.share;
        mean += at.share / static_cast<double>(around.size());
    }
    return sum > 0 ? of_shares / sum : mean;
}

void Polytope::set_sizes()
{
    const auto width = [&](const Vec3& n) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (const Vec3& v : vertex) least = std::min(least, n.dot(v)), most = std::max(most, n.dot(v));
        return most - least;
    };
    double smallest = std::numeric_limits<double>::infinity();
    if (is_solid())
        for (const Face& f : face) smallest = std::min(smallest, width(f.n));
    else if (!face.empty())
        for (const Edge& e : edge)
            smallest = std::min(smallest, width(face[0]
                                                    .n
                                                    .cross(vertex[static_cast<std::size_t>(e.b)] -
                                                           vertex[static_cast<std::size_t>(e.a)])
                                                    .normalized()));
    half_width = std::isfinite(smallest) ? 0.5 * smallest : 0;
    if (!(size() > 0)) half_width = 0.5 * farthest;
    if (!(size() > 0)) lie::reject(polytope_name, "a " + type + " of one vertex needs a radius", radius);
}

Polytope Polytope::box(const Vec3& lengths, double radius)
{
    if (!(lengths.minCoeff() > 0) || !lengths.allFinite())
        lie::reject(polytope_name, "the lengths of a box must be positive", lengths.transpose());
    std::vector<Vec3> corners;
    for (const double z : {-1., 1.})
        for (const double y : {-1., 1.})
            for (const double x : {-1., 1.}) corners.push_back(0.5 * lengths.cwiseProduct(Vec3(x, y, z)));
    return Polytope(std::move(corners), radius, "box");
}

Polytope Polytope::capsule(double length, double radius)
{
    positive(polytope_name, "the length of a capsule", length);
    positive(polytope_name, "the radius of a capsule", radius);
    return Polytope({Vec3(0, 0, -0.5 * length), Vec3(0, 0, 0.5 * length)}, radius, "capsule");
}

Polytope Polytope::polygon(const std::vector<Eigen::Vector2d>& corners, double radius)
{
    if (corners.size() < 3)
        lie::reject(polytope_name, "a polygon needs at least three vertices", corners.size());
    std::vector<Vec3> vertices;
    for (const Eigen::Vector2d& c : corners) vertices.emplace_back(c.x(), c.y(), 0);
    const std::size_t given = vertices.size();
    Polytope p(std::move(vertices), radius, "polygon");
    if (p.vertex.size() < given)
        lie::reject(polytope_name, "the vertices of a polygon must be the corners of a convex polygon",
                    std::to_string(p.vertex.size()) + " corners of " + std::to_string(given) + " vertices");
    return p;
}

double Polytope::depth_in_core(const Vec3& a, int& nearest_face) const
{
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < face.size(); ++k)
        if (const double height = face[k].n.dot(a) - face[k].d; height > most)
            most = height, nearest_face = static_cast<int>(k);
    return most;
}

Vec3 Polytope::closest_of_core(const Vec3& a) const
{
    Vec3 best = vertex[0];
    double least = (a - best).squaredNorm();
    const auto take = [&](const Vec3& c) {
        if (const double d = (a - c).squaredNorm(); d < least) least = d, best = c;
    };
    const auto at = [&](int v) -> const Vec3& { return vertex[static_cast<std::size_t>(v)]; };
    for (const Edge& e : edge) take(closest_of_segment(a, at(e.a), at(e.b)));
    for (const Face& f : face) {
        const double height = f.n.dot(a) - f.d;
        if (height < 0) continue;
        const Vec3 c = a - height * f.n;
        bool inside = true;
        for (std::size_t k = 0; k < f.vertex.size() && inside; ++k) {
            const Vec3 &p = at(f.vertex[k]), &q = at(f.vertex[(k + 1) % f.vertex.size()]);
            inside = f.n.dot((q - p).cross(c - p)) >= 0;
        }
        if (inside) take(c);
    }
    return best;
}

double Polytope::value(const Vec3& a) const
{
    int nearest = 0;
    if (is_solid())
        if (const double depth = depth_in_core(a, nearest); depth <= 0) return depth - radius;
    return (a - closest_of_core(a)).norm() - radius;
}

Vec3 Polytope::gradient(const Vec3& a) const
{
    int nearest = 0;
    if (is_solid() && depth_in_core(a, nearest) <= 0) return face[static_cast<std::size_t>(nearest)].n;
    const Vec3 d = a - closest_of_core(a);
    if (d.norm() > 0) return d.normalized();
    return face.empty() ? Vec3(Vec3::Zero()) : face[static_cast<std::size_t>(nearest)].n;
}

Mat3 Polytope::hessian(const Vec3& a) const
{
    int nearest = 0;
    if (is_solid() && depth_in_core(a, nearest) <= 0) return Mat3::Zero();
    const Vec3 c = closest_of_core(a), d = a - c;
    const double distance = d.norm();
    if (!(distance > 0)) return Mat3::Zero();
    const Vec3 n = d / distance;
    // the directions in which c moves with a: those of the face or of the edge that contains c
    const double touch = coincident * (farthest + distance);
    for (const Face& f : face)
        if (std::abs(f.n.dot(c) - f.d) <= touch && n.cross(f.n).norm() <= coincident) return Mat3::Zero();
    Mat3 across = Mat3::Identity() - n * n.transpose();
    for (const Edge& e : edge) {
        const Vec3 &p = vertex[static_cast<std::size_t>(e.a)], &q = vertex[static_cast<std::size_t>(e.b)];
        const Vec3 t = (q - p).normalized();
        if ((c - p).norm() > touch && (c - q).norm() > touch &&
            (c - closest_of_segment(c, p, q)).norm() <= touch) {
            across -= t * t.transpose();
            break;
        }
    }
    return across / distance;
}

std::optional<Vec3> Polytope::support(const Vec3& u) const
{
    return Vec3(vertex[static_cast<std::size_t>(farthest_vertex(u))] + radius * u);
}

int Polytope::farthest_vertex(const Vec3& u) const
{
    int found = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < vertex.size(); ++k)
        if (const double s = u.dot(vertex[k]); s > most) most = s, found = static_cast<int>(k);
    return found;
}

Vec3 Polytope::project(const Vec3& a) const
{
    const Vec3 u = gradient(a);
    if (!(u.norm() > 0))
        throw lie::NumericalFailure("contact_not_converged",
                                    "a point of the core of a " + type + " has no unique closest point");
    return a - value(a) * u;
}

PolygonMesh Polytope::drawing(const DrawingExtent& extent) const
{
    if (radius > 0) return Surface::drawing(extent);
    PolygonMesh mesh{.point = vertex, .polygon = {}};
    for (const Face& f : face) mesh.polygon.push_back(f.vertex);
    return mesh;
}

}  // namespace hilda::contact
