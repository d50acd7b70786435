// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/superquadric.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr const char* in_superquadric = "contact::Superquadric";

/// Above 100 the edges are too sharp: a contact point moves along them by large steps.
bool exponent_allowed(double p) { return p >= 2 && p <= 100; }

double checked_exponent(double p)
{
    if (!exponent_allowed(p))
        lie::reject(in_superquadric, "an exponent of a superquadric must be between 2 and 100", p);
    return p;
}

}  // namespace

Superquadric::Superquadric(const Vec3& semi_axes, double p, double q)
    : semi_axes(positive(in_superquadric, "a semi-axis of a superquadric", semi_axes)),
      p(checked_exponent(p)), q(checked_exponent(q)), L(std::cbrt(semi_axes.prod())),
      scale(L / std::max(p, q))
{}

double Superquadric::value(const Vec3& a) const
{
    double sum = -1;
    for (int k = 0; k < 3; ++k) sum += std::pow(std::abs(a[k]) / semi_axes[k], exponent(k));
    return scale * sum;
}

Vec3 Superquadric::gradient(const Vec3& a) const
{
    Vec3 g;
    for (int k = 0; k < 3; ++k) {
        const double e = exponent(k), x = std::abs(a[k]) / semi_axes[k];
        g[k] = std::copysign(scale * e * std::pow(x, e - 1) / semi_axes[k], a[k]);
    }
    return g;
}

Mat3 Superquadric::hessian(const Vec3& a) const
{
    Vec3 diagonal;
    for (int k = 0; k < 3; ++k) {
        const double e = exponent(k), x = std::abs(a[k]) / semi_axes[k];
        diagonal[k] = scale * e * (e - 1) * std::pow(x, e - 2) / (semi_axes[k] * semi_axes[k]);
    }
    return diagonal.asDiagonal();
}

/// ∇G parallel to u means e_k |x_k/s_k|^(e_k - 1) = exp(m) s_k |u_k| / L, with the exponents e_k and the
/// semi-axes s_k. The logarithm of the sum in G is a convex, increasing function of m with slopes between 1
/// and 2, so Newton's method converges to its root from any start, in one step if p = q.
std::optional<Vec3> Superquadric::support(const Vec3& u) const
{
    double m = 0;
    Vec3 x;  // |x_k / s_k|
    constexpr int max_iterations = 30;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
        double sum = 0, slope = 0;
        for (int k = 0; k < 3; ++k) {
            const double e = exponent(k);
            x[k] = std::pow(std::exp(m) * semi_axes[k] * std::abs(u[k]) / (e * L), 1 / (e - 1));
            const double term = std::pow(x[k], e);
            sum += term;
            slope += term * e / (e - 1);
        }
        const double step = -std::log(sum) * sum / slope;
        m += step;
        if (std::abs(step) < 1e-15) break;
    }
    for (int k = 0; k < 3; ++k) x[k] = std::copysign(semi_axes[k] * x[k], u[k]);
    return x;
}

namespace {

const bool registered_superquadric = io::Registry<SurfaceType>::add(
    {.name = "superquadric",
     .schema = {.description =
                    "Superquadric |x/a|^p + |y/b|^p + |z/c|^q = 1: an ellipsoid for p = q = 2; a box "
                    "with rounded edges for large p and q.",
                .examples = {R"("semi_axes": [0.3, 0.2, 0.1], "exponent": 8, "exponent_z": 4)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const Vec3 semi_axes = read_semi_axes(o);
         const auto exponent = [&](const char* key, const io::About& about,
                                   std::optional<double> fallback = {}) {
             const double p = o.number(key, about, fallback);
             if (!exponent_allowed(p))
                 o.fail(key, std::string(key) + " must be between 2 and 100, got " + dae::shortest(p));
             return p;
         };
         constexpr const char* range = R"("minimum": 2, "maximum": 100)";
         const double p = exponent("exponent", {"Exponent p in the x-y plane [-].", "8", range});
         return std::make_shared<Superquadric>(
             semi_axes, p,
             exponent("exponent_z",
                      {.text = "Exponent q along z [-]. By default equal to exponent.",
                       .example = "2",
                       .rest = range,
                       .computed = true},
                      p));
     }});

}  // namespace

}  // namespace hilda::contact
