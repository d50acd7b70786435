// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/clipping.hpp"
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hilda::contact {

namespace {

/// The contact points are the vertices of the polytope, each with its own gap
///
///     g = n · (v - o) - radius,   C_i = v - radius n
///
/// The feature is the number of the vertex. Of more than eight vertices within reach the deepest one and
/// those that are farthest in seven directions of the plane count, or they are merged, see
/// Manifold::mean_places.
class PolytopePlane final : public Detector {
public:
    PolytopePlane(const Shape& i, const Polytope& body, const Shape& j)
        : i(i), body(body), o_bar_j(j.position), n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Placed at(*this, bi, bj);
        return at.contact_point(at.vertex(body.farthest_vertex(-at.n_i)));
    }

    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        out.clear();
        const Placed at(*this, bi, bj);
        const auto vertices = static_cast<int>(body.vertex.size());
        const auto count_within = [&](double limit) {
            int within = 0;
            for (int k = 0; k < vertices; ++k) within += at.gap(k) < limit ? 1 : 0;
            return within;
        };
        int within = count_within(reach);
        if (out.mean_places && within > Manifold::most)
            reach = std::min(reach, 0.), within = count_within(reach);
        if (within <= Manifold::most) {
            for (int k = 0; k < vertices; ++k)
                if (at.gap(k) < reach) add(at, k, out);
            return;
        }
        const auto is_in = [&](int k) {
            return std::any_of(out.begin(), out.end(), [&](const ManifoldPoint& p) {
                return p.feature == static_cast<std::uint32_t>(k);
            });
        };
        const auto add_largest = [&](const auto& measure) {
            int best = -1;
            for (int k = 0; k < vertices; ++k)
                if (at.gap(k) < reach && !is_in(k) && (best < 0 || measure(k) > measure(best))) best = k;
            add(at, best, out);
        };
        // The deepest vertex changes with each small motion, and merged points would change with it.
        if (!out.mean_places) add_largest([&](int k) { return -at.gap(k); });
        const Vec3 x = at.n_i.unitOrthogonal(), y = at.n_i.cross(x);
        while (out.size() < Manifold::most) {
            constexpr double first = 0.1;  // [rad], so that regular polygons have no ties
            const double angle = first + 2 * std::numbers::pi * out.size() / Manifold::most;
            const Vec3 u = std::cos(angle) * x + std::sin(angle) * y;
            add_largest([&](int k) { return u.dot(at.vertex(k)); });
        }
        if (out.mean_places) merge(at, reach, out);
        out.sort();
    }

private:
    struct Placed {
        const Polytope& body;
        const PlacedShape shape;
        const Vec3 n, n_i;    ///< normal of the plane, global and in the frame of the polytope
        const double height;  ///< n · (o_i - o_j) - radius

        Placed(const PolytopePlane& of, const Motion& bi, const Motion& bj)
            : body(of.body), shape(of.i, bi), n(bj.A * of.n_bar_j), n_i(shape.axes.transpose() * n),
              height(n.dot(shape.origin - bj.r - bj.A * of.o_bar_j) - body.radius)
        {}
        const Vec3& vertex(int k) const { return body.vertex[static_cast<std::size_t>(k)]; }
        double gap(int k) const { return n_i.dot(vertex(k)) + height; }
        double share(int k) const { return body.share_of_vertex(k, -n_i); }
        ContactPoint contact_point(const Vec3& v) const
        {
            const Vec3 C_i = shape.origin + shape.axes * v - body.radius * n;
            const double g = n_i.dot(v) + height;
            const Mat3 K =
                body.radius > 0 ? Mat3((Mat3::Identity() - n * n.transpose()) / body.radius) : Mat3::Zero();
            return {.C_i = C_i, .C_j = C_i - g * n, .n = n, .gap = g, .K_i = K, .K_j = Mat3::Zero()};
        }
    };

    /// Merges each vertex with a gap below `reach` with the nearest one of `out`.
    void merge(const Placed& at, double reach, Manifold& out) const
    {
        std::array<MergedPoint, Manifold::most> merged;
        for (int k = 0; k < static_cast<int>(body.vertex.size()); ++k) {
            if (!(at.gap(k) < reach)) continue;
            const auto distance = [&](const ManifoldPoint& p) {
                return (body.vertex[p.feature] - at.vertex(k)).squaredNorm();
            };
            const ManifoldPoint* const nearest = std::min_element(
                out.begin(), out.end(),
                [&](const ManifoldPoint& p, const ManifoldPoint& q) { return distance(p) < distance(q); });
            merged[static_cast<std::size_t>(nearest - out.begin())].add(at.share(k), -at.gap(k),
                                                                        at.vertex(k));
        }
        for (ManifoldPoint& p : out) {
            const MergedPoint& of = merged[static_cast<std::size_t>(&p - out.begin())];
            p.at = at.contact_point(of.place(body.vertex[p.feature]));
            p.share = of.share();
        }
    }

    static void add(const Placed& at, int k, Manifold& out)
    {
        out.push_back({.at = at.contact_point(at.vertex(k)),
                       .feature = static_cast<std::uint32_t>(k),
                       .share = at.share(k)});
    }

    const Shape i;
    const Polytope& body;  ///< of `i`
    const Vec3 o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> polytope_plane(const Shape& i, const Shape& j)
{
    const auto* body = surface_as<Polytope>(i);
    if (body == nullptr || surface_as<Plane>(j) == nullptr) return nullptr;
    return std::make_unique<PolytopePlane>(i, *body, j);
}

}  // namespace hilda::contact
