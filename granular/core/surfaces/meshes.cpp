// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/surfaces/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hilda::granular {

constexpr double smooth_cosine = 0.93969262078590843;  // of 20 degrees

const Meshes::Part* Meshes::part_of(std::uint32_t boundary) const
{
    const auto at = std::lower_bound(part.begin(), part.end(), boundary,
                                     [](const Part& p, std::uint32_t b) { return p.boundary < b; });
    return at != part.end() && at->boundary == boundary ? &*at : nullptr;
}

void Meshes::add(const TriangleMesh& mesh, std::uint32_t boundary, bool two_sided)
{
    const auto first_vertex = static_cast<std::uint32_t>(vertex.size()),
               first = static_cast<std::uint32_t>(triangle.size()),
               vertices = static_cast<std::uint32_t>(mesh.vertex.size()),
               triangles = static_cast<std::uint32_t>(mesh.triangle.size());
    double radius = 0;
    for (const Vec3& v : mesh.vertex) radius = std::max(radius, v.norm());
    part.push_back({boundary, first, first + triangles, first_vertex, first_vertex + vertices, radius});
    vertex.reserve(first_vertex + std::size_t{vertices}), triangle.reserve(first + std::size_t{triangles});
    vertex_normal.reserve(vertex.capacity()), fan_start.reserve(vertex.capacity() + 1);
    vertex.insert(vertex.end(), mesh.vertex.begin(), mesh.vertex.end());
    vertex_normal.resize(vertex.size(), Vec3{0, 0, 0});

    struct Edge {
        std::uint32_t low, high, triangle, number;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * std::size_t{triangles});
    std::vector<std::uint32_t> owner(vertices, no_triangle);  // of each vertex
    for (std::uint32_t t = 0; t < triangles; ++t) {
        MeshTriangle T{};
        T.boundary = boundary;
        if (two_sided) T.flags = MeshTriangle::two_sided;
        Vec3 corner[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t u = mesh.triangle[t][k], v = mesh.triangle[t][(k + 1) % 3];
            corner[k] = mesh.vertex[u];
            T.vertex[k] = first_vertex + u, T.across[k] = no_triangle;
            edges.push_back({std::min(u, v), std::max(u, v), t, k});
            if (owner[u] == no_triangle) owner[u] = t, T.flags |= MeshTriangle::owns_vertex << k;
        }
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        const Vec3 n = (1 / normal.norm()) * normal;
        T.face = {n, n.dot(corner[0])};
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Vec3 a = corner[(k + 1) % 3] - corner[k], b = corner[(k + 2) % 3] - corner[k];
            vertex_normal[T.vertex[k]] += std::atan2(a.cross(b).norm(), a.dot(b)) * n;
            const Vec3 away = (1 / a.norm()) * a.cross(n);
            T.edge[k] = {away, away.dot(corner[k])};
        }
        triangle.push_back(T);
    }

    // The normals of a two-sided mesh can cancel. One of them is used then.
    for (std::uint32_t t = 0; two_sided && t < triangles; ++t)
        for (const std::uint32_t v : triangle[first + t].vertex)
            if (!(vertex_normal[v].norm() > 1e-9)) vertex_normal[v] = triangle[first + t].face.n;

    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    std::vector<std::uint32_t> count(vertices, 0);
    const auto each_edge = [&](const auto& f) {
        for (std::size_t k = 0; k < edges.size();) {
            std::size_t end = k + 1;
            while (end < edges.size() && edges[end].low == edges[k].low && edges[end].high == edges[k].high)
                ++end;
            f(k, end);
            k = end;
        }
    };
    const auto side = [&](std::size_t k) -> MeshTriangle& { return triangle[first + edges[k].triangle]; };
    each_edge([&](std::size_t k, std::size_t end) {
        MeshTriangle& a = side(k);
        a.flags |= MeshTriangle::owns_edge << edges[k].number;
        for (std::size_t m = k; end - k >= 2 && m < end; ++m)
            side(m).across[edges[m].number] = first + edges[m + 1 < end ? m + 1 : k].triangle;
        for (std::size_t m = k; end - k > 2 && m < end; ++m)  // coplanar ones; see below
            for (std::size_t n = m + 1; n < end; ++n) {
                const MeshPlane& plane = side(m).edge[edges[m].number];
                MeshPlane& other = side(n).edge[edges[n].number];
                if (plane.n.dot(other.n) < 0 && plane.n.cross(other.n).norm() < 1e-12)
                    other = {-plane.n, -plane.offset};
            }
        if (end - k == 2) {
            MeshTriangle& b = side(k + 1);
            const double cosine = a.face.n.dot(b.face.n);
            if (cosine > 0 && a.face.n.cross(b.face.n).norm() < 1e-12) {
                const MeshPlane& plane = a.edge[edges[k].number];
                b.edge[edges[k + 1].number] = {-plane.n, -plane.offset};
            } else if (cosine > smooth_cosine) {
                const std::uint32_t apex = b.vertex[(edges[k + 1].number + 2) % 3];
                const bool concave = a.face.height(vertex[apex]) > 0;
                const std::uint32_t flag =
                    concave ? MeshTriangle::smooth_concave : MeshTriangle::smooth_convex;
                a.flags |= flag << edges[k].number, b.flags |= flag << edges[k + 1].number;
            }
        }
        ++count[edges[k].low], ++count[edges[k].high];
    });
    std::vector<std::uint32_t> next(vertices);
    for (std::uint32_t v = 0; v < vertices; ++v) {
        next[v] = fan_start.back();
        fan_start.push_back(fan_start.back() + count[v]);
    }
    fan.resize(fan_start.back());
    each_edge([&](std::size_t k, std::size_t) {
        fan[next[edges[k].low]++] = first_vertex + edges[k].high;
        fan[next[edges[k].high]++] = first_vertex + edges[k].low;
    });
}

std::size_t Meshes::bytes() const
{
    const auto of = [](const auto&... lists) { return (... + (lists.capacity() * sizeof lists[0])); };
    return of(triangle, vertex, vertex_normal, fan_start, fan, part);
}

}  // namespace hilda::granular
