// SPDX-License-Identifier: GPL-3.0-or-later
/// Closed triangle meshes: validation and closest-point queries.

#pragma once

#include "lie/so3.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// Three vertex numbers, from 0, counterclockwise as seen from outside
using Triangle = std::array<int, 3>;

/// A closed, oriented triangle mesh in which each edge belongs to two triangles. Unused vertices are allowed.
/// Self-intersections are not detected.
class TriangleMesh {
public:
    /// vertices [m]. InvalidInput if fault() finds one.
    TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

    struct Fault {
        bool of_vertices;  ///< true: in the vertices; false: in the triangles
        std::string what;
        int number = -1;  ///< of the vertex or triangle; -1: not of a single one
    };
    /// The first reason why vertices and triangles are not a closed oriented surface, or nothing: a
    /// coordinate that is not finite, a vertex number out of range, a triangle of zero area, an open edge,
    /// adjacent triangles of opposite orientation, a non-manifold edge or vertex, or a mesh with all
    /// triangles oriented inward.
    static std::optional<Fault> fault(const std::vector<Vec3>& vertices,
                                      const std::vector<Triangle>& triangles);

    /// The point of the mesh closest to a query point. `feature` is the part of the triangle on which it
    /// lies: 0 the face, 1, 2, 3 the edge that starts at corner 0, 1, 2; 4, 5, 6 corner 0, 1, 2.
    struct Nearest {
        int triangle, feature;
        Vec3 point;
        double distance;
    };
    /// The closest point to a, which must be finite. O(log n) for n triangles (tree of bounding boxes).
    Nearest nearest(const Vec3& a) const;
    /// Distance from a to one triangle [m]
    double distance(int triangle, const Vec3& a) const;
    /// Outward pseudonormal of a face, edge or vertex: the mean of the adjacent face normals, weighted by
    /// their angles. A point is outside if it lies on the outer side of its closest point with respect to
    /// this normal (Bærentzen and Aanæs, 2005).
    Vec3 normal(int triangle, int feature) const;

    const std::vector<Vec3> vertices;
    const std::vector<Triangle> triangles;
    std::vector<std::vector<int>> around;  ///< the triangles at each vertex
    std::vector<Vec3> face_normal;         ///< unit normal of each triangle
    std::vector<Vec3> vertex_normal;       ///< unit pseudonormal of each vertex; zero for an unused vertex

private:
    /// Node of the bounding-box tree. A leaf has triangles; an inner node has its left child next to it and
    /// its right child at `right`.
    struct Node {
        Vec3 lower, upper;
        int first, count;  // triangles in `order`; count = 0 for an inner node
        int right;
    };
    int build(int first, int last);

    std::vector<std::array<int, 3>> across;  // the adjacent triangle at each edge
    std::vector<Node> nodes;
    std::vector<int> order;
};

}  // namespace hilda::contact
