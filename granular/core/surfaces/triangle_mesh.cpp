// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/surfaces/triangle_mesh.hpp"

#include "io/error.hpp"
#include "io/json.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Twice the least area of a triangle over the square of its longest edge. Below is round-off of the
/// vertices.
constexpr double least_relative_area = 1e-12;

/// One side of a triangle: the larger vertex of its edge, and 3 · triangle + number of its first vertex
struct Side {
    std::uint32_t high;
    std::uint64_t number;

    std::size_t triangle() const { return static_cast<std::size_t>(number / 3); }
    bool operator<(const Side& o) const { return high != o.high ? high < o.high : number < o.number; }
};

[[noreturn]] void refuse(const std::string& name, std::size_t triangle, const std::string& what)
{
    throw io::InvalidInput(name + ": triangle " + std::to_string(triangle) + ' ' + what);
}

std::string text(const Vec3& r)
{
    return '(' + io::shortest(r.x) + ", " + io::shortest(r.y) + ", " + io::shortest(r.z) + ')';
}

void check_indices(const TriangleMesh& mesh, const std::string& name)
{
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (const std::uint32_t v : mesh.triangle[t])
            if (v >= mesh.vertex.size())
                refuse(name, t,
                       "must have vertices below " + std::to_string(mesh.vertex.size()) + ", got " +
                           std::to_string(v));
}

bool is_finite(const Vec3& r) { return std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z); }

void check_vertices(const TriangleMesh& mesh, const std::string& name)
{
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (const std::uint32_t v : mesh.triangle[t])
            if (!is_finite(mesh.vertex[v]))
                refuse(name, t,
                       "must have finite vertices, got " + text(mesh.vertex[v]) + " at vertex " +
                           std::to_string(v));
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v)  // those without a triangle
        if (!is_finite(mesh.vertex[v]))
            throw io::InvalidInput(name + ": vertex " + std::to_string(v) + " must be finite, got " +
                                   text(mesh.vertex[v]));
}

/// Twice the area over the square of the longest edge. The edges are scaled before they are multiplied, so
/// that very small and very large triangles neither underflow nor overflow. 0 for a point, NaN if the length
/// of an edge overflows.
double relative_area(const Vec3& a, const Vec3& b, const Vec3& c)
{
    Vec3 ab = b - a, ac = c - a;
    const double scale = std::max(
        {std::abs(ab.x), std::abs(ab.y), std::abs(ab.z), std::abs(ac.x), std::abs(ac.y), std::abs(ac.z)});
    if (scale == 0) return 0;
    // a quotient, because the reciprocal of a subnormal scale is infinite
    ab = {ab.x / scale, ab.y / scale, ab.z / scale}, ac = {ac.x / scale, ac.y / scale, ac.z / scale};
    const Vec3 bc = ac - ab;
    return ab.cross(ac).norm() / std::max({ab.dot(ab), ac.dot(ac), bc.dot(bc)});
}

void check_areas(const TriangleMesh& mesh, const std::string& name)
{
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        if (a == b || b == c || c == a)
            refuse(name, t,
                   "must have three different vertices, got " + std::to_string(a) + ", " + std::to_string(b) +
                       " and " + std::to_string(c));
        const double area = relative_area(mesh.vertex[a], mesh.vertex[b], mesh.vertex[c]);
        if (!(area > least_relative_area))
            refuse(name, t,
                   "must have an area: twice its area over the square of its longest edge must exceed " +
                       io::shortest(least_relative_area) + ", got " + io::shortest(area));
    }
}

/// Calls use(low, first, last) for each edge with its sides, in the order of the vertices low < high of the
/// edges; the sides of one edge are in the order of the triangles.
///
/// The sides are counted and sorted by their lower vertices first, which takes linear time. The few sides of
/// each vertex are sorted by comparison then.
template <class Use>
void for_each_edge(const TriangleMesh& mesh, const Use& use)
{
    const auto ends = [&](std::size_t t, std::size_t k) {
        return std::minmax(mesh.triangle[t][k], mesh.triangle[t][(k + 1) % 3]);
    };
    std::vector<std::size_t> begin(mesh.vertex.size() + 2, 0);  // of vertex v at v + 1 while they are filled
    for (const auto& t : mesh.triangle)
        for (std::size_t k = 0; k < 3; ++k) ++begin[std::min(t[k], t[(k + 1) % 3]) + std::size_t{2}];
    for (std::size_t v = 2; v < begin.size(); ++v) begin[v] += begin[v - 1];
    std::vector<Side> sides(3 * mesh.triangle.size());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = ends(t, k);
            sides[begin[low + std::size_t{1}]++] = {high, 3 * t + k};
        }
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
        Side* first = sides.data() + begin[v];
        Side* const end = sides.data() + begin[v + 1];
        std::sort(first, end);
        while (first != end) {
            Side* last = first + 1;
            while (last != end && last->high == first->high) ++last;
            use(v, first, last);
            first = last;
        }
    }
}

