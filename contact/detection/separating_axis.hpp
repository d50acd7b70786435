// SPDX-License-Identifier: GPL-3.0-or-later
/// The axis that separates two polytopes most.
///
/// The cores of two bodies are apart by at least s(n) = min_b n·x_b - max_a n·x_a for each unit vector n. The
/// largest s of the face normals and of the cross products of two edges is the distance of the cores where
/// a face or two edges are nearest, and minus their depth where they overlap (Gottschalk, Lin, Manocha 1996).

#pragma once

#include "contact/surfaces/polytope.hpp"

#include <limits>

namespace hilda::contact {

/// The core of a polytope in the frame of the second body of a pair
struct PlacedCore {
    const Polytope& core;
    std::vector<Vec3>& vertex;
    Mat3 R = Mat3::Identity();

    /// At the frame itself. `memory` holds the vertices.
    PlacedCore(const Polytope& core, std::vector<Vec3>& memory) : core(core), vertex(memory)
    {
        vertex = core.vertex;
    }
    void place(const Mat3& rotation, const Vec3& origin)
    {
        R = rotation;
        for (std::size_t k = 0; k < vertex.size(); ++k) vertex[k] = R * core.vertex[k] + origin;
    }
    const Vec3& at(int k) const { return vertex[static_cast<std::size_t>(k)]; }
    Vec3 normal(int face) const { return R * core.face[static_cast<std::size_t>(face)].n; }
    Vec3 direction(const Polytope::Edge& e) const { return at(e.b) - at(e.a); }
    double most_along(const Vec3& n) const;  ///< largest n · x
};

struct SeparatingAxis {
    enum Kind { none, face_of_a, face_of_b, edges } kind = none;
    double separation = -std::numeric_limits<double>::infinity();  ///< [m], negative for an overlap
    Vec3 n = Vec3::Zero();                                         ///< from a to b
    int first = 0, second = 0;                                     ///< the face, or the two edges
};

/// The axis of largest separation. `none` for two bodies without faces and crossing edges. The search ends
/// with an axis of a face as soon as its separation exceeds `enough` [m]. A face of a is preferred to one of
/// b, and faces to edges, if they differ by less than `length` [m], so that the kind does not change with
/// rounding errors. `of_faces` is set to the best axis of a face.
SeparatingAxis separating_axis(const PlacedCore& a, const PlacedCore& b, double enough, double length,
                               SeparatingAxis& of_faces);

/// Numbers s and t of the points p + s u and q + t w of two lines that are closest to each other
struct ClosestOfLines {
    double s, t, det;  ///< det: |u × w|²
    ClosestOfLines(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& w);
};

}  // namespace hilda::contact
