// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact points of two polytopes by separating axes and clipping.
///
/// - Axis of a face: the face of the other body that is most opposite is clipped by the sides of the first
///   one. The contact points are the corners of what remains.
/// - Axis of two edges: the points of the two edges that are closest to each other, and the corners that lie
///   over the best face: an edge that lies in a face touches at both ends.
/// - Bodies whose nearest parts are others, such as two vertices: the closest points of the cores, of each
///   vertex and of each two edges within reach.
///
/// Shares: the corners of a clipped face have those of its area. The points of two edges, and a corner below
/// the clipped face, have the mean share of the vertices that they belong to, as a corner that becomes such a
/// point. Corners of a face keep their shares beside it only if the normals are close to each other.
/// Closest points have equal shares, which fade to zero over `faded` for a larger gap than the smallest one.
#include "contact/detection/clipping.hpp"
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double negligible = 1e-9;  // lengths below this fraction of the smaller size are zero
constexpr double faded = 0.1;        // relative to the smaller size
constexpr double rest = -1;          // share of a point that set_rest() sets

/// Memory of a search
struct Scratch {
    struct ClosestPair {
        Vec3 a, b;
        TouchingParts parts;
    };

    std::vector<Vec3> vertex_a, vertex_b;
    ClippedFace clipped;
    std::vector<ClosestPair> closest;
};

/// A search in the frame of body b. The contact points of `out` are those of bodies i and j, of which a is
/// one.
class Search {
public:
    Search(const Polytope& a, const PlacedShape& at_a, const Polytope& b, const PlacedShape& at_b,
           bool a_is_j, double length, double reach, Scratch& memory, Manifold& out)
        : length(length), memory(memory), A(a, memory.vertex_a), B(b, memory.vertex_b), at_b(at_b),
          a_is_j(a_is_j), radii(a.radius + b.radius), reach(reach), out(out)
    {
        A.place(at_b.axes.transpose() * at_a.axes, at_b.axes.transpose() * (at_a.origin - at_b.origin));
    }

    void run()
    {
        SeparatingAxis of_faces;
        const SeparatingAxis axis = separating_axis(A, B, reach + radii, length, of_faces);
        if (axis.separation > reach + radii) return;
        if (axis.kind == SeparatingAxis::edges) add_edges(axis);
        // Heights below the separation of the edges belong to a face that is not where the bodies overlap.
        if (of_faces.kind != SeparatingAxis::none) add_face(of_faces, axis.separation - length);
        double nearest = std::numeric_limits<double>::infinity();
        for (const ManifoldPoint& p : out) nearest = std::min(nearest, p.at.gap + radii);
        if (is_merged || nearest <= axis.separation + length) {
            set_rest();
        } else if (axis.kind == SeparatingAxis::none || axis.separation >= -length) {
            add_closest();
            set_faded_shares();
        } else {
            add_deepest(of_faces);
            set_rest();
        }
    }

private:
    void add_face(const SeparatingAxis& axis, double lowest)
    {
        const bool of_a = axis.kind == SeparatingAxis::face_of_a;
        const PlacedCore &reference = of_a ? A : B, &incident = of_a ? B : A;
        const Vec3 n = of_a ? axis.n : Vec3(-axis.n);
        const Polytope::Face& face = reference.core.face[static_cast<std::size_t>(axis.first)];
        const Vec3& p = reference.at(face.vertex[0]);
        memory.clipped.set(reference, axis.first, n, incident, length);
        if (out.mean_places) is_merged = memory.clipped.merge(n, p, radii, Manifold::most);
        memory.clipped.keep(n, p, reach + radii, Manifold::most);
        for (const ClippedFace::Corner& c : memory.clipped.corner) {
            const double height = n.dot(c.x - p);
            if (height >= lowest) add_over_face(of_a, c.x, n, height, memory.clipped.parts(c, face), c.share);
        }
    }

