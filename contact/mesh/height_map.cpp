// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/mesh/height_map.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace hilda::contact {

namespace {

using Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd, Eigen::Vector4d;

constexpr const char* where = "contact::HeightMap";
constexpr int min_samples = 4;           // samples in each direction, required by a cubic
constexpr double edge_tolerance = 1e-9;  // allowed distance outside the grid, in cells (rounding)
constexpr double tolerance = 1e-9;       // of the step, relative to the size; convergence is quadratic

/// The n + 2 coefficients c of the not-a-knot cubic spline through n samples f. With δ² the central second
/// difference and m_i = δ²c_i, which is Δx² f'' at sample i,
///
///     c_i + m_i / 6 = f_i,   m_(i-1) + 4 m_i + m_(i+1) = 6 δ²f_i   0 < i < n - 1
///     m_0 - 2 m_1 + m_2 = 0, likewise at the other end             not-a-knot
///
/// The second and the third equation give m_1 = δ²f_1 directly. The remaining system is tridiagonal.
VectorXd spline(const VectorXd& f)
{
    const Eigen::Index n = f.size();
    VectorXd m = VectorXd::Zero(n), pivot = VectorXd::Constant(n, 4);
    for (Eigen::Index i = 1; i < n - 1; ++i) m[i] = f[i - 1] - 2 * f[i] + f[i + 1];
    // right-hand sides of rows 2..n-3; m_1 and m_(n-2) are known
    for (Eigen::Index i = 2; i < n - 2; ++i) m[i] *= 6;
    if (n > 4) m[2] -= m[1], m[n - 3] -= m[n - 2];
    for (Eigen::Index i = 3; i < n - 2; ++i) pivot[i] -= 1 / pivot[i - 1], m[i] -= m[i - 1] / pivot[i - 1];
    for (Eigen::Index i = n - 3; i > 1; --i) m[i] = (m[i] - (i < n - 3 ? m[i + 1] : 0)) / pivot[i];
    m[0] = 2 * m[1] - m[2];
    m[n - 1] = 2 * m[n - 2] - m[n - 3];

    VectorXd c(n + 2);
    c.segment(1, n) = f - m / 6;
    c[0] = m[0] + 2 * c[1] - c[2];
    c[n + 1] = m[n - 1] + 2 * c[n] - c[n - 1];
    return c;
}

MatrixXd checked_coefficients(const MatrixXd& heights)
{
    for (const Eigen::Index samples : {heights.rows(), heights.cols()})
        if (samples < min_samples)
            lie::reject(where, "a height map needs at least 4 samples in each direction", samples);
    if (!heights.allFinite()) lie::reject(where, "the heights must be finite", "a value that is not finite");
    MatrixXd along_x(heights.rows() + 2, heights.cols()), c(heights.rows() + 2, heights.cols() + 2);
    for (Eigen::Index j = 0; j < heights.cols(); ++j) along_x.col(j) = spline(heights.col(j));
    for (Eigen::Index i = 0; i < c.rows(); ++i) c.row(i) = spline(along_x.row(i).transpose()).transpose();
    return c;
}

Vector2d checked_corner(const Vector2d& corner)
{
    if (!corner.allFinite()) lie::reject(where, "the corner must be finite", corner.transpose());
    return corner;
}

Vector2d checked_spacing(const Vector2d& spacing)
{
    for (const double d : {spacing.x(), spacing.y()}) positive(where, "the spacing of a height map", d);
    return spacing;
}

std::string point(const char* before, const Vec3& a)
{
    std::ostringstream what;
    what.precision(6);
    what << before << " (" << a.x() << ", " << a.y() << ", " << a.z() << ")";
    return what.str();
}

/// The four uniform cubic B-splines of a cell and their first and second derivatives, at u in [0, 1]
struct Basis {
    Vector4d B, B1, B2;

    explicit Basis(double u)
    {
        const double v = 1 - u;
        B = Vector4d(v * v * v, 4 - 3 * u * u * (1 + v), 4 - 3 * v * v * (1 + u), u * u * u) / 6;
        B1 = Vector4d(-v * v, u * (3 * u - 4), v * (4 - 3 * v), u * u) / 2;
        B2 = Vector4d(v, 3 * u - 2, 3 * v - 2, u);
    }
};

}  // namespace

