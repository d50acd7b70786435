// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/separating_axis.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double parallel = 1e-9;  // sine of the angle of two edges

/// Whether the arc between the normals of the faces at an edge of a crosses that of an edge of b, mirrored:
/// the two edges span a face of the Minkowski difference (Gregorius 2013).
bool spans_face(const Vec3& a_1, const Vec3& a_2, const Vec3& b_1, const Vec3& b_2)
{
    const Vec3 a = a_2.cross(a_1), b = b_2.cross(b_1);
    const double b_1a = b_1.dot(a), b_2a = b_2.dot(a), a_1b = a_1.dot(b), a_2b = a_2.dot(b);
    return b_1a * b_2a < 0 && a_1b * a_2b < 0 && b_1a * a_2b > 0;
}

/// Whether the edge belongs to two faces that are not opposite
bool is_of_solid(const Polytope& core) { return core.face.size() > 2; }

}  // namespace

double PlacedCore::most_along(const Vec3& n) const
{
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : vertex) most = std::max(most, n.dot(v));
    return most;
}

ClosestOfLines::ClosestOfLines(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& w)
{
    const Vec3 r = p - q;
    const double uu = u.dot(u), uw = u.dot(w), ww = w.dot(w), ur = u.dot(r), wr = w.dot(r);
    det = uu * ww - uw * uw;
    s = (uw * wr - ww * ur) / det;
    t = (uu * wr - uw * ur) / det;
}

SeparatingAxis separating_axis(const PlacedCore& a, const PlacedCore& b, double enough, double length,
                               SeparatingAxis& of_faces)
{
    SeparatingAxis axis;
    const auto take = [&](SeparatingAxis::Kind kind, double separation, const Vec3& n, std::size_t first,
                          std::size_t second, double margin) {
        if (separation > axis.separation + margin)
            axis = {kind, separation, n, static_cast<int>(first), static_cast<int>(second)};
        return axis.separation > enough;
    };
    for (std::size_t k = 0; k < a.core.face.size(); ++k) {
        const Vec3 n = a.normal(static_cast<int>(k));
        if (take(SeparatingAxis::face_of_a, -b.most_along(-n) - n.dot(a.at(a.core.face[k].vertex[0])), n, k,
                 0, 0))
            return axis;
    }
    for (std::size_t k = 0; k < b.core.face.size(); ++k) {
        const Polytope::Face& f = b.core.face[k];
        if (take(SeparatingAxis::face_of_b, -a.most_along(-f.n) - f.d, -f.n, k, 0, length)) return axis;
    }
    of_faces = axis;
    const bool both = is_of_solid(a.core) && is_of_solid(b.core);
    const auto normal_of_b = [&](int face) { return Vec3(-b.core.face[static_cast<std::size_t>(face)].n); };
    for (std::size_t k = 0; k < a.core.edge.size(); ++k) {
        const Polytope::Edge& e = a.core.edge[k];
        const Vec3 u = a.direction(e), a_1 = both ? a.normal(e.face[0]) : Vec3::Zero(),
                   a_2 = both ? a.normal(e.face[1]) : Vec3::Zero();
        for (std::size_t l = 0; l < b.core.edge.size(); ++l) {
            const Polytope::Edge& g = b.core.edge[l];
            if (both && !spans_face(a_1, a_2, normal_of_b(g.face[0]), normal_of_b(g.face[1]))) continue;
            const Vec3 w = b.direction(g), cross = u.cross(w);
            const double size = cross.norm();
            if (size <= parallel * u.norm() * w.norm()) continue;
            const Vec3 n = cross / size;
            if (both) {
                const Vec3 outward = n.dot(a_1 + a_2) < 0 ? Vec3(-n) : n;
                take(SeparatingAxis::edges, outward.dot(b.at(g.a) - a.at(e.a)), outward, k, l, length);
                continue;
            }
            // edges of plates and segments: they span a face if all vertices are on their sides
            for (const Vec3& side : {n, Vec3(-n)})
                if (a.most_along(side) <= side.dot(a.at(e.a)) + length &&
                    -b.most_along(-side) >= side.dot(b.at(g.a)) - length)
                    take(SeparatingAxis::edges, side.dot(b.at(g.a) - a.at(e.a)), side, k, l, length);
        }
    }
    return axis;
}

}  // namespace hilda::contact
