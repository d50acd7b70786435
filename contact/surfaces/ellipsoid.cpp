// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/ellipsoid.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

namespace hilda::contact {

Ellipsoid::Ellipsoid(const Vec3& semi_axes, bool concave)
    : semi_axes(positive("contact::Ellipsoid", "a semi-axis of an ellipsoid", semi_axes)), concave(concave),
      L(std::cbrt(semi_axes.prod())), curvature(L * semi_axes.cwiseAbs2().cwiseInverse())
{}

std::optional<Vec3> Ellipsoid::support(const Vec3& u) const
{
    const Vec3 Du = semi_axes.cwiseProduct(u);
    return Vec3(semi_axes.cwiseProduct(Du) / Du.norm());
}

/// The closest point is x_k = s_k² a_k / (s_k² + t) with the largest root t of Σ (s_k a_k / (s_k² + t))² = 1.
/// For t > -s², with s the shortest semi-axis, the sum is decreasing and convex, so Newton's method converges
/// monotonically from any t left of the root. The unknown is τ = t + s², which keeps its relative accuracy
/// near the centre of the ellipsoid, where t is close to -s². If there is no root τ > 0, two points are
/// closest, and one is returned.
Vec3 Ellipsoid::project(const Vec3& a) const
{
    int shortest = 0;
    const double s = semi_axes.minCoeff(&shortest);
    const Vec3 above = (semi_axes.array() - s) * (semi_axes.array() + s);
    const Vec3 sa = semi_axes.cwiseProduct(a.cwiseAbs());
    double tau = std::max((sa - above).maxCoeff(), 0.0);  // t + s²

    constexpr int max_iterations = 100;
    for (int k = 0; k < max_iterations; ++k) {
        double sum = -1, slope = 0;
        for (int m = 0; m < 3; ++m) {
            if (sa[m] == 0) continue;
            const double ratio = sa[m] / (above[m] + tau);
            sum += ratio * ratio;
            slope -= 2 * ratio * ratio / (above[m] + tau);
        }
        if (!(sum > 0)) break;
        const double before = tau;
        tau -= sum / slope;
        if (!(tau > before)) break;
    }

    Vec3 x = Vec3::Zero();
    for (int m = 0; m < 3; ++m)
        if (sa[m] != 0) x[m] = semi_axes[m] * semi_axes[m] * a[m] / (above[m] + tau);
    if (tau == 0) x[shortest] = s * std::sqrt(std::max(0.0, 1 - x.cwiseQuotient(semi_axes).squaredNorm()));
    return x;
}

namespace {

const bool registered_ellipsoid = io::Registry<SurfaceType>::add(
    {.name = "ellipsoid",
     .schema = {.description = "Ellipsoid with its centre at the origin of the surface frame.",
                .examples = {R"("semi_axes": [2.5, 3, 2], "concave": true)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const Vec3 semi_axes = read_semi_axes(o);
         return std::make_shared<Ellipsoid>(semi_axes, read_concave(o));
     }});

}  // namespace

}  // namespace hilda::contact
