// SPDX-License-Identifier: GPL-3.0-or-later
/// The contact point of a polytope and a smooth convex body with a support function.
///
/// With the support point x(n) of the smooth body along -n, and the core of the polytope with its vertices v,
///
///     s(n) = n · x(n) - max_v n · v
///
/// is the separation along the unit vector n, from the polytope to the body. Its maximum is the distance of
/// core and body if they are apart, and minus their depth if they overlap (as in separating_axis.hpp). A
/// maximum is
///
/// - the normal of a face, if x(n) lies over the face;
/// - a normal on the arc between the faces of an edge with ds/dφ = 0, if x(n) lies beside the edge;
/// - the normal of the smooth body at its point closest to a vertex, if it is in the normal cone of the
///   vertex.
///
/// If the bodies are apart, there is one of them. If they overlap, the one with the largest s counts.
#include "contact/detection/detectors.hpp"
#include "contact/detection/normal_arc.hpp"
#include "contact/surfaces/polytope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace hilda::contact {

namespace {

/// An axis n, and what touches if it is the normal of the contact
struct Axis {
    double s = -std::numeric_limits<double>::infinity();
    Vec3 n = Vec3::Zero(), x_core = Vec3::Zero();
    Mat3 across = Mat3::Zero();  ///< projector on the tangents along which the normal of a rounded core turns
};

/// A search in the frame of the smooth body
class SmoothSearch {
public:
    SmoothSearch(const Polytope& core, const PlacedShape& at_core, const Surface& body, const Vec3& centre,
                 const PlacedShape& at_body, double length)
        : core(core), body(body), centre(centre), length(length), R(at_body.axes.transpose() * at_core.axes),
          origin(at_body.axes.transpose() * (at_core.origin - at_body.origin))
    {
        vertices().resize(core.vertex.size());
        for (std::size_t k = 0; k < core.vertex.size(); ++k) vertices()[k] = R * core.vertex[k] + origin;
    }

    /// Searches the maximum of s. Returns false, and may end early, if it is above `enough` [m].
    bool run(double enough)
    {
        search_faces();
        if (of_all.s > enough) return false;
        for (std::size_t k = 0; k < core.edge.size() && !is_found(); ++k) search_edge(core.edge[k]);
        if (of_all.s > enough) return false;
        for (std::size_t k = 0; k < core.vertex.size() && !is_found(); ++k)
            search_vertex(static_cast<int>(k));
        if (!std::isfinite(best.s)) take_uncertain();
        return best.s <= enough;
    }

    Axis best;  ///< the maximum with the largest s

private:
    /// Each thread has one list of the vertices in the frame of the smooth body.
    static std::vector<Vec3>& vertices()
    {
        static thread_local std::vector<Vec3> list;
        return list;
    }
    static const Vec3& at(int k) { return vertices()[static_cast<std::size_t>(k)]; }
    Vec3 normal(int face) const { return R * core.face[static_cast<std::size_t>(face)].n; }
    Vec3 nearest_along(const Vec3& n) const { return *body.support(-n); }
    /// A maximum that is not negative is the only one.
    bool is_found() const { return best.s >= -length; }

    void take(bool is_maximum, const Axis& axis)
    {
        if (axis.s > of_all.s) of_all = axis;
        if (is_maximum && axis.s > best.s) best = axis;
    }

    void search_faces()
    {
        for (const Polytope::Face& face : core.face) {
            const Vec3 n = R * face.n, x = nearest_along(n);
            const double s = n.dot(x - at(face.vertex[0]));
            bool is_over = true;
            for (std::size_t k = 0; k < face.vertex.size() && is_over; ++k) {
                const Vec3 &p = at(face.vertex[k]), &q = at(face.vertex[(k + 1) % face.vertex.size()]);
                is_over = (q - p).cross(n).normalized().dot(x - p) <= length;
            }
            take(is_over, {s, n, x - s * n});
        }
    }

    /// The arc of normals begins at the face to the left of the edge. For a segment it is half of the circle
    /// of normals, about the direction to the smooth body.
    void search_edge(const Polytope::Edge& edge)
    {
        const Vec3& a = at(edge.a);
        const double L = (at(edge.b) - a).norm();
        const Vec3 u = (at(edge.b) - a) / L;
        Vec3 n, m;
        double end = std::numbers::pi;
        if (edge.face[0] >= 0) {
            n = normal(edge.face[0]);
            m = u.cross(n);
            const Vec3 last = normal(edge.face[1]);
            if (core.face.size() > 2) end = std::atan2(m.dot(last), n.dot(last));
        } else {
            m = (centre - a) - u * u.dot(centre - a);
            m = m.norm() > length ? m.normalized() : u.unitOrthogonal();
            n = m.cross(u);
        }
        NormalArc arc(body, a, n, m, end, length);
        if (!arc.find(of_all.s)) return;
        const double along = u.dot(arc.x - a);
        take(along >= -length && along <= L + length,
             {arc.s(), arc.direction, a + std::clamp(along, 0., L) * u,
              Mat3::Identity() - arc.direction * arc.direction.transpose() - u * u.transpose()});
    }

