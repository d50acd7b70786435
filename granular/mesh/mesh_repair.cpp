// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/mesh/mesh_repair.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace hilda::granular {

namespace {

constexpr double joined_distance = 1e-9;  ///< over the size of the mesh

/// The vertex that takes the place of each vertex: the first one of those within `tolerance`, in the order
/// along x
std::vector<std::uint32_t> joined_vertices(const std::vector<Vec3>& vertex, double tolerance, Welded& welded)
{
    std::vector<std::uint32_t> by_x(vertex.size()), place(vertex.size());
    std::iota(by_x.begin(), by_x.end(), 0u), std::iota(place.begin(), place.end(), 0u);
    std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tie(vertex[a].x, vertex[a].y, vertex[a].z, a) <
               std::tie(vertex[b].x, vertex[b].y, vertex[b].z, b);
    });
    std::map<std::array<long, 2>, std::vector<std::uint32_t>> ahead;  // kept vertices by y and z
    std::size_t first = 0;
    std::vector<std::uint32_t> kept;
    const auto cell = [&](double y, double z) {
        const double width = 2 * tolerance;
        return std::array{std::lround(std::floor(y / width)), std::lround(std::floor(z / width))};
    };
    for (const std::uint32_t v : by_x) {
        const Vec3& at = vertex[v];
        for (; first < kept.size() && vertex[kept[first]].x < at.x - tolerance; ++first) {
            const auto list = ahead.find(cell(vertex[kept[first]].y, vertex[kept[first]].z));
            list->second.erase(list->second.begin());  // the oldest one
            if (list->second.empty()) ahead.erase(list);
        }
        const auto home = cell(at.y, at.z);
        for (long y = home[0] - 1; y <= home[0] + 1 && place[v] == v; ++y)
            for (long z = home[1] - 1; z <= home[1] + 1 && place[v] == v; ++z)
                if (const auto list = ahead.find({y, z}); list != ahead.end())
                    for (const std::uint32_t other : list->second) {
                        const double distance = (vertex[other] - at).norm();
                        if (!(distance <= tolerance)) continue;
                        place[v] = other;
                        if (distance > 0) ++welded.vertices;
                        welded.distance = std::max(welded.distance, distance);
                        break;
                    }
        if (place[v] == v) ahead[home].push_back(v), kept.push_back(v);
    }
    return place;
}

}  // namespace

Welded weld(TriangleMesh& mesh)
{
    Welded welded;
    BoundingBox box;
    for (const Vec3& v : mesh.vertex) box.add(v);
    const Vec3 size = box.high - box.low;
    const double tolerance = joined_distance * std::max({size.x, size.y, size.z}), farthest = 1e9 * tolerance;
    if (!(tolerance > 0) || !std::isfinite(farthest)) return welded;
    // The cells are numbered by integers: a mesh that is much farther from the origin than its size has no
    // distances as small as the tolerance.
    const double away =
        std::max({std::abs(box.low.y), std::abs(box.high.y), std::abs(box.low.z), std::abs(box.high.z)});
    if (!(away < 1e6 * farthest)) return welded;
    const std::vector<std::uint32_t> place = joined_vertices(mesh.vertex, tolerance, welded);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::set<std::array<std::uint32_t, 3>> seen;
    for (auto t : mesh.triangle) {
        bool is_valid = true, has_changed = false;
        for (std::uint32_t& v : t) {
            is_valid = is_valid && v < place.size();
            if (is_valid) has_changed = has_changed || place[v] != v, v = place[v];
        }
        if (is_valid && has_changed && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])) {
            ++welded.triangles;
            continue;
        }
        auto turned = t;
        std::rotate(turned.begin(), std::min_element(turned.begin(), turned.end()), turned.end());
        if (!seen.insert(turned).second)
            ++welded.triangles;
        else
            triangles.push_back(t);
    }
    mesh.triangle = std::move(triangles);
    return welded;
}

std::size_t remove_copies(TriangleMesh& mesh)
{
    std::set<std::array<std::uint32_t, 3>> seen;
    return std::erase_if(mesh.triangle, [&](std::array<std::uint32_t, 3> t) {
        std::sort(t.begin(), t.end());
        return !seen.insert(t).second;
    });
}

std::size_t orient(TriangleMesh& mesh)
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> at_edge;
    const auto edge = [&](std::size_t t, std::size_t k) {
        const auto [low, high] = std::minmax(mesh.triangle[t][k], mesh.triangle[t][(k + 1) % 3]);
        return std::pair{low, high};
    };
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) at_edge[edge(t, k)].push_back(t);
    /// Whether the triangle passes the edge from its lower vertex to its higher one
    const auto rises = [&](std::size_t t, const std::pair<std::uint32_t, std::uint32_t>& e) {
        for (std::size_t k = 0; k < 3; ++k)
            if (edge(t, k) == e) return mesh.triangle[t][k] == e.first;
        return false;
    };
    std::size_t turned = 0;
    std::vector<char> is_done(mesh.triangle.size(), 0);
    std::vector<std::size_t> next;
    for (std::size_t first = 0; first < mesh.triangle.size(); ++first) {
        if (is_done[first] != 0) continue;
        is_done[first] = 1, next.assign(1, first);
        while (!next.empty()) {
            const std::size_t t = next.back();
            next.pop_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto e = edge(t, k);
                const std::vector<std::size_t>& both = at_edge[e];
                if (both.size() != 2) continue;
                const std::size_t other = both[0] == t ? both[1] : both[0];
                if (is_done[other] != 0) continue;
                if (rises(t, e) == rises(other, e))
                    std::swap(mesh.triangle[other][1], mesh.triangle[other][2]), ++turned;
                is_done[other] = 1, next.push_back(other);
            }
        }
    }
    return turned;
}

}  // namespace hilda::granular
