// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/common_normal.hpp"

#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/torus.hpp"
#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hilda::contact {

namespace {

using Mat2 = Eigen::Matrix2d;
using Mat32 = Eigen::Matrix<double, 3, 2>;
using Vec2 = Eigen::Vector2d;

constexpr int most = 40;            // iterations
constexpr double most_turn = 0.5;   // of a normal in one step [rad]
constexpr double converged = 1e-9;  // of the smaller surface; the error that is left is its square

/// A surface at one of its points, or near it
struct Local {
    Vec3 x;     // the point
    Vec3 n;     // unit normal, out of the body
    Vec3 onto;  // the step -G/|∇G| along it, onto the surface
    Mat3 B;     // σ ∇²G / |∇G|, so that dn = (I - n nᵀ) B dx

    Local(const Surface& surface, const Placed& at, const Vec3& a)
    {
        const auto [G, gradient, hessian] = surface.derivatives(a);
        const double g = gradient.norm(), sigma = surface.sigma();
        x = at.origin + at.axes * a;
        n = sigma / g * (at.axes * gradient);
        onto = -sigma * G / g * n;
        B = at.axes * (sigma / g * hessian) * at.axes.transpose();
    }

    /// dn of a step dx, or of each column of it
    template <class Steps>
    Steps turn(const Steps& dx) const
    {
        const Steps dn = B * dx;
        return dn - n * (n.transpose() * dn);
    }
    Mat3 shape_operator() const
    {
        const Mat3 P = Mat3::Identity() - n * n.transpose();
        return P * B * P;
    }
};

/// Whether a 2x2 matrix with real eigenvalues has positive ones, by a margin that round-off does not reach
bool positive_definite(const Mat2& S, double margin = 1e-13)
{
    const double trace = S.trace();
    return trace > 0 && S.determinant() > margin * trace * trace;
}

/// K_i + K_j + g K_i K_j in the tangent plane
Mat2 relative_curvature(const ContactPoint& contact_point)
{
    const Mat32 T = tangent_basis(contact_point.n);
    const Mat2 K_i = T.transpose() * contact_point.K_i * T, K_j = T.transpose() * contact_point.K_j * T;
    return K_i + K_j + contact_point.gap * K_i * K_j;
}

bool fills(const Surface& s) { return s.convex() && s.sigma() > 0; }

bool outside(const Surface& s, const Vec3& a) { return s.sigma() * s.value(a) > 0; }

/// A ball of this radius about the origin of a body holds all of it.
double reach(const Surface& s)
{
    if (const auto* sphere = dynamic_cast<const Sphere*>(&s)) return sphere->concave ? INFINITY : sphere->R;
    if (const auto* torus = dynamic_cast<const Torus*>(&s))
        return torus->concave ? INFINITY : torus->R + torus->r;
    if (!fills(s)) return INFINITY;
    Vec3 corner;  // of a box around it
    for (int k = 0; k < 3; ++k)
        corner[k] = std::max((*s.support(Vec3::Unit(k)))[k], -(*s.support(-Vec3::Unit(k)))[k]);
    return corner.norm();
}

/// The nearest point, or one of them where they are many: on the axis of a torus
Vec3 nearest(const Surface& s, const Vec3& x)
{
    try {
        return s.project(x);
    } catch (const lie::NumericalFailure&) {
        return s.project(x + 1e-9 * s.size() * Vec3(0.48, 0.6, 0.64));
    }
}

double size_or(const Shape& s, const Shape& other)
{
    return s.surface->size() > 0 ? s.surface->size() : other.surface->size();
}

/// A point of a surface that faces the point x of another, where that has the normal n. The nearest point does not
/// if x lies within the body; then the search begins well out on the other side.
Vec3 facing(const Surface& s, const Vec3& x, const Vec3& n)
{
    if (s.convex()) return *s.support(-s.sigma() * n);
    const Vec3 near = nearest(s, x);
    return s.normal(near).dot(n) < 0 ? near : nearest(s, -2 * s.size() * n);
}

/// Detects in an order of the two shapes that does not depend on which is i, so that exchanging the bodies
/// changes no digit.
class EitherOrder final : public Detector {
public:
    EitherOrder(const Shape& i, const Shape& j) : i(i), j(j), ij(i, j), ji(j, i) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const Points* from) const override
    {
        const Vec3 o_i = bi.r + bi.A * i.position, o_j = bj.r + bj.A * j.position;
        const bool i_first =
            std::lexicographical_compare(o_i.data(), o_i.data() + 3, o_j.data(), o_j.data() + 3);
        return i_first ? ij.detect(bi, bj, from) : detect_exchanged(ji, bi, bj, from);
    }

private:
    const Shape i, j;
    const CommonNormal ij, ji;
};

}  // namespace

