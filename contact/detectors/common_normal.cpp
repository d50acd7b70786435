// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detectors/common_normal.hpp"

#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

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
bool positive_definite(const Mat2& S)
{
    const double trace = S.trace();
    return trace > 0 && S.determinant() > 1e-13 * trace * trace;
}

/// The smaller eigenvalue of K_i + K_j in the tangent plane
double least(const Touch& touch)
{
    const Mat32 T = tangent_basis(touch.n);
    const Mat2 K = T.transpose() * (touch.K_i + touch.K_j) * T;
    return 0.5 * K.trace() - std::hypot(0.5 * (K(0, 0) - K(1, 1)), K(0, 1));
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
    const Vec3 nearest = s.project(x);
    return s.normal(nearest).dot(n) < 0 ? nearest : s.project(-2 * s.size() * n);
}

/// Detects in an order of the two shapes that does not depend on which is i, so that exchanging the bodies
/// changes no digit.
class EitherOrder final : public Detector {
public:
    EitherOrder(const Shape& i, const Shape& j) : i(i), j(j), ij(i, j), ji(j, i) {}

    Touch detect(const Motion& bi, const Motion& bj, const Points* from) const override
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
    Touch touch;
    const char* trouble;  // nullptr if there is none
    double correction;
    int iterations;
};

CommonNormal::CommonNormal(const Shape& i, const Shape& j)
    : i(i), j(j), small(std::min(size_or(i, j), size_or(j, i))), large(std::max(size_or(i, j), size_or(j, i)))
{}

Touch CommonNormal::detect(const Motion& bi, const Motion& bj, const Points* from) const
{
    Pair p = placed(bi, bj);
    const Vec3 origin = bj.r + bj.A * j.position;
    Outcome end{};
    if (from != nullptr) {
        p.a_i = i.to_surface(from->c_i), p.a_j = j.to_surface(from->c_j);
        end = solve(p, origin);
        if (end.trouble == nullptr) return end.touch;
    } else {
        for (int projections : {0, 1, 3, 10, 30}) {
            begin(p, projections);
            end = solve(p, origin);
            if (end.trouble == nullptr) return end.touch;
        }
    }
    std::ostringstream what;
    what << "no touch of two surfaces: " << end.trouble;
    if (end.touch.n.allFinite()) what << ", least sum of their curvatures " << least(end.touch) << " 1/m";
    what << "; correction " << end.correction << " m, gap " << end.touch.gap << " m, after " << end.iterations
         << " iterations";
    throw lie::NumericalFailure("contact_not_converged", what.str());
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
    Touch& touch = end.touch;
    touch.C_i = origin + at_i.x, touch.C_j = origin + at_j.x;
    touch.n = n;
    touch.gap = n.dot(at_i.x - at_j.x);
    touch.K_i = at_i.shape_operator(), touch.K_j = at_j.shape_operator();

    const Mat32 T = tangent_basis(n);
    const Mat2 K_i = T.transpose() * touch.K_i * T, K_j = T.transpose() * touch.K_j * T;
    if (!std::isfinite(correction))
        end.trouble = "the surfaces do not curve away from each other";
    else if (!(correction <= converged * small))
        end.trouble = "Newton's method did not converge";
    else if (!(at_i.n.dot(n) < -0.5))
        end.trouble = "the normals are not opposite";
    else if (!positive_definite(K_i + K_j + touch.gap * K_i * K_j))
        end.trouble = "the surfaces do not curve away from each other";
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

void CommonNormal::begin(Pair& p, int projections) const
{
    if (projections == 0 && i.surface->convex() && j.surface->convex())
        turn_normal(p);
    else
        alternate(p, projections);
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

/// From the centre of one surface to the nearest point of the other, from there to the point that faces it, and so
/// on. A plane has no centre, and of the others the hollow or the larger one is met first.
void CommonNormal::alternate(Pair& p, int projections) const
{
    const auto rank = [](const Surface& s) {
        return s.size() == 0 ? INFINITY : s.size() * (s.sigma() < 0 ? 1e3 : 1);
    };
    const bool i_first = rank(*i.surface) > rank(*j.surface);
    const Surface &a = i_first ? *i.surface : *j.surface, &b = i_first ? *j.surface : *i.surface;
    const Placed &at_a = i_first ? p.i : p.j, &at_b = i_first ? p.j : p.i;
    Vec3 &a_a = i_first ? p.a_i : p.a_j, &a_b = i_first ? p.a_j : p.a_i;
    a_b.setZero();
    for (int k = 0; k < std::max(projections, 1); ++k) {
        const Vec3 x_b = at_b.origin + at_b.axes * a_b;
        a_a = a.project(at_a.axes.transpose() * (x_b - at_a.origin));
        const Vec3 x_a = at_a.origin + at_a.axes * a_a, n = at_a.axes * a.normal(a_a);
        a_b = facing(b, at_b.axes.transpose() * (x_a - at_b.origin), at_b.axes.transpose() * n);
    }
}

std::unique_ptr<Detector> common_normal(const Shape& i, const Shape& j)
{
    return std::make_unique<EitherOrder>(i, j);
}

}  // namespace hilda::contact
