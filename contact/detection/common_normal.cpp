// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/common_normal.hpp"

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

constexpr int max_iterations = 40;    // of Newton's method
constexpr double max_rotation = 0.5;  // rotation of a normal in one step [rad]
constexpr double tolerance = 1e-9;    // of the step, relative to the smaller size; convergence is quadratic

/// Geometry of a surface at a point on it or near it, in global axes
struct LocalGeometry {
    Vec3 x;             // the point
    Vec3 n;             // unit normal, out of the body
    Vec3 surface_step;  // -G/|∇G| along the normal: linearised step onto the surface
    Mat3 B;             // σ ∇²G / |∇G|; dn = (I - n nᵀ) B dx

    LocalGeometry(const Surface& surface, const PlacedShape& at, const Vec3& a)
    {
        const auto [G, gradient, hessian] = surface.derivatives(a);
        const double g = gradient.norm(), sigma = surface.sigma();
        x = at.origin + at.axes * a;
        n = sigma / g * (at.axes * gradient);
        surface_step = -sigma * G / g * n;
        B = at.axes * (sigma / g * hessian) * at.axes.transpose();
    }

    /// dn of a step dx; of each column if dx is a matrix
    template <class Steps>
    Steps normal_change(const Steps& dx) const
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

/// True if both eigenvalues of S are positive: S is 2x2 with real eigenvalues, and the margin is above
/// round-off
bool positive_definite(const Mat2& S, double margin = 1e-13)
{
    const double trace = S.trace();
    return trace > 0 && S.determinant() > margin * trace * trace;
}

/// Relative curvature K_i + K_j + g K_i K_j in the tangent plane [1/m]
Mat2 relative_curvature(const ContactPoint& contact_point)
{
    const Mat32 T = tangent_basis(contact_point.n);
    const Mat2 K_i = T.transpose() * contact_point.K_i * T, K_j = T.transpose() * contact_point.K_j * T;
    return K_i + K_j + contact_point.gap * K_i * K_j;
}

bool is_convex_solid(const Surface& s) { return s.convex() && s.sigma() > 0; }

bool outside(const Surface& s, const Vec3& a) { return s.sigma() * s.value(a) > 0; }

/// The point of the surface closest to x; one of them if it is not unique, such as on the axis of a torus
Vec3 nearest_point(const Surface& s, const Vec3& x)
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

/// A point of surface s opposite to the point x of the other surface, which has the normal n there. If x lies
/// inside the body, the closest point has the wrong normal; a far point along -n is then projected instead.
Vec3 facing_point(const Surface& s, const Vec3& x, const Vec3& n)
{
    if (s.convex()) return *s.support(-s.sigma() * n);
    const Vec3 near = nearest_point(s, x);
    return s.normal(near).dot(n) < 0 ? near : nearest_point(s, -2 * s.size() * n);
}

/// Calls CommonNormal with the shapes in the order of their positions, so that the result is bit-identical if
/// the bodies i and j are exchanged.
class OrderIndependent final : public Detector {
public:
    OrderIndependent(const Shape& i, const Shape& j) : i(i), j(j), ij(i, j), ji(j, i) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const override
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

struct CommonNormal::SearchResult {
    ContactPoint contact_point;
    const char* failure;         // reason of failure, nullptr if the search succeeded
    bool not_positive_definite;  // the failure is a property of the pose, not of the search
    double correction;
    int iterations;
};

CommonNormal::CommonNormal(const Shape& i, const Shape& j)
    : i(i), j(j), smaller_size(std::min(size_or(i, j), size_or(j, i))),
      larger_size(std::max(size_or(i, j), size_or(j, i))), bounding_radius_i(i.surface->bounding_radius()),
      bounding_radius_j(j.surface->bounding_radius()),
      both_convex(is_convex_solid(*i.surface) && is_convex_solid(*j.surface))
{}

ContactPoint CommonNormal::detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const
{
    Pair p = placed(bi, bj);
    const Vec3 origin = bj.r + bj.A * j.position;
    SearchResult best{};
    best.failure = "no starting points were found";
    best.contact_point.n.setConstant(NAN);
    const auto search = [&] {
        SearchResult end = solve(p, origin);
        if (end.failure == nullptr && !both_convex && is_false_overlap(p, end.contact_point.gap))
            end.failure = "the normals are opposite at points where the bodies do not overlap";
        if (best.failure != nullptr ||
            (end.failure == nullptr && end.contact_point.gap < best.contact_point.gap))
            best = end;
    };
    if (from != nullptr) {
        p.a_i = i.to_surface(from->c_i), p.a_j = j.to_surface(from->c_j);
        search();
        if (best.failure == nullptr && (both_convex || best.contact_point.gap <= 0))
            return best.contact_point;
    }
    // Two convex bodies have a single contact point. Otherwise there may be several, and a point other than
    // the previous one may have the smaller gap: two searches are made.
    const int max_successful = both_convex ? 1 : 2;
    int searches = 0;
    for (int projections : {0, 1, 3, 10, 30}) {
        if (!set_start_points(p, projections, Vec3::Zero())) continue;
        search();
        if (++searches >= max_successful && best.failure == nullptr) break;
    }
    if (!have_support_functions())
        for (int corner = 0; corner < 8 && best.failure != nullptr; ++corner) {
            const auto sign = [&](int bit) { return (corner & bit) != 0 ? -1 : 1; };
            if (set_start_points(p, 10, Vec3(sign(1) * 0.48, sign(2) * 0.6, sign(4) * 0.64))) search();
        }
    if (best.failure == nullptr) return best.contact_point;
    if (const auto contact_point = find_separated_points(bi, bj, origin)) return *contact_point;

    std::ostringstream what;
    if (const std::string why = width_conflict(bi, bj); !why.empty()) throw NoUniqueContactPoint(why);
    what << "no contact point of two surfaces: " << best.failure;
    if (best.contact_point.n.allFinite())
        what << ", smallest principal curvature of K_i + K_j " << least_curvature(best.contact_point)
             << " 1/m";
    if (best.iterations == 0)
        what << start_failure(bi, bj);
    else if (std::isfinite(best.correction) && std::isfinite(best.contact_point.gap))
        what << "; correction " << best.correction << " m, gap " << best.contact_point.gap << " m, after "
             << best.iterations << " iterations";
    else
        what << "; the iteration diverged";
    if (best.not_positive_definite) throw NoUniqueContactPoint(what.str());
    throw lie::NumericalFailure("contact_not_converged", what.str());
}

bool CommonNormal::is_nearest(const Pair& p) const
{
    const LocalGeometry at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
    ContactPoint at;
    at.n = at_j.n;
    at.gap = at.n.dot(at_i.x - at_j.x);
    at.K_i = at_i.shape_operator(), at.K_j = at_j.shape_operator();
    return positive_definite(relative_curvature(at));
}

std::optional<ContactPoint> CommonNormal::find_overlap_besides(const ContactPoint& known, const Motion& bi,
                                                               const Motion& bj, double least) const
{
    constexpr double same_point = 1e-3;  // relative to the smaller size
    const Vec3 origin = bj.r + bj.A * j.position;
    std::optional<ContactPoint> deepest;
    for (int start = 0; start < 9; ++start) {
        const auto sign = [&](int bit) { return (start & bit) != 0 ? -1 : 1; };
        const Vec3 corner = start == 8 ? Vec3(0, 0, 0) : Vec3(sign(1) * 0.48, sign(2) * 0.6, sign(4) * 0.64);
        Pair p = placed(bi, bj);
        if (!set_start_points(p, 2, corner)) continue;
        const SearchResult end = solve(p, origin);
        if (end.failure != nullptr || is_false_overlap(p, end.contact_point.gap)) continue;
        const ContactPoint& at = end.contact_point;
        if (!(at.gap < -least) || (at.C() - known.C()).norm() < same_point * smaller_size) continue;
        if (!deepest || at.gap < deepest->gap) deepest = at;
    }
    return deepest;
}

/// The message of the first projection if it fails
std::string CommonNormal::start_failure(const Motion& bi, const Motion& bj) const
{
    try {
        Pair p = placed(bi, bj);
        project_alternately(p, 1, Vec3::Zero());
    } catch (const lie::NumericalFailure& e) {
        return std::string(", ") + e.what();
    }
    return {};
}

std::string CommonNormal::width_conflict(const Motion& bi, const Motion& bj) const
{
    const bool i_hollow = i.surface->sigma() < 0;
    const Shape &body = i_hollow ? j : i, &bowl = i_hollow ? i : j;
    if (!is_convex_solid(*body.surface) || !bowl.surface->convex() || bowl.surface->sigma() > 0) return {};
    const Pair p = placed(bi, bj);
    const Mat3 &of_body = i_hollow ? p.j.axes : p.i.axes, &of_bowl = i_hollow ? p.i.axes : p.j.axes;
    const auto width = [](const Surface& s, const Vec3& along) {
        try {
            return along.dot(*s.support(along) - *s.support(-along));
        } catch (const lie::NumericalFailure&) {  // the support point is not unique
            return std::nan("");
        }
    };
    double largest_excess = 0, across = 0, available = 0;
    for (const Mat3& axes : {of_body, of_bowl})
        for (int k = 0; k < 3; ++k) {
            const double b = width(*body.surface, of_body.transpose() * axes.col(k)),
                         w = width(*bowl.surface, of_bowl.transpose() * axes.col(k));
            if (b - w > largest_excess) largest_excess = b - w, across = b, available = w;
        }
    if (!(largest_excess > 0)) return {};
    std::ostringstream what;
    what << "the convex body does not fit into the concave surface: its width is " << across
         << " m, the width available is " << available << " m";
    return what.str();
}

/// True if the solution has a negative gap although neither point lies inside the other body. This happens,
/// for example, where the normals of two tori are opposite across their holes.
bool CommonNormal::is_false_overlap(const Pair& p, double gap) const
{
    if (gap >= -tolerance * smaller_size) return false;
    const Vec3 d = p.i.origin - p.j.origin;
    const Vec3 i_in_j = p.j.axes.transpose() * (p.i.axes * p.a_i + d);
    const Vec3 j_in_i = p.i.axes.transpose() * (p.j.axes * p.a_j - d);
    return outside(*j.surface, i_in_j) && outside(*i.surface, j_in_i);
}

/// Points of the two surfaces found by alternating projections, if they prove that the bodies do not touch:
///
/// - the distance from the origin of one body to the other surface exceeds its bounding radius; or
/// - the projections have converged to points that are closest to each other, but not uniquely; or
/// - neither body is concave, and the distance exceeds the smaller size.
///
/// Returns nothing otherwise.
std::optional<ContactPoint> CommonNormal::find_separated_points(const Motion& bi, const Motion& bj,
                                                                const Vec3& origin) const
{
    Pair p = placed(bi, bj), before = p;
    const auto is_outside_ball = [&](const Surface& s, const PlacedShape& at, const Vec3& x, double radius) {
        const Vec3 a = at.axes.transpose() * (x - at.origin);
        return std::isfinite(radius) && outside(s, a) && (nearest_point(s, a) - a).norm() > radius;
    };
    try {
        project_alternately(before, 29, Vec3::Zero());
        project_alternately(p, 30, Vec3::Zero());
        const LocalGeometry at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
        const Vec3 x = at_i.x - at_j.x;
        ContactPoint contact_point;
        contact_point.gap = x.norm();
        contact_point.n = x / contact_point.gap;
        contact_point.C_i = origin + at_i.x, contact_point.C_j = origin + at_j.x;
        const Mat3 P = Mat3::Identity() - contact_point.n * contact_point.n.transpose();
        contact_point.K_i = P * at_i.B * P, contact_point.K_j = P * at_j.B * P;
        if (!(contact_point.gap > tolerance * smaller_size && contact_point.K_i.allFinite() &&
              contact_point.K_j.allFinite()))
            return {};

        if (is_outside_ball(*j.surface, p.j, p.i.origin, bounding_radius_i) ||
            is_outside_ball(*i.surface, p.i, p.j.origin, bounding_radius_j))
            return contact_point;
        if (!outside(*j.surface, p.j.axes.transpose() * (at_i.x - p.j.origin)) ||
            !outside(*i.surface, p.i.axes.transpose() * (at_j.x - p.i.origin)))
            return {};
        const bool hollow = i.surface->sigma() < 0 || j.surface->sigma() < 0;
        if (!hollow && contact_point.gap > smaller_size) return contact_point;
        const double moved = std::max((p.a_i - before.a_i).norm(), (p.a_j - before.a_j).norm());
        constexpr double rounding = 1e-6;
        if (moved < rounding * smaller_size &&
            positive_definite(relative_curvature(contact_point), -rounding))
            return contact_point;
    } catch (const lie::NumericalFailure&) {
        // a projection failed or a normal is undefined: nothing is proved
    }
    return {};
}

CommonNormal::Pair CommonNormal::placed(const Motion& bi, const Motion& bj) const
{
    Pair p{PlacedShape(i, bi), PlacedShape(j, bj)};
    p.i.origin = (bi.r - bj.r) + (bi.A * i.position - bj.A * j.position);
    p.j.origin.setZero();
    return p;
}

CommonNormal::SearchResult CommonNormal::solve(Pair& p, const Vec3& origin) const
{
    SearchResult end{};
    double& correction = end.correction = INFINITY;
    while (correction > tolerance * smaller_size && end.iterations < max_iterations) {
        correction = newton_step(p);
        ++end.iterations;
    }
    const LocalGeometry at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
    const Vec3& n = at_j.n;
    ContactPoint& contact_point = end.contact_point;
    contact_point.C_i = origin + at_i.x, contact_point.C_j = origin + at_j.x;
    contact_point.n = n;
    contact_point.gap = n.dot(at_i.x - at_j.x);
    contact_point.K_i = at_i.shape_operator(), contact_point.K_j = at_j.shape_operator();

    constexpr const char* not_positive_definite = "the surfaces do not curve away from each other";
    const auto failure = [&]() -> const char* {
        if (!std::isfinite(correction)) return not_positive_definite;
        if (!(correction <= tolerance * smaller_size)) return "Newton's method did not converge";
        if (!(at_i.n.dot(n) < -0.5)) return "the normals are not opposite";
        if (!positive_definite(relative_curvature(contact_point))) return not_positive_definite;
        return nullptr;
    };
    end.failure = failure();
    end.not_positive_definite = end.failure == not_positive_definite;
    return end;
}

double CommonNormal::newton_step(Pair& p) const
{
    const LocalGeometry at_i(*i.surface, p.i, p.a_i), at_j(*j.surface, p.j, p.a_j);
    const Mat32 T = tangent_basis(at_j.n), T_i = T - at_i.n * (at_i.n.transpose() * T);
    const Vec3 x = at_i.x - at_j.x;
    const double gap = at_j.n.dot(x);
    const Mat32 N_i = at_i.normal_change(T_i), N_j = at_j.normal_change(T);
    const Vec3 change_j = at_j.normal_change(at_j.surface_step);

    Eigen::Matrix4d J;
    J.topLeftCorner<2, 2>() = T.transpose() * T_i;
    J.topRightCorner<2, 2>() = -Mat2::Identity() - gap * (T.transpose() * N_j);
    J.bottomLeftCorner<2, 2>() = smaller_size * (T.transpose() * N_i);
    J.bottomRightCorner<2, 2>() = smaller_size * (T.transpose() * N_j);
    Eigen::Vector4d e;
    e.head<2>() = T.transpose() * (x + at_i.surface_step - gap * change_j);
    e.tail<2>() =
        smaller_size * (T.transpose() * (at_i.n + at_i.normal_change(at_i.surface_step) + change_j));
    const Eigen::Vector4d y = J.partialPivLu().solve(-e);

    Vec3 step_i = T_i * y.head<2>(), step_j = T * y.tail<2>();
    const double turn = std::max((N_i * y.head<2>()).norm(), (N_j * y.tail<2>()).norm());
    const double length = std::max(step_i.norm(), step_j.norm());
    const double step_factor = std::min({1.0, max_rotation / turn, 2 * larger_size / length});
    step_i = step_factor * step_i + at_i.surface_step, step_j = step_factor * step_j + at_j.surface_step;
    p.a_i += p.i.axes.transpose() * step_i;
    p.a_j += p.j.axes.transpose() * step_j;
    return std::sqrt(std::max(step_i.squaredNorm(), step_j.squaredNorm()));
}

bool CommonNormal::have_support_functions() const { return i.surface->convex() && j.surface->convex(); }

bool CommonNormal::set_start_points(Pair& p, int projections, const Vec3& corner) const
{
    if (projections == 0 && !have_support_functions()) return false;
    try {
        if (projections == 0)
            search_normal(p);
        else
            project_alternately(p, projections, corner);
    } catch (const lie::NumericalFailure&) {
        return false;
    }
    return true;
}

/// Newton's method on the two angles of n for the stationary separation. With the support points C_i(n) and
/// C_j(n),
///
///     g(n) = n·(C_i - C_j),   dg = (C_i - C_j)·dn,   d²g = -dnᵀ(K_i⁻¹ + K_j⁻¹ + g) dn
///
/// has its maximum at the common normal of two convex bodies, in contact or not. For a convex body in a
/// concave surface it is a minimum.
void CommonNormal::search_normal(Pair& p) const
{
    const double sigma_i = i.surface->sigma(), sigma_j = j.surface->sigma();
    const double sign = sigma_i * sigma_j;  // 1: maximum, -1: minimum
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
    Trial now = at(distance > 0 ? Vec3(sign / distance * p.i.origin) : Vec3(p.j.axes.col(2)));

    const Mat2 least = 1e-3 / larger_size * Mat2::Identity();  // K is singular at flat points
    for (int k = 0; k < max_iterations; ++k) {
        const Mat32 T = tangent_basis(now.n);
        const Vec2 slope = sign * (T.transpose() * now.x);
        if (slope.norm() < 1e-3 * smaller_size) break;
        const Mat32 T_i = p.i.axes.transpose() * T, T_j = p.j.axes.transpose() * T;
        const Mat2 K_i = sigma_i * (T_i.transpose() * i.surface->shape_operator(now.a_i) * T_i) + least;
        const Mat2 K_j = sigma_j * (T_j.transpose() * j.surface->shape_operator(now.a_j) * T_j) + least;
        Mat2 J = sign * (sigma_i * K_i.inverse() + sigma_j * K_j.inverse());
        J.diagonal().array() += sign * now.g;
        Vec2 y =
            positive_definite(J) ? Vec2(J.inverse() * slope) : Vec2(slope / (smaller_size + larger_size));
        if (const double turn = y.norm(); turn > max_rotation) y *= max_rotation / turn;
        Trial next = at((now.n + T * y).normalized());
        for (int half = 0; half < 20 && sign * (next.g - now.g) < 0; ++half) {
            y *= 0.5;
            next = at((now.n + T * y).normalized());
        }
        now = next;
    }
    p.a_i = now.a_i, p.a_j = now.a_j;
}

/// Alternating projections: from the origin of surface b, or from its point closest to a far point in the
/// direction `corner`, to the closest point of surface a, from there to the opposite point of b, and so on.
/// Surface a is the plane, the concave surface or the larger one, in this order.
void CommonNormal::project_alternately(Pair& p, int projections, const Vec3& corner) const
{
    const auto rank = [](const Surface& s) {
        return s.size() == 0 ? INFINITY : s.size() * (s.sigma() < 0 ? 1e3 : 1);
    };
    const bool i_first = rank(*i.surface) > rank(*j.surface);
    const Surface &a = i_first ? *i.surface : *j.surface, &b = i_first ? *j.surface : *i.surface;
    const PlacedShape &at_a = i_first ? p.i : p.j, &at_b = i_first ? p.j : p.i;
    Vec3 &a_a = i_first ? p.a_i : p.a_j, &a_b = i_first ? p.a_j : p.a_i;
    a_b = corner == Vec3::Zero() ? corner : nearest_point(b, 10 * b.size() * corner);
    for (int k = 0; k < projections; ++k) {
        const Vec3 x_b = at_b.origin + at_b.axes * a_b;
        a_a = nearest_point(a, at_a.axes.transpose() * (x_b - at_a.origin));
        const Vec3 x_a = at_a.origin + at_a.axes * a_a, n = at_a.axes * a.normal(a_a);
        a_b = facing_point(b, at_b.axes.transpose() * (x_a - at_b.origin), at_b.axes.transpose() * n);
    }
}

std::unique_ptr<Detector> common_normal(const Shape& i, const Shape& j)
{
    return std::make_unique<OrderIndependent>(i, j);
}

}  // namespace hilda::contact
