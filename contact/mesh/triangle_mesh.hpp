// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangles that enclose a body, and the one of them that is nearest to a point.

#pragma once

#include "lie/so3.hpp"

#include <array>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// The numbers of three vertices, from 0, counterclockwise as seen from outside
using Triangle = std::array<int, 3>;

/// A closed surface of triangles, each edge of two of them. Vertices that no triangle has are allowed. That the
/// surface does not pass through itself is not tested.
class TriangleMesh {
public:
    /// InvalidInput for what fault() says.
    TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

    struct Fault {
        bool of_vertices;  ///< or of the triangles
        std::string what;
    };
    /// What keeps vertices and triangles from being a closed surface with an inside, if anything does: a number that is
    /// not finite, a vertex that is not there, a triangle without area, an open edge, two triangles of which one
    /// is inside out, an edge or a vertex in which sheets meet, a mesh that is inside out as a whole.
    static std::optional<Fault> fault(const std::vector<Vec3>& vertices,
                                      const std::vector<Triangle>& triangles);

    /// The point of the mesh nearest to a: on the feature of the triangle, 0 its face, 1, 2, 3 the edge from its
    /// vertex 0, 1, 2 on, 4, 5, 6 the vertex 0, 1, 2
    struct Nearest {
        int triangle, feature;
        Vec3 point;
        double distance;
    };
    /// In time that grows with the logarithm of the number of triangles; a must be finite
    Nearest nearest(const Vec3& a) const;
    /// That of a to one triangle
    double distance(int triangle, const Vec3& a) const;
    /// The normal, out of the body, of the face, edge or vertex: the mean over the triangles there, by their angles.
    /// A point is outside where it lies on that side of its nearest one (Bærentzen and Aanæs, 2005).
    Vec3 normal(int triangle, int feature) const;

    const std::vector<Vec3> vertices;
    const std::vector<Triangle> triangles;
    std::vector<std::vector<int>> around;  ///< the triangles at each vertex
    std::vector<Vec3> face_normal;         ///< unit, of each triangle
    std::vector<Vec3> vertex_normal;       ///< unit, of each vertex; zero where it has no triangle

private:
    /// Of a tree of boxes: a leaf holds triangles, another has one child behind it and one at `right`
    struct Node {
        Vec3 lower, upper;
        int first, count;  // in `order`; count = 0 is no leaf
        int right;
    };
    int build(int first, int last);

    std::vector<std::array<int, 3>> across;  // the triangle at the other side of each edge
    std::vector<Node> nodes;
    std::vector<int> order;
};

/// Reads the lines v and f of a Wavefront OBJ text; a polygon becomes a fan of triangles. `name` is that of the file
/// in messages. InvalidInput with the line where it is not what it should be.
TriangleMesh read_obj(std::istream& text, const std::string& name);

}  // namespace hilda::contact
