// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/paraboloid.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

namespace hilda::contact {

namespace {

double radius(double R) { return positive("contact::Paraboloid", "a radius of a paraboloid", R); }

}  // namespace

Paraboloid::Paraboloid(double R_x, double R_y, bool concave)
    : R_x(radius(R_x)), R_y(radius(R_y)), concave(concave), curvature(1 / R_x, 1 / R_y, 0)
{}

/// The closest point is x_k = R_k a_k / (R_k + t), z = a_z + t with the largest root t of
///
///     Σ R_k a_k² / 2(R_k + t)² - a_z - t = 0
///
/// For t > -s, with s the smaller radius, the left side is decreasing and convex, so Newton's method
/// converges monotonically from any t left of the root. The unknown is τ = t + s, as for the ellipsoid. If
/// there is no root τ > 0, which happens near the axis beyond the centre of curvature, two points are
/// closest, and one is returned.
Vec3 Paraboloid::project(const Vec3& a) const
{
    const double R[2] = {R_x, R_y}, s = std::min(R_x, R_y);
    const int tight = R_x <= R_y ? 0 : 1;
    const double height = a.z() - s;
    double tau = std::max(-height, 0.0);
    for (int m = 0; m < 2; ++m) {
        if (a[m] == 0) continue;
        // The root of the equation with one term of the sum only is left of the root. Squares are avoided
        // because they may underflow.
        const double above = R[m] - s, rest = height - above;
        double start = std::cbrt(R[m] / 4) * std::pow(std::abs(a[m]), 2.0 / 3);
        if (rest > 0) start = std::min(start, std::abs(a[m]) * std::sqrt(R[m] / (4 * rest)));
        tau = std::max(tau, start - above);
    }

    constexpr int max_iterations = 100;
    for (int k = 0; k < max_iterations; ++k) {
        double sum = -height - tau, slope = -1;
        for (int m = 0; m < 2; ++m) {
            if (a[m] == 0) continue;
            const double ratio = a[m] / (R[m] - s + tau);
            sum += 0.5 * R[m] * ratio * ratio;
            slope -= R[m] * ratio * ratio / (R[m] - s + tau);
        }
        if (!(sum > 0)) break;
        const double before = tau;
        tau -= sum / slope;
        if (!(tau > before)) break;
    }

    Vec3 x(0, 0, height + tau);
    for (int m = 0; m < 2; ++m)
        if (a[m] != 0) x[m] = R[m] * a[m] / (R[m] - s + tau);
    if (tau == 0) {
        const double across = x[1 - tight];
        x[tight] = std::sqrt(std::max(0.0, s * (2 * x.z() - across * across / R[1 - tight])));
    }
    return x;
}

namespace {

const bool registered_paraboloid = io::Registry<SurfaceType>::add(
    {.name = "paraboloid",
     .schema = {.description =
                    "Paraboloid z = (x^2/R_x + y^2/R_y)/2 with its vertex at the origin of the surface "
                    "frame. It opens along z.",
                .examples = {R"("radii": [1, 1.5], "concave": true)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const std::vector<double> R =
             o.numbers("radii", 2,
                       {"Radii of curvature R_x and R_y at the vertex [m].", "[1, 1.5]",
                        R"("items": {"type": "number", "exclusiveMinimum": 0})"});
         if (!(R[0] > 0 && R[1] > 0))
             o.fail("radii", "radii must be positive, got " + dae::described(*o.find("radii")));
         return std::make_shared<Paraboloid>(R[0], R[1], read_concave(o));
     },
     .z = "axis"});

}  // namespace

}  // namespace hilda::contact
