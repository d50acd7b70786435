// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes of the unit sphere that converge under refinement, and their images.

#pragma once

#include "contact/mesh/triangle_mesh.hpp"

#include <map>
#include <numbers>
#include <utility>

namespace hilda::tests {

struct Triangles {
    std::vector<lie::Vec3> vertices;
    std::vector<contact::Triangle> triangles;
};

/// The unit sphere: an icosahedron refined `levels` times by splitting each triangle into four. The longest
/// edge is 1.05, 0.62, 0.32, 0.16, 0.083 for levels 0 to 4.
inline Triangles icosphere(int levels)
{
    Triangles mesh;
    constexpr double g = std::numbers::phi;
    for (const double s : {-1., 1.})
        for (const double t : {-g, g})
            for (int k = 0; k < 3; ++k) {
                lie::Vec3 v;
                v[k] = 0, v[(k + 1) % 3] = s, v[(k + 2) % 3] = t;
                mesh.vertices.push_back(v.normalized());
            }
    // the faces are the triples of vertices at the edge length
    const std::vector<lie::Vec3>& x = mesh.vertices;
    const auto near = [&](int a, int b) { return (x[a] - x[b]).norm() < 1.1; };
    for (int a = 0; a < 12; ++a)
        for (int b = a + 1; b < 12; ++b)
            for (int c = b + 1; c < 12; ++c)
                if (near(a, b) && near(b, c) && near(c, a)) {
                    const bool outward = x[a].dot(x[b].cross(x[c])) > 0;
                    mesh.triangles.push_back(outward ? contact::Triangle{a, b, c}
                                                     : contact::Triangle{a, c, b});
                }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(x.size()));
            if (added) mesh.vertices.push_back((x[a] + x[b]).normalized());
            return at->second;
        };
        std::vector<contact::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const contact::Triangle& t :
                 {contact::Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
                finer.push_back(t);
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

/// The mesh with the vertices f(v)
template <class F>
contact::TriangleMesh image(Triangles mesh, const F& f)
{
    for (lie::Vec3& v : mesh.vertices) v = f(v);
    return {std::move(mesh.vertices), std::move(mesh.triangles)};
}

}  // namespace hilda::tests