struct CommonNormal::Outcome {
    ContactPoint contact_point;
    const char* trouble;  // nullptr if there is none
    bool no_fit;          // the pose is to blame, not the search
    double correction;
    int iterations;
};

CommonNormal::CommonNormal(const Shape& i, const Shape& j)
    : i(i), j(j), small(std::min(size_or(i, j), size_or(j, i))),
      large(std::max(size_or(i, j), size_or(j, i))), reach_i(reach(*i.surface)), reach_j(reach(*j.surface)),
      single(fills(*i.surface) && fills(*j.surface))
{}

ContactPoint CommonNormal::detect(const Motion& bi, const Motion& bj, const Points* from) const
{
    Pair p = placed(bi, bj);
    const Vec3 origin = bj.r + bj.A * j.position;
    Outcome best{};
    best.trouble = "there is no point to begin from";
    best.contact_point.n.setConstant(NAN);
    const auto search = [&] {
        Outcome end = solve(p, origin);
        if (end.trouble == nullptr && !single && crossed(p, end.contact_point.gap))
            end.trouble = "the bodies do not overlap where their normals are opposite";
        if (best.trouble != nullptr ||
            (end.trouble == nullptr && end.contact_point.gap < best.contact_point.gap))
            best = end;
    };
    if (from != nullptr) {
        p.a_i = i.to_surface(from->c_i), p.a_j = j.to_surface(from->c_j);
        search();
        if (best.trouble == nullptr && (single || best.contact_point.gap <= 0)) return best.contact_point;
    }
    // Of two convex bodies the first touch is the only one. In a bowl, or around a ring, there may be several,
    // and another may be nearer than the one that is followed.
    const int enough = single ? 1 : 2;
    int searches = 0;
    for (int projections : {0, 1, 3, 10, 30}) {
        if (!begin(p, projections, Vec3::Zero())) continue;
        search();
        if (++searches >= enough && best.trouble == nullptr) break;
    }
    if (!supported())
        for (int corner = 0; corner < 8 && best.trouble != nullptr; ++corner) {
            const auto sign = [&](int bit) { return (corner & bit) != 0 ? -1 : 1; };
            if (begin(p, 10, Vec3(sign(1) * 0.48, sign(2) * 0.6, sign(4) * 0.64))) search();
        }
    if (best.trouble == nullptr) return best.contact_point;
    if (const auto contact_point = apart(bi, bj, origin)) return *contact_point;

    std::ostringstream what;
    if (const std::string why = misfit(bi, bj); !why.empty()) throw NoUniqueContactPoint(why);
    what << "no touch of two surfaces: " << best.trouble;
    if (best.contact_point.n.allFinite())
        what << ", least sum of their curvatures " << least_curvature(best.contact_point) << " 1/m";
    if (best.iterations == 0)
        what << why_no_beginning(bi, bj);
    else if (std::isfinite(best.correction) && std::isfinite(best.contact_point.gap))
        what << "; correction " << best.correction << " m, gap " << best.contact_point.gap << " m, after "
             << best.iterations << " iterations";
    else
        what << "; the search for the points leads nowhere";
    if (best.no_fit) throw NoUniqueContactPoint(what.str());
    throw lie::NumericalFailure("contact_not_converged", what.str());
}

/// What the first projection meets with
std::string CommonNormal::why_no_beginning(const Motion& bi, const Motion& bj) const
{
    try {
        Pair p = placed(bi, bj);
        alternate(p, 1, Vec3::Zero());
    } catch (const lie::NumericalFailure& e) {
        return std::string(", ") + e.what();
    }
    return {};
}

