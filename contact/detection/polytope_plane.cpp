// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::contact {

namespace {

/// The contact points are the vertices of the polytope, each with its own gap
///
///     g = n · (v - o) - radius,   C_i = v - radius n
///
/// The feature is the number of the vertex. Of more than eight vertices within reach the deepest one and
/// those that are farthest in seven directions of the plane count.
class PolytopePlane final : public Detector {
public:
    PolytopePlane(const Shape& i, const Polytope& body, const Shape& j)
        : i(i), body(body), o_bar_j(j.position), n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Placed at(*this, bi, bj);
        return at.contact_point(body.farthest_vertex(-at.n_i));
    }

    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        out.clear();
        const Placed at(*this, bi, bj);
        const auto vertices = static_cast<int>(body.vertex.size());
        int within = 0;
        for (int k = 0; k < vertices; ++k) within += at.gap(k) < reach ? 1 : 0;
        if (within <= Manifold::most) {
            for (int k = 0; k < vertices; ++k)
                if (at.gap(k) < reach) add(at, k, out);
            return;
        }
        const auto add_largest = [&](const auto& measure) {
            int best = -1;
            for (int k = 0; k < vertices; ++k) {
                const auto is_k = [&](const ManifoldPoint& p) {
                    return p.feature == static_cast<std::uint32_t>(k);
                };
                if (at.gap(k) < reach && std::none_of(out.begin(), out.end(), is_k) &&
                    (best < 0 || measure(k) > measure(best)))
                    best = k;
            }
            add(at, best, out);
        };
        add_largest([&](int k) { return -at.gap(k); });
        const Vec3 x = at.n_i.unitOrthogonal(), y = at.n_i.cross(x);
        for (int d = 1; d < Manifold::most; ++d) {
            const double angle = 2 * std::numbers::pi * d / (Manifold::most - 1);
            const Vec3 u = std::cos(angle) * x + std::sin(angle) * y;
            add_largest([&](int k) { return u.dot(body.vertex[static_cast<std::size_t>(k)]); });
        }
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
        double gap(int k) const { return n_i.dot(body.vertex[static_cast<std::size_t>(k)]) + height; }
        ContactPoint contact_point(int k) const
        {
            const Vec3 C_i =
                shape.origin + shape.axes * body.vertex[static_cast<std::size_t>(k)] - body.radius * n;
            const double g = gap(k);
            const Mat3 K =
                body.radius > 0 ? Mat3((Mat3::Identity() - n * n.transpose()) / body.radius) : Mat3::Zero();
            return {.C_i = C_i, .C_j = C_i - g * n, .n = n, .gap = g, .K_i = K, .K_j = Mat3::Zero()};
        }
    };

    static void add(const Placed& at, int k, Manifold& out)
    {
        out.push_back({.at = at.contact_point(k), .feature = static_cast<std::uint32_t>(k)});
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
