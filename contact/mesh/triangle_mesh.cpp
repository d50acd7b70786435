// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/mesh/triangle_mesh.hpp"

#include "lie/check.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <tuple>
#include <utility>

namespace hilda::contact {

namespace {

constexpr double min_relative_area =
    1e-12;  // twice the area relative to the square of the longest edge; below is round-off

/// One side of a triangle, between the vertices low < high
struct Side {
    int low, high, triangle, number;
    bool rises;  // oriented from low to high

    bool operator<(const Side& b) const
    {
        return std::tie(low, high, triangle) < std::tie(b.low, b.high, b.triangle);
    }
};

/// The sides of all triangles, sorted so that the sides of one edge are adjacent
std::vector<Side> sides(const std::vector<Triangle>& triangles)
{
    std::vector<Side> all;
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
        for (int e = 0; e < 3; ++e) {
            const int from = triangles[t][e], to = triangles[t][(e + 1) % 3];
            all.push_back({std::min(from, to), std::max(from, to), t, e, from < to});
        }
    std::sort(all.begin(), all.end());
    return all;
}

std::string numbered(const char* thing, int number)
{
    return std::string(thing) + " " + std::to_string(number);
}

std::string fault_of_triangle(const std::vector<Vec3>& vertices, const Triangle& triangle)
{
    const int n = static_cast<int>(vertices.size());
    for (const int v : triangle)
        if (v < 0 || v >= n)
            return "has vertex " + std::to_string(v) + ", allowed are 0 to " + std::to_string(n - 1);
    const auto& [a, b, c] = triangle;
    const Vec3 ab = vertices[b] - vertices[a], ac = vertices[c] - vertices[a];
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(ab.cross(ac).norm() > min_relative_area * longest)) return "has zero area";
    return {};
}

std::string fault_of_edges(const std::vector<Triangle>& triangles)
{
    const std::vector<Side> all = sides(triangles);
    for (size_t k = 0; k < all.size();) {
        size_t end = k + 1;
        while (end < all.size() && all[end].low == all[k].low && all[end].high == all[k].high) ++end;
        const std::string edge =
            "the edge of the vertices " + std::to_string(all[k].low) + " and " + std::to_string(all[k].high);
        if (end - k == 1)
            return edge + " is open: it belongs to triangle " + std::to_string(all[k].triangle) + " only";
        if (end - k > 2)
            return edge + " belongs to " + std::to_string(end - k) + " triangles; it must belong to two";
        if (all[k].rises == all[k + 1].rises)
            return edge + " has the same direction in " + numbered("triangles", all[k].triangle) + " and " +
                   std::to_string(all[k + 1].triangle) + ": one of them has the wrong orientation";
        k = end;
    }
    return {};
}

std::vector<std::vector<int>> triangles_around(size_t vertices, const std::vector<Triangle>& triangles)
{
    std::vector<std::vector<int>> around(vertices);
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
        for (const int v : triangles[t]) around[v].push_back(t);
    return around;
}

int position_in(const Triangle& triangle, int vertex)
{
    return static_cast<int>(std::find(triangle.begin(), triangle.end(), vertex) - triangle.begin());
}

/// True if the triangles at a vertex form a single closed ring. Each of their sides at the vertex belongs to
/// two triangles of opposite direction (fault_of_edges). n log n for n triangles
bool is_one_ring(int vertex, const std::vector<int>& around, const std::vector<Triangle>& triangles)
{
    const auto after = [&](int t, int k) {
        return triangles[t][(position_in(triangles[t], vertex) + k) % 3];
    };
    std::vector<std::pair<int, int>> by_side;  // the vertex at the end of the first side, and the triangle
    for (const int t : around) by_side.emplace_back(after(t, 1), t);
    std::sort(by_side.begin(), by_side.end());
    int t = around[0];
    for (size_t steps = 1; steps <= around.size(); ++steps) {
        t = std::lower_bound(by_side.begin(), by_side.end(), std::pair(after(t, 2), 0))->second;
        if (t == around[0]) return steps == around.size();
    }
    return false;
}

/// The point of a triangle closest to p and its feature (see TriangleMesh::Nearest)
struct NearestInTriangle {
    int feature;
    Vec3 point;

    NearestInTriangle(const Vec3& p, const std::vector<Vec3>& vertices, const Triangle& t)
    {
        const Vec3 x[3] = {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
        const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]);
        double least = std::numeric_limits<double>::infinity();
        bool inside = true;
        for (int e = 0; e < 3; ++e) {
            const Vec3 &from = x[e], edge = x[(e + 1) % 3] - from;
            if (n.cross(edge).dot(p - from) >= 0) continue;
            inside = false;
            const double s = edge.dot(p - from) / edge.squaredNorm();
            const int f = s <= 0 ? 4 + e : s >= 1 ? 4 + (e + 1) % 3 : 1 + e;
            const Vec3 on_edge = from + std::clamp(s, 0.0, 1.0) * edge;
            if (const double d = (p - on_edge).squaredNorm(); d < least)
                least = d, feature = f, point = on_edge;
        }
        if (inside) feature = 0, point = p - n.dot(p - x[0]) / n.squaredNorm() * n;
    }
};

}  // namespace