std::string CommonNormal::misfit(const Motion& bi, const Motion& bj) const
{
    const bool i_hollow = i.surface->sigma() < 0;
    const Shape &body = i_hollow ? j : i, &bowl = i_hollow ? i : j;
    if (!fills(*body.surface) || !bowl.surface->convex() || bowl.surface->sigma() > 0) return {};
    const Pair p = placed(bi, bj);
    const Mat3 &of_body = i_hollow ? p.j.axes : p.i.axes, &of_bowl = i_hollow ? p.i.axes : p.j.axes;
    const auto width = [](const Surface& s, const Vec3& along) {
        try {
            return along.dot(*s.support(along) - *s.support(-along));
        } catch (const lie::NumericalFailure&) {  // the furthest points are many
            return std::nan("");
        }
    };
    double most_over = 0, across = 0, room = 0;
    for (const Mat3& axes : {of_body, of_bowl})
        for (int k = 0; k < 3; ++k) {
            const double b = width(*body.surface, of_body.transpose() * axes.col(k)),
                         w = width(*bowl.surface, of_bowl.transpose() * axes.col(k));
            if (b - w > most_over) most_over = b - w, across = b, room = w;
        }
    if (!(most_over > 0)) return {};
    std::ostringstream what;
    what << "the body is larger than the bowl it should lie in: " << across
         << " m across, where there is room for " << room << " m";
    return what.str();
}

/// Whether what looks like overlap is none, as where the normals of two rings are opposite across their holes:
/// neither of the points is within the other body.
bool CommonNormal::crossed(const Pair& p, double gap) const
{
    if (gap >= -converged * small) return false;
    const Vec3 d = p.i.origin - p.j.origin;
    const Vec3 i_in_j = p.j.axes.transpose() * (p.i.axes * p.a_i + d);
    const Vec3 j_in_i = p.i.axes.transpose() * (p.j.axes * p.a_j - d);
    return outside(*j.surface, i_in_j) && outside(*i.surface, j_in_i);
}

/// The points of the two surfaces to which projections lead, where they show that the bodies do not touch:
///
/// - the middle of one body is further from the other surface than any of its own points; or
/// - they are the nearest points of each other, as Newton's method finds them, but not the only ones; or
/// - no body is hollow, and the distance is more than the size of the smaller.
std::optional<ContactPoint> CommonNormal::apart(const Motion& bi, const Motion& bj, const Vec3& origin) const
{
    Pair p = placed(bi, bj), before = p;
    const auto beyond = [&](const Surface& s, const Placed& at, const Vec3& x, double reach) {
        const Vec3 a = at.axes.transpose() * (x - at.origin);
        return std::isfinite(reach) && outside(s, a) && (nearest(s, a) - a).norm() > reach;
    };
    try {
        alternate(before, 29, Vec3::Zero());
        alternate(p, 30, Vec3::Zero());
        const Local at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
        const Vec3 x = at_i.x - at_j.x;
        ContactPoint contact_point;
        contact_point.gap = x.norm();
        contact_point.n = x / contact_point.gap;
        contact_point.C_i = origin + at_i.x, contact_point.C_j = origin + at_j.x;
        const Mat3 P = Mat3::Identity() - contact_point.n * contact_point.n.transpose();
        contact_point.K_i = P * at_i.B * P, contact_point.K_j = P * at_j.B * P;
        if (!(contact_point.gap > converged * small && contact_point.K_i.allFinite() &&
              contact_point.K_j.allFinite()))
            return {};

        if (beyond(*j.surface, p.j, p.i.origin, reach_i) || beyond(*i.surface, p.i, p.j.origin, reach_j))
            return contact_point;
        if (!outside(*j.surface, p.j.axes.transpose() * (at_i.x - p.j.origin)) ||
            !outside(*i.surface, p.i.axes.transpose() * (at_j.x - p.i.origin)))
            return {};
        const bool hollow = i.surface->sigma() < 0 || j.surface->sigma() < 0;
        if (!hollow && contact_point.gap > small) return contact_point;
        const double moved = std::max((p.a_i - before.a_i).norm(), (p.a_j - before.a_j).norm());
        constexpr double rounding = 1e-6;
        if (moved < rounding * small && positive_definite(relative_curvature(contact_point), -rounding))
            return contact_point;
    } catch (const lie::NumericalFailure&) {
        // a point without a nearest one or without a normal shows nothing
    }
    return {};
}