void check_edges(const TriangleMesh& mesh, const std::string& name, bool two_sided)
{
    // whether the side goes from the lower vertex of its edge to the higher one
    const auto rises = [&](const Side& s) {
        return mesh.triangle[s.triangle()][static_cast<std::size_t>(s.number % 3)] != s.high;
    };
    for_each_edge(mesh, [&](std::size_t low, const Side* first, const Side* last) {
        const auto edge = [&] {
            return "the edge of vertices " + std::to_string(low) + " and " + std::to_string(first->high);
        };
        if (last - first > 2 && !two_sided)
            refuse(name, first[2].triangle(),
                   "must not be the third one at an edge: " + edge() +
                       " must have at most 2 triangles, or the mesh be two_sided, got " +
                       std::to_string(last - first));
        if (last - first == 2 && rises(first[0]) == rises(first[1]))
            refuse(name, first[1].triangle(),
                   "must have the orientation of its neighbours: its direction along " + edge() +
                       " must be opposite to that of triangle " + std::to_string(first[0].triangle()) +
                       ", got the same");
    });
}

/// Σ det(a, b, c) and its products with the coordinates, over triangles a, b, c
struct Moments {
    double volume = 0;           ///< six times the volume
    Vec3 first = {0, 0, 0};      ///< 24 ∫ x dV
    std::array<double, 6> xx{};  ///< 120 ∫ of xx, yy, zz, xy, yz, zx

    /// Adds the tetrahedron of the triangle and the origin:
    ///     ∫ x_i x_j dV = det(a, b, c)/120 (a_i a_j + b_i b_j + c_i c_j + s_i s_j),  s = a + b + c
    void add(const Vec3& a, const Vec3& b, const Vec3& c)
    {
        const double det = a.dot(b.cross(c));
        const Vec3 s = a + b + c;
        volume += det;
        first += det * s;
        xx[0] += det * (a.x * a.x + b.x * b.x + c.x * c.x + s.x * s.x);
        xx[1] += det * (a.y * a.y + b.y * b.y + c.y * c.y + s.y * s.y);
        xx[2] += det * (a.z * a.z + b.z * b.z + c.z * c.z + s.z * s.z);
        xx[3] += det * (a.x * a.y + b.x * b.y + c.x * c.y + s.x * s.y);
        xx[4] += det * (a.y * a.z + b.y * b.z + c.y * c.z + s.y * s.z);
        xx[5] += det * (a.z * a.x + b.z * b.x + c.z * c.x + s.z * s.x);
    }
};

/// Centre of the box around the vertices
Vec3 middle(const std::vector<Vec3>& vertices)
{
    if (vertices.empty()) return {0, 0, 0};
    BoundingBox box;
    for (const Vec3& v : vertices) box.add(v);
    return 0.5 * box.low + 0.5 * box.high;
}

}  // namespace

void BoundingBox::add(const Vec3& r)
{
    low = {std::min(low.x, r.x), std::min(low.y, r.y), std::min(low.z, r.z)};
    high = {std::max(high.x, r.x), std::max(high.y, r.y), std::max(high.z, r.z)};
}

void check_mesh(const TriangleMesh& mesh, const std::string& name, bool two_sided)
{
    if (mesh.triangle.empty()) throw io::InvalidInput(name + ": a mesh must have a triangle, got none");
    if (mesh.triangle.size() > TriangleMesh::most_triangles)
        throw io::InvalidInput(name + ": a mesh must have at most " +
                               std::to_string(TriangleMesh::most_triangles) + " triangles, got " +
                               std::to_string(mesh.triangle.size()));
    check_indices(mesh, name);
    check_vertices(mesh, name);
    check_areas(mesh, name);
    check_edges(mesh, name, two_sided);
}

std::size_t open_edges(const TriangleMesh& mesh)
{
    check_indices(mesh, "granular::open_edges");
    std::size_t n = 0;
    for_each_edge(mesh, [&](std::size_t, const Side* first, const Side* last) { n += last - first == 1; });
    return n;
}

MassProperties mass_properties(const TriangleMesh& mesh)
{
    check_indices(mesh, "granular::mass_properties");
    // The tetrahedra have their apex near the solid, so that their sum does not cancel if it is far from the
    // origin.
    const Vec3 apex = middle(mesh.vertex);
    Moments sum;
    for (const auto& [a, b, c] : mesh.triangle)
        sum.add(mesh.vertex[a] - apex, mesh.vertex[b] - apex, mesh.vertex[c] - apex);

    MassProperties p;
    p.volume = sum.volume / 6;
    // A mesh that encloses nothing has no centre. The apex takes its place, not NaN.
    const Vec3 d = sum.volume == 0 ? Vec3{0, 0, 0} : (1 / (4 * sum.volume)) * sum.first;
    p.centre = apex + d;
    // about the centre: ∫ x_i x_j dV - V d_i d_j
    const auto moment = [&](std::size_t k, double d_i, double d_j) {
        return sum.xx[k] / 120 - p.volume * d_i * d_j;
    };
    const double xx = moment(0, d.x, d.x), yy = moment(1, d.y, d.y), zz = moment(2, d.z, d.z);
    p.J = {yy + zz, zz + xx, xx + yy, -moment(3, d.x, d.y), -moment(4, d.y, d.z), -moment(5, d.z, d.x)};
    return p;
}

}  // namespace hilda::granular