std::optional<TriangleMesh::Fault> TriangleMesh::fault(const std::vector<Vec3>& vertices,
                                                       const std::vector<Triangle>& triangles)
{
    for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
        if (!vertices[v].allFinite()) return Fault{true, numbered("vertex", v) + " is not finite", v};
    if (triangles.empty()) return Fault{false, "a mesh must have triangles"};
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
        if (const std::string what = fault_of_triangle(vertices, triangles[t]); !what.empty())
            return Fault{false, numbered("triangle", t) + " " + what, t};
    if (const std::string what = fault_of_edges(triangles); !what.empty()) return Fault{false, what};

    const std::vector<std::vector<int>> around = triangles_around(vertices.size(), triangles);
    for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
        if (!around[v].empty() && !is_one_ring(v, around[v], triangles))
            return Fault{
                false, "the mesh is not a manifold: two parts of it share only vertex " + std::to_string(v)};

    double volume = 0;
    for (const auto& [a, b, c] : triangles) {
        const Vec3& o = vertices[triangles[0][0]];
        volume += (vertices[a] - o).dot((vertices[b] - o).cross(vertices[c] - o)) / 6;
    }
    if (!(volume > 0)) {
        std::ostringstream what;
        what << "the triangles must be counterclockwise as seen from outside: the enclosed volume is "
             << volume << " m^3";
        return Fault{false, what.str()};
    }
    return {};
}

TriangleMesh::TriangleMesh(std::vector<Vec3> given_vertices, std::vector<Triangle> given_triangles)
    : vertices(std::move(given_vertices)), triangles(std::move(given_triangles))
{
    if (const auto found = fault(vertices, triangles))
        throw lie::InvalidInput("contact::TriangleMesh: " + found->what);
    around = triangles_around(vertices.size(), triangles);

    const std::vector<Side> all = sides(triangles);
    across.resize(triangles.size());
    for (size_t k = 0; k < all.size(); k += 2) {
        across[all[k].triangle][all[k].number] = all[k + 1].triangle;
        across[all[k + 1].triangle][all[k + 1].number] = all[k].triangle;
    }

    vertex_normal.assign(vertices.size(), Vec3::Zero());
    for (const Triangle& triangle : triangles) {
        const Vec3 x[3] = {vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]};
        const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
        face_normal.push_back(n);
        for (int k = 0; k < 3; ++k) {
            const Vec3 one = x[(k + 1) % 3] - x[k], other = x[(k + 2) % 3] - x[k];
            vertex_normal[triangle[k]] += std::atan2(one.cross(other).norm(), one.dot(other)) * n;
        }
    }
    for (Vec3& n : vertex_normal) n.normalize();  // a zero vector stays zero

    order.resize(triangles.size());
    std::iota(order.begin(), order.end(), 0);
    build(0, static_cast<int>(order.size()));
}

double TriangleMesh::distance(int triangle, const Vec3& a) const
{
    return (a - NearestInTriangle(a, vertices, triangles[triangle]).point).norm();
}

Vec3 TriangleMesh::normal(int triangle, int feature) const
{
    if (feature == 0) return face_normal[triangle];
    if (feature <= 3)
        return (face_normal[triangle] + face_normal[across[triangle][feature - 1]]).normalized();
    return vertex_normal[triangles[triangle][feature - 4]];
}

int TriangleMesh::build(int first, int last)
{
    constexpr int leaf = 4;
    const int number = static_cast<int>(nodes.size());
    nodes.emplace_back();
    Eigen::AlignedBox3d box, middles;
    const auto middle = [&](int t) {
        return Vec3((vertices[triangles[t][0]] + vertices[triangles[t][1]] + vertices[triangles[t][2]]) / 3);
    };
    for (int k = first; k < last; ++k) {
        for (const int v : triangles[order[k]]) box.extend(vertices[v]);
        middles.extend(middle(order[k]));
    }
    int right = 0;
    if (last - first > leaf) {
        int axis = 0;
        middles.sizes().maxCoeff(&axis);
        const int half = (first + last) / 2;
        std::nth_element(order.begin() + first, order.begin() + half, order.begin() + last,
                         [&](int s, int t) { return middle(s)[axis] < middle(t)[axis]; });
        build(first, half);
        right = build(half, last);
    }
    nodes[number] = {box.min(), box.max(), first, right == 0 ? last - first : 0, right};
    return number;
}

TriangleMesh::Nearest TriangleMesh::nearest(const Vec3& a) const
{
    const auto squared_distance = [&](const Node& n) {
        return (a - a.cwiseMax(n.lower).cwiseMin(n.upper)).squaredNorm();
    };
    Nearest best{-1, 0, Vec3::Zero(), std::numeric_limits<double>::infinity()};
    double least = best.distance;
    struct Pending {
        int node;
        double squared;
    };
    std::array<Pending, 64> pending;  // the depth of a tree of 2³¹ triangles is smaller
    int count = 0;
    pending[count++] = {0, squared_distance(nodes[0])};
    while (count > 0) {
        const auto [at, squared] = pending[--count];
        if (!(squared < least)) continue;
        const Node& n = nodes[at];
        for (int k = n.first; k < n.first + n.count; ++k) {
            const NearestInTriangle near(a, vertices, triangles[order[k]]);
            if (const double d = (a - near.point).squaredNorm(); d < least) {
                least = d;
                best = {order[k], near.feature, near.point, 0};
            }
        }
        if (n.count > 0) continue;
        Pending left{at + 1, squared_distance(nodes[at + 1])},
            right{n.right, squared_distance(nodes[n.right])};
        if (left.squared < right.squared) std::swap(left, right);
        pending[count++] = left, pending[count++] = right;  // the closer child is visited first
    }
    best.distance = std::sqrt(least);
    return best;
}

}  // namespace hilda::contact