CommonNormal::Pair CommonNormal::placed(const Motion& bi, const Motion& bj) const
{
    Pair p{Placed(i, bi), Placed(j, bj)};
    p.i.origin = (bi.r - bj.r) + (bi.A * i.position - bj.A * j.position);
    p.j.origin.setZero();
    return p;
}

CommonNormal::Outcome CommonNormal::solve(Pair& p, const Vec3& origin) const
{
    Outcome end{};
    double& correction = end.correction = INFINITY;
    while (correction > converged * small && end.iterations < most) {
        correction = improve(p);
        ++end.iterations;
    }
    const Local at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
    const Vec3& n = at_j.n;
    ContactPoint& contact_point = end.contact_point;
    contact_point.C_i = origin + at_i.x, contact_point.C_j = origin + at_j.x;
    contact_point.n = n;
    contact_point.gap = n.dot(at_i.x - at_j.x);
    contact_point.K_i = at_i.shape_operator(), contact_point.K_j = at_j.shape_operator();

    constexpr const char* no_fit = "the surfaces do not curve away from each other";
    if (!std::isfinite(correction))
        end.trouble = no_fit;
    else if (!(correction <= converged * small))
        end.trouble = "Newton's method did not converge";
    else if (!(at_i.n.dot(n) < -0.5))
        end.trouble = "the normals are not opposite";
    else if (!positive_definite(relative_curvature(contact_point)))
        end.trouble = no_fit;
    end.no_fit = end.trouble == no_fit;
    return end;
}

double CommonNormal::improve(Pair& p) const
{
    const Local at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
    const Mat32 T = tangent_basis(at_j.n), T_i = T - at_i.n * (at_i.n.transpose() * T);
    const Vec3 x = at_i.x - at_j.x;
    const double gap = at_j.n.dot(x);
    const Mat32 N_i = at_i.turn(T_i), N_j = at_j.turn(T);
    const Vec3 turned = at_j.turn(at_j.onto);

    Eigen::Matrix4d J;
    J.topLeftCorner<2, 2>() = T.transpose() * T_i;
    J.topRightCorner<2, 2>() = -Mat2::Identity() - gap * (T.transpose() * N_j);
    J.bottomLeftCorner<2, 2>() = small * (T.transpose() * N_i);
    J.bottomRightCorner<2, 2>() = small * (T.transpose() * N_j);
    Eigen::Vector4d e;
    e.head<2>() = T.transpose() * (x + at_i.onto - gap * turned);
    e.tail<2>() = small * (T.transpose() * (at_i.n + at_i.turn(at_i.onto) + turned));
    const Eigen::Vector4d y = J.partialPivLu().solve(-e);

    Vec3 step_i = T_i * y.head<2>(), step_j = T * y.tail<2>();
    const double turn = std::max((N_i * y.head<2>()).norm(), (N_j * y.tail<2>()).norm());
    const double length = std::max(step_i.norm(), step_j.norm());
    const double cut = std::min({1.0, most_turn / turn, 2 * large / length});
    step_i = cut * step_i + at_i.onto, step_j = cut * step_j + at_j.onto;
    p.a_i += p.i.axes.transpose() * step_i;
    p.a_j += p.j.axes.transpose() * step_j;
    return std::sqrt(std::max(step_i.squaredNorm(), step_j.squaredNorm()));
}

bool CommonNormal::supported() const { return i.surface->convex() && j.surface->convex(); }

bool CommonNormal::begin(Pair& p, int projections, const Vec3& corner) const
{
    if (projections == 0 && !supported()) return false;
    try {
        if (projections == 0)
            turn_normal(p);
        else
            alternate(p, projections, corner);
    } catch (const lie::NumericalFailure&) {
        return false;
    }
    return true;
}

