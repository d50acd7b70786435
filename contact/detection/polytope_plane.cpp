// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/clipping.hpp"
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"

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
        if (count_within(reach) <= Manifold::most) {
            for (int k = 0; k < vertices; ++k)
                if (at.gap(k) < reach) add(at, at.vertex(k), k, at.share(k), out);
            return;
        }
        static thread_local ContactCorners list;
        list.corner.clear();
        for (int k = 0; k < vertices; ++k)
            if (at.gap(k) < reach) list.corner.push_back({at.vertex(k), 0, k, 0, at.share(k)});
        const Vec3 p = -at.height * at.n_i;  // a point of the plane, moved by the radius
        if (out.mean_places) list.merge(at.n_i, p, 0, Manifold::most);
        list.keep(at.n_i, p, reach, Manifold::most);
        for (const ContactCorners::Corner& c : list.corner) add(at, c.x, c.vertex, c.share, out);
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

    static void add(const Placed& at, const Vec3& v, int k, double share, Manifold& out)
    {
        out.push_back({.at = at.contact_point(v), .feature = static_cast<std::uint32_t>(k), .share = share});
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