    void add_over_face(bool of_a, const Vec3& x, const Vec3& n, double height, const TouchingParts& parts,
                       double share)
    {
        const Vec3 below = x - height * n;
        if (of_a)
            add(below, x, n, height, parts, share);
        else
            add(x, below, -n, height, parts.exchanged(), share);
    }

    /// Sets the share of the point of two edges, or of the deepest corner. Corners over a face with another
    /// normal than that of this point lose theirs, and the point has none beside a corner as deep as it is.
    void set_rest()
    {
        const auto is_single = [](const ManifoldPoint& p) { return p.share == rest; };
        const ManifoldPoint* const single = std::find_if(out.begin(), out.end(), is_single);
        if (single == out.end()) return;
        double left = share_of_rest;
        for (ManifoldPoint& p : out)
            if (!is_single(p)) {
                p.share *= ramp(p.at.n.dot(single->at.n), 0.9, 0.98);
                if (p.at.gap < 0 && single->at.gap < 0)
                    left -= p.share * ramp(p.at.gap / single->at.gap, 0.9, 1);
            }
        const auto count = static_cast<double>(std::count_if(out.begin(), out.end(), is_single));
        for (ManifoldPoint& p : out)
            if (is_single(p)) p.share = std::max(0., left) / count;
    }
    /// 0 below `low`, 1 above `high`, linear between them
    static double ramp(double x, double low, double high)
    {
        return std::clamp((x - low) / (high - low), 0., 1.);
    }

    void set_faded_shares()
    {
        double nearest = std::numeric_limits<double>::infinity(), sum = 0;
        for (const ManifoldPoint& p : out) nearest = std::min(nearest, p.at.gap);
        const double over = faded / negligible * length;
        for (ManifoldPoint& p : out) sum += p.share = std::max(0., 1 - (p.at.gap - nearest) / over);
        for (ManifoldPoint& p : out) p.share /= sum;
    }

    /// The vertex of the other body that is deepest behind the face of the axis
    void add_deepest(const SeparatingAxis& axis)
    {
        const bool of_a = axis.kind == SeparatingAxis::face_of_a;
        const PlacedCore& incident = of_a ? B : A;
        const Vec3 n = of_a ? axis.n : Vec3(-axis.n);
        const int deepest = incident.core.farthest_vertex(-(incident.R.transpose() * n));
        add_over_face(of_a, incident.at(deepest), n, axis.separation,
                      {TouchingParts::any, static_cast<std::uint32_t>(deepest)}, rest);
        share_of_rest = incident.core.share_of_vertex(deepest, -(incident.R.transpose() * n));
    }

    /// The points of the two edges of the axis that are closest to each other
    void add_edges(const SeparatingAxis& axis)
    {
        const Polytope::Edge &e = A.core.edge[static_cast<std::size_t>(axis.first)],
                             &g = B.core.edge[static_cast<std::size_t>(axis.second)];
        const Vec3 u = A.direction(e), w = B.direction(g);
        const ClosestOfLines c(A.at(e.a), u, B.at(g.a), w);
        const bool on_both = c.s >= 0 && c.s <= 1 && c.t >= 0 && c.t <= 1;
        if (!on_both && axis.separation > 0) return;  // other parts are closer
        add(A.at(e.a) + std::clamp(c.s, 0., 1.) * u, B.at(g.a) + std::clamp(c.t, 0., 1.) * w, axis.n,
            axis.separation, TouchingParts::edges(axis.first, axis.second), rest);
        const Vec3 n_a = A.R.transpose() * axis.n, n_b = -(B.R.transpose() * axis.n);
        share_of_rest = (A.core.share_of_vertex(e.a, n_a) + A.core.share_of_vertex(e.b, n_a) +
                         B.core.share_of_vertex(g.a, n_b) + B.core.share_of_vertex(g.b, n_b)) /
                        4;
    }