/// Newton's method on the two angles of n, to the least overlap: with the support points C_i(n) and C_j(n),
///
///     g(n) = n·(C_i - C_j),   dg = (C_i - C_j)·dn,   d²g = -dnᵀ(K_i⁻¹ + K_j⁻¹ + g) dn
///
/// has its maximum where two convex bodies face each other, touching or not; in a bowl it is a minimum.
void CommonNormal::turn_normal(Pair& p) const
{
    const double sigma_i = i.surface->sigma(), sigma_j = j.surface->sigma();
    const double uphill = sigma_i * sigma_j;  // 1, or -1 in a bowl
    struct Trial {
        Vec3 n, a_i, a_j, x;
        double g;
    };
    const auto at = [&](const Vec3& n) {
        Trial t;
        t.n = n;
        t.a_i = *i.surface->support(p.i.axes.transpose() * (-sigma_i * n));
        t.a_j = *j.surface->support(p.j.axes.transpose() * (sigma_j * n));
        t.x = p.i.origin + p.i.axes * t.a_i - p.j.axes * t.a_j;
        t.g = n.dot(t.x);
        return t;
    };
    const double distance = p.i.origin.norm();
    Trial now = at(distance > 0 ? Vec3(uphill / distance * p.i.origin) : Vec3(p.j.axes.col(2)));

    const Mat2 least = 1e-3 / large * Mat2::Identity();  // flat points have no K⁻¹
    for (int k = 0; k < most; ++k) {
        const Mat32 T = tangent_basis(now.n);
        const Vec2 slope = uphill * (T.transpose() * now.x);
        if (slope.norm() < 1e-3 * small) break;
        const Mat32 T_i = p.i.axes.transpose() * T, T_j = p.j.axes.transpose() * T;
        const Mat2 K_i = sigma_i * (T_i.transpose() * i.surface->shape_operator(now.a_i) * T_i) + least;
        const Mat2 K_j = sigma_j * (T_j.transpose() * j.surface->shape_operator(now.a_j) * T_j) + least;
        Mat2 J = uphill * (sigma_i * K_i.inverse() + sigma_j * K_j.inverse());
        J.diagonal().array() += uphill * now.g;
        Vec2 y = positive_definite(J) ? Vec2(J.inverse() * slope) : Vec2(slope / (small + large));
        if (const double turn = y.norm(); turn > most_turn) y *= most_turn / turn;
        Trial next = at((now.n + T * y).normalized());
        for (int half = 0; half < 20 && uphill * (next.g - now.g) < 0; ++half) {
            y *= 0.5;
            next = at((now.n + T * y).normalized());
        }
        now = next;
    }
    p.a_i = now.a_i, p.a_j = now.a_j;
}

/// From the centre of one surface, or from its point that is the nearest to one far away in a corner, to the nearest point of the other, from there to the point that faces it, and so
/// on. A plane has no centre, and of the others the hollow or the larger one is met first.
void CommonNormal::alternate(Pair& p, int projections, const Vec3& corner) const
{
    const auto rank = [](const Surface& s) {
        return s.size() == 0 ? INFINITY : s.size() * (s.sigma() < 0 ? 1e3 : 1);
    };
    const bool i_first = rank(*i.surface) > rank(*j.surface);
    const Surface &a = i_first ? *i.surface : *j.surface, &b = i_first ? *j.surface : *i.surface;
    const Placed &at_a = i_first ? p.i : p.j, &at_b = i_first ? p.j : p.i;
    Vec3 &a_a = i_first ? p.a_i : p.a_j, &a_b = i_first ? p.a_j : p.a_i;
    a_b = corner == Vec3::Zero() ? corner : nearest(b, 10 * b.size() * corner);
    for (int k = 0; k < projections; ++k) {
        const Vec3 x_b = at_b.origin + at_b.axes * a_b;
        a_a = nearest(a, at_a.axes.transpose() * (x_b - at_a.origin));
        const Vec3 x_a = at_a.origin + at_a.axes * a_a, n = at_a.axes * a.normal(a_a);
        a_b = facing(b, at_b.axes.transpose() * (x_a - at_b.origin), at_b.axes.transpose() * n);
    }
}

std::unique_ptr<Detector> common_normal(const Shape& i, const Shape& j)
{
    return std::make_unique<EitherOrder>(i, j);
}

}  // namespace hilda::contact