HeightMap::HeightMap(const MatrixXd& heights, const Vector2d& corner, const Vector2d& spacing)
    : corner(checked_corner(corner)), spacing(checked_spacing(spacing)), c(checked_coefficients(heights)),
      length(0.5 * extent().minCoeff())
{}

Vector2d HeightMap::extent() const
{
    return spacing.cwiseProduct(
        Vector2d(static_cast<double>(c.rows() - 3), static_cast<double>(c.cols() - 3)));
}

HeightMap::Height HeightMap::at(const Vector2d& x) const
{
    const Vector2d s = (x - corner).cwiseQuotient(spacing);
    const auto cell = [](double s_k, Eigen::Index coefficients) {
        return std::clamp(static_cast<Eigen::Index>(s_k), Eigen::Index{0}, coefficients - 4);
    };
    const Eigen::Index i = cell(s.x(), c.rows()), j = cell(s.y(), c.cols());
    const Basis u(s.x() - static_cast<double>(i)), v(s.y() - static_cast<double>(j));
    const Eigen::Matrix4d C = c.block<4, 4>(i, j);
    const Vector4d Cv = C * v.B, Cv1 = C * v.B1;
    Height h;
    h.f = u.B.dot(Cv);
    h.gradient = Vector2d(u.B1.dot(Cv), u.B.dot(Cv1)).cwiseQuotient(spacing);
    h.hessian(0, 0) = u.B2.dot(Cv) / (spacing.x() * spacing.x());
    h.hessian(0, 1) = h.hessian(1, 0) = u.B1.dot(Cv1) / (spacing.x() * spacing.y());
    h.hessian(1, 1) = u.B.dot(C * v.B2) / (spacing.y() * spacing.y());
    return h;
}

Surface::Derivatives HeightMap::derivatives(const Vec3& a) const
{
    if (!a.allFinite()) return {NAN, Vec3::Constant(NAN), Mat3::Constant(NAN)};
    const Vector2d beyond =
        ((a.head<2>() - corner - 0.5 * extent()).cwiseAbs() - 0.5 * extent()).cwiseQuotient(spacing);
    if (!(beyond.maxCoeff() <= edge_tolerance))
        throw lie::NumericalFailure("nonfinite",
                                    point("a height map is not defined outside its grid: point", a));
    const Height h = at(a.head<2>());
    Derivatives d{a.z() - h.f, Vec3(-h.gradient.x(), -h.gradient.y(), 1), Mat3::Zero()};
    d.hessian.topLeftCorner<2, 2>() = -h.hessian;
    return d;
}

/// The closest sample; only samples no farther from a than the point of the surface above or below a are
/// examined. That point is returned if no sample is closer.
Vector2d HeightMap::nearest_sample(const Vec3& a) const
{
    const Vector2d upper = corner + extent();
    Vector2d best = a.head<2>().cwiseMax(corner).cwiseMin(upper);
    double least = (a - Vec3(best.x(), best.y(), at(best).f)).squaredNorm();
    const double reach = std::sqrt(least);
    Eigen::Index first[2], last[2];
    for (int k = 0; k < 2; ++k) {
        const double most = extent()[k] / spacing[k];
        first[k] = static_cast<Eigen::Index>(
            std::clamp(std::ceil((a[k] - reach - corner[k]) / spacing[k]), 0.0, most));
        last[k] = static_cast<Eigen::Index>(
            std::clamp(std::floor((a[k] + reach - corner[k]) / spacing[k]), 0.0, most));
    }
    for (Eigen::Index i = first[0]; i <= last[0]; ++i)
        for (Eigen::Index j = first[1]; j <= last[1]; ++j) {
            const Vector2d x =
                corner + spacing.cwiseProduct(Vector2d(static_cast<double>(i), static_cast<double>(j)));
            const double distance = (a - Vec3(x.x(), x.y(), at(x).f)).squaredNorm();
            if (distance < least) least = distance, best = x;
        }
    return best;
}