    /// The closest points of two cores that are apart: of each vertex and the other body, and of each two
    /// edges, within reach; the nearest ones first
    void add_closest()
    {
        memory.closest.clear();
        const auto number = [](std::size_t k) { return static_cast<std::uint32_t>(k); };
        for (std::size_t k = 0; k < A.vertex.size(); ++k)
            memory.closest.push_back(
                {A.vertex[k], B.core.closest_of_core(A.vertex[k]), {number(k), TouchingParts::any}});
        const Vec3 origin = A.vertex[0] - A.R * A.core.vertex[0];
        for (std::size_t k = 0; k < B.vertex.size(); ++k) {
            const Vec3 x = A.core.closest_of_core(A.R.transpose() * (B.vertex[k] - origin));
            memory.closest.push_back({A.R * x + origin, B.vertex[k], {TouchingParts::any, number(k)}});
        }
        for (std::size_t k = 0; k < A.core.edge.size(); ++k)
            for (std::size_t l = 0; l < B.core.edge.size(); ++l) {
                const Vec3 p = A.at(A.core.edge[k].a), u = A.direction(A.core.edge[k]),
                           q = B.at(B.core.edge[l].a), w = B.direction(B.core.edge[l]);
                const ClosestOfLines c(p, u, q, w);
                if (c.det <= negligible * u.squaredNorm() * w.squaredNorm() || c.s <= 0 || c.s >= 1 ||
                    c.t <= 0 || c.t >= 1)
                    continue;
                memory.closest.push_back({p + c.s * u, q + c.t * w,
                                          TouchingParts::edges(static_cast<int>(k), static_cast<int>(l))});
            }
        const auto distance = [](const auto& c) { return (c.b - c.a).norm(); };
        std::erase_if(memory.closest, [&](const auto& c) { return !(distance(c) < reach + radii); });
        std::sort(memory.closest.begin(), memory.closest.end(),
                  [&](const auto& c, const auto& d) { return distance(c) < distance(d); });
        for (auto c = memory.closest.begin(); c != memory.closest.end(); ++c) {
            const bool is_known = std::any_of(memory.closest.begin(), c, [&](const auto& other) {
                return (other.a - c->a).norm() <= 2 * length && (other.b - c->b).norm() <= 2 * length;
            });
            if (is_known) continue;
            if (!(distance(*c) > 0))
                throw lie::NumericalFailure("contact_not_converged",
                                            "bodies that overlap so deeply have no unique contact point");
            add(c->a, c->b, (c->b - c->a) / distance(*c), distance(*c), c->parts, 0);
        }
    }

    /// Adds the contact point of the points x_a and x_b of the cores, which are `separation` apart along n.
    /// If these parts have one, the one with the clearly smaller gap remains. The one with the largest gap is
    /// replaced if there are too many.
    void add(const Vec3& x_a, const Vec3& x_b, const Vec3& n, double separation, const TouchingParts& parts,
             double share)
    {
        if (!(separation - radii < reach)) return;
        const auto global = [&](const Vec3& x) -> Vec3 { return at_b.origin + at_b.axes * x; };
        const Vec3 normal = at_b.axes * n, C_a = global(x_a + A.core.radius * n),
                   C_b = global(x_b - B.core.radius * n);
        const auto curvature = [&](std::uint32_t part, const Polytope& core) -> Mat3 {
            const bool is_ball = core.vertex.size() == 1;
            if (!is_ball && ((part & TouchingParts::of_edge) != 0 || !(core.radius > 0))) return Mat3::Zero();
            return (Mat3::Identity() - normal * normal.transpose()) / core.radius;
        };
        const Mat3 K_a = curvature(parts.a, A.core), K_b = curvature(parts.b, B.core);
        ManifoldPoint p;
        p.at.gap = separation - radii;
        p.at.C_i = a_is_j ? C_b : C_a, p.at.C_j = a_is_j ? C_a : C_b;
        p.at.n = a_is_j ? normal : Vec3(-normal);
        p.at.K_i = a_is_j ? K_b : K_a, p.at.K_j = a_is_j ? K_a : K_b;
        p.share = share;
        p.feature = a_is_j ? parts.b << 16 | parts.a : parts.a << 16 | parts.b;
        const auto is_same = [&](const ManifoldPoint& q) { return q.feature == p.feature; };
        ManifoldPoint* other = std::find_if(out.begin(), out.end(), is_same);
        if (other == out.end() && out.size() < Manifold::most) {
            out.push_back(p);
            return;
        }
        if (other == out.end())
            other = std::max_element(
                out.begin(), out.end(),
                [](const ManifoldPoint& q, const ManifoldPoint& r) { return q.at.gap < r.at.gap; });
        if (other->feature == p.feature && other->share == rest) other->share = p.share;
        if (p.at.gap < other->at.gap - length) *other = p;
    }

