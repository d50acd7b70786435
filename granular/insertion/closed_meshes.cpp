// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/insertion/closed_meshes.hpp"

#include "granular/core/surfaces/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

ClosedMeshes::ClosedMeshes(const World& world)
{
    const Meshes& all = world.all_meshes();
    std::vector<char> is_open(world.all_boundaries().size(), 0);
    for (const MeshTriangle& t : all.triangle)
        if ((t.flags & MeshTriangle::two_sided) != 0 ||
            std::any_of(std::begin(t.across), std::end(t.across),
                        [](std::uint32_t other) { return other == no_triangle; }))
            is_open[t.boundary] = 1;
    for (std::size_t first = 0, last = 0; first < all.triangle.size(); first = last) {
        const std::uint32_t number = all.triangle[first].boundary;
        while (last < all.triangle.size() && all.triangle[last].boundary == number) ++last;
        if (is_open[number] != 0) continue;
        Mesh mesh;
        mesh.boundary = &world.all_boundaries()[number];
        double volume = 0;  // six times that of the solid
        const Vec3 apex = all.vertex[all.triangle[first].vertex[0]];
        for (std::size_t t = first; t < last; ++t) {
            const auto& v = all.triangle[t].vertex;
            mesh.triangles.push_back({all.vertex[v[0]], all.vertex[v[1]], all.vertex[v[2]]});
            const Triangle& now = mesh.triangles.back();
            volume += (now.a - apex).dot((now.b - apex).cross(now.c - apex));
        }
        mesh.is_container = volume < 0;
        mesh.make_grid();
        meshes.push_back(std::move(mesh));
    }
}

void ClosedMeshes::Mesh::make_grid()
{
    BoundingBox box;
    for (const Triangle& t : triangles) box.add(t.a), box.add(t.b), box.add(t.c);
    cells = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(triangles.size()))), 1, 1024);
    low_y = box.low.y, low_z = box.low.z;
    width_y = (box.high.y - box.low.y) / cells, width_z = (box.high.z - box.low.z) / cells;
    in_cell.resize(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    const auto index = [&](double x, double low, double width) {
        return std::clamp(static_cast<int>((x - low) / width), 0, cells - 1);
    };
    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
        BoundingBox one;
        one.add(triangles[k].a), one.add(triangles[k].b), one.add(triangles[k].c);
        for (int y = index(one.low.y, low_y, width_y); y <= index(one.high.y, low_y, width_y); ++y)
            for (int z = index(one.low.z, low_z, width_z); z <= index(one.high.z, low_z, width_z); ++z)
                in_cell[static_cast<std::size_t>(y) * static_cast<std::size_t>(cells) +
                        static_cast<std::size_t>(z)]
                    .push_back(k);
    }
}

/// Number of times that the surface encloses the point: crossings of a ray along +x, with the sign of the
/// normal. A ray through an edge would count two triangles or none: it is displaced by a part of 1e-9 of a
/// cell, which has no symmetry of meshes.
int ClosedMeshes::Mesh::winding(const Vec3& point) const
{
    const double y = point.y + 0.7390851332e-9 * width_y, z = point.z + 0.5671432904e-9 * width_z;
    const double row = (y - low_y) / width_y, column = (z - low_z) / width_z;
    if (!(row >= 0 && row < cells && column >= 0 && column < cells)) return 0;
    int sum = 0;
    for (const std::uint32_t k : in_cell[static_cast<std::size_t>(row) * static_cast<std::size_t>(cells) +
                                         static_cast<std::size_t>(column)]) {
        const Triangle& t = triangles[k];
        const auto side = [&](const Vec3& p, const Vec3& q) {
            return (q.y - p.y) * (z - p.z) - (q.z - p.z) * (y - p.y);
        };
        const double a = side(t.b, t.c), b = side(t.c, t.a), c = side(t.a, t.b), area = a + b + c;
        const bool passes = (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
        if (passes && (a * t.a.x + b * t.b.x + c * t.c.x) / area > point.x) sum += area > 0 ? 1 : -1;
    }
    return sum;
}

bool ClosedMeshes::allow(const Vec3& point) const
{
    return std::all_of(meshes.begin(), meshes.end(), [&](const Mesh& m) {
        const bool is_inside = m.winding(rotated_back(m.boundary->p, point - m.boundary->r)) != 0;
        return is_inside == m.is_container;
    });
}

}  // namespace hilda::granular
