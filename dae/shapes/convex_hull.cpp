// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/shapes/convex_hull.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace hilda::dae {

namespace {

using lie::Vec3;

constexpr const char* hull_name = "dae::convex_hull";

struct Wrapping {
    const std::vector<Vec3>& points;
    const double tolerance;

    /// The corners of the plane face through point `a` with the outward unit normal n, counterclockwise
    std::vector<int> face(int a, const Vec3& n) const
    {
        const Vec3& origin = points[static_cast<std::size_t>(a)];
        std::vector<int> in_plane;
        for (std::size_t k = 0; k < points.size(); ++k)
            if (n.dot(points[k] - origin) > -tolerance) in_plane.push_back(static_cast<int>(k));
        // Andrew's monotone chain in the axes (x, y) of the plane
        const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
        const auto at = [&](int k) {
            const Vec3 d = points[static_cast<std::size_t>(k)] - origin;
            return Eigen::Vector2d(x.dot(d), y.dot(d));
        };
        std::sort(in_plane.begin(), in_plane.end(), [&](int k, int l) {
            const Eigen::Vector2d p = at(k), q = at(l);
            return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
        });
        // Whether l is not to the right of the line from k to m by more than the tolerance
        const auto is_no_corner = [&](int k, int l, int m) {
            const Eigen::Vector2d u = at(m) - at(k), v = at(l) - at(k);
            return u.x() * v.y() - u.y() * v.x() >= -tolerance * u.norm();
        };
        std::vector<int> corners;
        const auto chain = [&](const auto& list) {
            const std::size_t first = corners.size();
            for (const int k : list) {
                while (corners.size() >= first + 2 &&
                       is_no_corner(corners[corners.size() - 2], corners.back(), k))
                    corners.pop_back();
                corners.push_back(k);
            }
            corners.pop_back();
        };
        chain(in_plane);
        chain(std::vector<int>(in_plane.rbegin(), in_plane.rend()));
        return corners;
    }

    /// Turns a supporting plane with the outward unit normal n about the line through p along the unit vector
    /// u, from n towards s = u × n, until it meets a point that is not on the side of -s of the plane. -n if
    /// all points are there.
    Vec3 turned(const Vec3& p, const Vec3& u, const Vec3& n) const
    {
        const Vec3 s = u.cross(n);
        double least = std::numbers::pi;
        for (const Vec3& q : points) {
            const Vec3 d = q - p;
            const double across = d.dot(s), depth = -d.dot(n);
            if (std::hypot(across, depth) <= tolerance || (depth <= tolerance && across <= 0)) continue;
            least = std::min(least, std::atan2(std::max(depth, 0.), across));
        }
        return (std::cos(least) * n + std::sin(least) * s).normalized();
    }
};

}  // namespace

std::vector<std::vector<int>> convex_hull(const std::vector<Vec3>& points, double tolerance)
{
    const Wrapping of{points, tolerance};
    if (points.size() < 3) return {};
    // The first face: the plane x = const at the lowest point in the order (x, y, z) is turned about the y
    // axis until it meets a second point, and about the line of both until it meets a third one.
    const auto lowest = std::min_element(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    });
    const Vec3& p = *lowest;
    const auto farthest = [&](const auto& distance) {
        return *std::max_element(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
            return distance(a - p) < distance(b - p);
        });
    };
    const Vec3 line = farthest([](const Vec3& d) { return d.norm(); }) - p;
    const auto from_line = [&](const Vec3& d) { return d.cross(line).norm(); };
    if (!(line.norm() > tolerance) || !(from_line(farthest(from_line) - p) > tolerance * line.norm()))
        return {};
    Vec3 n = of.turned(p, Vec3::UnitY(), -Vec3::UnitX());
    const Vec3 second =
        farthest([&](const Vec3& d) { return std::abs(n.dot(d)) <= tolerance ? d.norm() : 0; }) - p;
    if (second.norm() > tolerance) n = of.turned(p, second.normalized(), n);

    std::vector<std::vector<int>> faces;
    std::set<std::pair<int, int>> sides;                      // the edges of the faces, in their directions
    std::vector<std::pair<std::pair<int, int>, Vec3>> stack;  // edges and the normals of their faces
    const auto add = [&](const std::vector<int>& corners, const Vec3& normal) {
        if (corners.size() < 3)
            lie::reject(hull_name, "the points must have a convex hull with faces", "a degenerate face");
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const std::pair edge(corners[k], corners[(k + 1) % corners.size()]);
            if (!sides.insert(edge).second)
                lie::reject(hull_name,
                            "the faces of the convex hull must close; points may be too close to each other",
                            "two faces at the same side of an edge");
            stack.emplace_back(edge, normal);
        }
        faces.push_back(corners);
    };
    add(of.face(static_cast<int>(lowest - points.begin()), n), n);
    constexpr std::size_t most = 100000;
    while (!stack.empty()) {
        const auto [edge, normal] = stack.back();
        stack.pop_back();
        if (sides.contains({edge.second, edge.first})) continue;
        const Vec3 &a = points[static_cast<std::size_t>(edge.first)],
                   &b = points[static_cast<std::size_t>(edge.second)];
        const Vec3 other = of.turned(a, (b - a).normalized(), normal);
        if (faces.size() > most)
            lie::reject(hull_name, "the faces of the convex hull must close", faces.size());
        add(of.face(edge.first, other), other);
    }
    return faces;
}

double extent(const std::vector<Vec3>& points)
{
    double largest = 0;
    for (const Vec3& x : points) largest = std::max(largest, (x - points[0]).norm());
    return largest;
}

Vec3 area_vector(const std::vector<int>& corners, const std::vector<Vec3>& points)
{
    const Vec3& o = points[static_cast<std::size_t>(corners[0])];
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        sum += (points[static_cast<std::size_t>(corners[k])] - o)
                   .cross(points[static_cast<std::size_t>(corners[k + 1])] - o);
    return sum;
}

std::optional<InsidePoint> inside_point(const std::vector<Vec3>& points,
                                        const std::vector<std::vector<int>>& faces, double depth)
{
    std::vector<char> is_corner(points.size(), 0);
    std::vector<std::pair<Vec3, double>> planes;
    for (const std::vector<int>& face : faces) {
        for (const int k : face) is_corner[static_cast<std::size_t>(k)] = 1;
        const Vec3 n = area_vector(face, points).normalized();
        planes.emplace_back(n, n.dot(points[static_cast<std::size_t>(face[0])]));
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (is_corner[k] != 0) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [n, d] : planes) least = std::min(least, d - n.dot(points[k]));
        if (!(least <= depth)) return InsidePoint{k, least};
    }
    return {};
}

}  // namespace hilda::dae