    void search_vertex(int k)
    {
        const Vec3& v = at(k);
        Vec3 n;
        try {
            n = -body.normal(body.project(v));
        } catch (const lie::NumericalFailure&) {
            return;
        }
        const bool is_in_cone =
            std::none_of(core.edge.begin(), core.edge.end(), [&](const Polytope::Edge& e) {
                if (e.a != k && e.b != k) return false;
                const Vec3 along = at(e.a == k ? e.b : e.a) - v;
                return n.dot(along) > of_cone * along.norm();
            });
        if (is_in_cone) take(true, {n.dot(nearest_along(n) - v), n, v, Mat3::Identity() - n * n.transpose()});
    }

    /// The axis with the largest s if no maximum was found: the conditions of all failed by rounding errors,
    /// a projection did not converge, or the bodies overlap deeply. For bodies that are apart the distance of
    /// two points is an upper bound of that of the bodies, and s a lower one.
    void take_uncertain()
    {
        if (of_all.s > 0) {
            const Vec3 x = nearest_along(of_all.n);
            of_all.x_core = R * core.closest_of_core(R.transpose() * (x - origin)) + origin;
            if (!((x - of_all.x_core).norm() - of_all.s <= uncertain * body.size()))
                throw lie::NumericalFailure(
                    "contact_not_converged",
                    "the closest points of " + core.name() + " and " + body.name() + " were not found");
        }
        best = of_all;
    }

    static constexpr double of_cone = 1e-10, uncertain = 1e-6;

    const Polytope& core;
    const Surface& body;
    const Vec3& centre;
    const double length;  ///< below it a length is zero [m]
    const Mat3 R;         ///< pose of the polytope in the frame of the body
    const Vec3 origin;
    Axis of_all;  ///< the axis with the largest s
};

class PolytopeSmooth final : public Detector {
public:
    PolytopeSmooth(const Shape& i, const Polytope& core, const Shape& j)
        : i(i), j(j), core(core), body(*j.surface), length(negligible * std::min(core.size(), body.size())),
          bounding_radii(core.bounding_radius() + body.bounding_radius())
    {
        for (int k = 0; k < 3; ++k)
            centre += (*body.support(Vec3::Unit(k)) + *body.support(-Vec3::Unit(k))) / 6;
    }

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        Manifold found;
        detect_all(bi, bj, std::numeric_limits<double>::infinity(), found);
        return found[0].at;
    }

    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        out.clear();
        const PlacedShape at_i(i, bi), at_j(j, bj);
        const double far = reach + bounding_radii;
        if ((at_i.origin - at_j.origin).squaredNorm() > far * far) return;
        SmoothSearch search(core, at_i, body, centre, at_j, length);
        if (!search.run(reach + core.radius)) return;
        const Axis& axis = search.best;
        const auto global = [&](const Vec3& x) -> Vec3 { return at_j.origin + at_j.axes * x; };
        ManifoldPoint p;
        p.at.n = -(at_j.axes * axis.n);
        p.at.gap = axis.s - core.radius;
        if (!(p.at.gap < reach)) return;
        p.at.C_i = global(axis.x_core + core.radius * axis.n);
        p.at.C_j = global(axis.x_core + axis.s * axis.n);
        p.at.K_i = Mat3::Zero();
        if (core.radius > 0) p.at.K_i = at_j.axes * (axis.across / core.radius) * at_j.axes.transpose();
        p.at.K_j = at_j.axes * body.shape_operator(axis.x_core + axis.s * axis.n) * at_j.axes.transpose();
        out.push_back(p);
    }

private:
    static constexpr double negligible = 1e-10;  // lengths below this fraction of the smaller size are zero

    const Shape i, j;
    const Polytope& core;  ///< of `i`
    const Surface& body;   ///< of `j`
    const double length, bounding_radii;
    Vec3 centre = Vec3::Zero();  ///< a point inside of the body, in its frame
};

}  // namespace

std::unique_ptr<Detector> polytope_smooth(const Shape& i, const Shape& j)
{
    const auto* core = surface_as<Polytope>(i);
    if (core == nullptr || !is_smooth_convex_body(*j.surface)) return nullptr;
    return std::make_unique<PolytopeSmooth>(i, *core, j);
}

bool is_smooth_convex_body(const Surface& s)
{
    return s.is_smooth() && s.convex() && s.sigma() > 0 && std::isfinite(s.bounding_radius());
}

}  // namespace hilda::contact