/// Newton's method for the minimum of E = |x - a|²/2 over (x, y), with line search and restricted to the
/// grid:
///
///     ∂E = x - a + (f - a_z) ∇f,   ∂²E = I + ∇f ∇fᵀ + (f - a_z) ∇²f
Vec3 HeightMap::project(const Vec3& a) const
{
    if (!a.allFinite())
        throw lie::NumericalFailure("nonfinite",
                                    point("the projection onto a height map needs a finite point, got", a));
    constexpr int most = 100;
    constexpr double negligible_step = 1e-6;  // relative step below which rounding of E hides the decrease
    const Vector2d upper = corner + extent();
    const auto energy = [&](const Vector2d& x, double f) {
        return 0.5 * ((x - a.head<2>()).squaredNorm() + (f - a.z()) * (f - a.z()));
    };
    Vector2d x = nearest_sample(a);
    Height h = at(x);
    for (int k = 0; k < most; ++k) {
        const Vector2d slope = x - a.head<2>() + (h.f - a.z()) * h.gradient;
        Eigen::Matrix2d M = Eigen::Matrix2d::Identity() + h.gradient * h.gradient.transpose();
        if (const Eigen::Matrix2d exact = M + (h.f - a.z()) * h.hessian;
            exact.determinant() > 0 && exact.trace() > 0)
            M = exact;  // otherwise the Gauss-Newton matrix: ∂²E is not positive definite
        Vector2d step = -(M.inverse() * slope);
        const double before = energy(x, h.f);
        Vector2d next = x;
        for (int half = 0; half < 40; ++half, step *= 0.5) {
            next = (x + step).cwiseMax(corner).cwiseMin(upper);
            h = at(next);
            if (step.norm() <= negligible_step * length || energy(next, h.f) <= before) break;
        }
        const double correction = step.norm(), moved = (next - x).norm();
        x = next;
        if (correction <= tolerance * length) return {x.x(), x.y(), h.f};
        if (moved <= tolerance * length) break;  // stopped by the edge of the grid
    }
    throw lie::NumericalFailure(
        "contact_not_converged",
        point("the closest point of a height map lies on the edge of its grid: point", a));
}

namespace {

const bool registered_height_map = io::Registry<SurfaceType>::add(
    {.name = "height-map",
     .schema =
         {.description = "Terrain z = f(x, y) through samples on a regular grid, interpolated by a bicubic "
                         "spline with continuous second derivatives. The material is below. A contact "
                         "outside of the grid stops the run with an error.",
          .examples = {R"("heights": [[0, 0, 0, 0], [0, 0.1, 0.1, 0], [0, 0.1, 0.1, 0], [0, 0, 0, 0]], )"
                       R"("spacing": [0.5, 0.5], "corner": [-0.75, -0.75])"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const MatrixXd heights = read_rows(
             o, "heights", {},
             {"Samples of z [m]: row i and column j belong to x = corner[0] + i spacing[0] and y = corner[1] "
              "+ j spacing[1] of the surface frame. At least 4 rows of equal length, at least 4 columns.",
              "[[0, 0, 0, 0], [0, 0.1, 0.1, 0], [0, 0.1, 0.1, 0], [0, 0, 0, 0]]",
              R"("minItems": 4, "items": {"type": "array", "items": {"type": "number"}, "minItems": 4})"});
         if (std::min(heights.rows(), heights.cols()) < min_samples)
             o.fail("heights", "heights must have at least 4 rows of at least 4 numbers, got " +
                                   std::to_string(heights.rows()) + " of " + std::to_string(heights.cols()));
         const std::vector<double> spacing =
             o.numbers("spacing", 2,
                       {"Distance of the samples along x and y [m].", "[0.5, 0.5]",
                        R"("items": {"type": "number", "exclusiveMinimum": 0})"});
         if (!(spacing[0] > 0 && spacing[1] > 0))
             o.fail("spacing", "spacing must be positive, got " + dae::described(*o.find("spacing")));
         Vector2d corner = Vector2d::Zero();
         if (o.given("corner"))
             corner = Vector2d::Map(
                 o.numbers("corner", 2,
                           {"Coordinates x and y of the first sample [m], in the surface frame.",
                            "[-0.75, -0.75]", R"("default": [0, 0])"})
                     .data());
         else
             o.record("corner", dae::Json{0.0, 0.0});
         return std::make_shared<HeightMap>(heights, corner, Vector2d(spacing[0], spacing[1]));
     }});

}  // namespace

}  // namespace hilda::contact