    const double length;  ///< below it a length is zero [m]
    Scratch& memory;
    PlacedCore A, B;
    const PlacedShape& at_b;
    const bool a_is_j;
    const double radii, reach;
    double share_of_rest = 0;
    bool is_merged = false;  ///< the points of the face stand for more corners
    Manifold& out;
};

class PolytopePolytope final : public Detector {
public:
    PolytopePolytope(const Shape& i, std::shared_ptr<const Polytope> core_i, const Shape& j,
                     std::shared_ptr<const Polytope> core_j)
        : i(i), j(j), core_i(std::move(core_i)), core_j(std::move(core_j)),
          length(negligible * std::min(this->core_i->size(), this->core_j->size()))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        Manifold found;
        detect_all(bi, bj, std::numeric_limits<double>::infinity(), found);
        return std::min_element(
                   found.begin(), found.end(),
                   [](const ManifoldPoint& p, const ManifoldPoint& q) { return p.at.gap < q.at.gap; })
            ->at;
    }

    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        static thread_local Scratch memory;
        out.clear();
        const PlacedShape at_i(i, bi), at_j(j, bj);
        const Vec3 d = at_i.origin - at_j.origin;
        const double far = reach + core_i->bounding_radius() + core_j->bounding_radius();
        if (d.squaredNorm() > far * far) return;
        // The order of the bodies in the computation follows from their poses: exchanged bodies have the same
        // numbers. It changes only where d turns by a large angle.
        Eigen::Index dominant = 0;
        d.cwiseAbs().maxCoeff(&dominant);
        if (d[dominant] > 0)
            Search(*core_j, at_j, *core_i, at_i, true, length, reach, memory, out).run();
        else
            Search(*core_i, at_i, *core_j, at_j, false, length, reach, memory, out).run();
        out.sort();
    }

private:
    const Shape i, j;
    const std::shared_ptr<const Polytope> core_i, core_j;
    const double length;
};

/// The surface as a polytope with a radius: a ball is a single vertex. Empty for other surfaces
std::shared_ptr<const Polytope> core_of(const Shape& s)
{
    if (auto polytope = std::dynamic_pointer_cast<const Polytope>(s.surface)) return polytope;
    if (const auto* ball = surface_as<Sphere>(s); ball != nullptr && !ball->concave)
        return std::make_shared<Polytope>(std::vector<Vec3>{Vec3::Zero()}, ball->R, "sphere");
    return nullptr;
}

}  // namespace

std::unique_ptr<Detector> polytope_polytope(const Shape& i, const Shape& j)
{
    if (surface_as<Polytope>(i) == nullptr && surface_as<Polytope>(j) == nullptr) return nullptr;
    auto core_i = core_of(i), core_j = core_of(j);
    if (core_i == nullptr || core_j == nullptr) return nullptr;
    return std::make_unique<PolytopePolytope>(i, std::move(core_i), j, std::move(core_j));
}

}  // namespace hilda::contact
