// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::contact {

namespace {

void check(const std::string& law, const std::string& what, double value, bool valid)
{
    if (!valid || !std::isfinite(value)) lie::reject("contact::" + law, what, value);
}

// e = 0 would require infinite damping.
constexpr double least_restitution = 1e-6;

/// -ln e as a function of ζ, see damping_ratio(); by its expansion near ζ = 1
double restitution_exponent(double zeta)
{
    const double x = 1 - zeta * zeta;
    if (std::abs(x) < 1e-8) return 2 * zeta * (1 + (1 - zeta) / 3);
    return 2 * zeta * (x > 0 ? std::acos(zeta) / std::sqrt(x) : std::acosh(zeta) / std::sqrt(-x));
}

void check_mass(const std::string& law, double m)
{
    check(law, "the mass for the damping must be positive, or 0 for the effective mass of the pair", m,
          m >= 0);
}

}  // namespace

GivenForce::GivenForce(double N) : N(N)
{
    check("GivenForce", "a given normal force must not be negative", N, N >= 0);
}

Hooke::Hooke(double stiffness, double damping) : k(stiffness), c(damping)
{
    check("Hooke", "the normal stiffness must be positive", k, k > 0);
    check("Hooke", "the normal damping must not be negative", c, c >= 0);
}

Hooke Hooke::with_restitution(double stiffness, double restitution, double m)
{
    check_mass("Hooke", m);
    Hooke law(stiffness, 0);
    law.zeta = damping_ratio(restitution);
    law.m = m;
    return law;
}

double Hooke::damping(const NormalInput& p) const { return c + 2 * zeta * std::sqrt((m > 0 ? m : p.m) * k); }

double Hooke::force(const NormalInput& p) const
{
    return p.overlap > 0 ? k * p.overlap + damping(p) * p.overlap_rate : 0;
}

Hertz::Hertz(double E_star, double restitution, double m)
    : E_star(E_star), zeta(damping_ratio(restitution)), m(m)
{
    check("Hertz", "the effective modulus must be positive", E_star, E_star > 0);
    check_mass("Hertz", m);
}

Hertz Hertz::of_free_oscillation(double E_star, double restitution, double m)
{
    Hertz law(E_star, restitution, m);
    const double log = std::log(std::max(restitution, least_restitution));
    law.zeta = -log / std::sqrt(std::numbers::pi * std::numbers::pi + log * log);
    return law;
}

double Hertz::stiffness(const NormalInput& p) const
{
    return p.overlap > 0 ? 2 * E_star * std::sqrt(p.overlap / p.curvature) : 0;
}

double Hertz::damping(const NormalInput& p) const
{
    return 2 * std::sqrt(5. / 6) * zeta * std::sqrt(stiffness(p) * (m > 0 ? m : p.m));
}

double Hertz::force(const NormalInput& p) const
{
    if (!(p.overlap > 0)) return 0;
    return 2. / 3 * stiffness(p) * p.overlap + damping(p) * p.overlap_rate;
}

double damping_ratio(double e)
{
    check("damping_ratio", "the coefficient of restitution must be in [0, 1]", e, e >= 0 && e <= 1);
    const double target = -std::log(std::max(e, least_restitution));
    double lower = 0, upper = 1e4;
    for (int k = 0; k < 200 && lower < upper; ++k) {
        const double middle = 0.5 * (lower + upper);
        if (middle == lower || middle == upper) break;
        (restitution_exponent(middle) < target ? lower : upper) = middle;
    }
    return lower;
}

double effective_modulus(double E_i, double nu_i, double E_j, double nu_j)
{
    for (const double E : {E_i, E_j})
        check("effective_modulus", "Young's modulus must be positive", E, E > 0);
    for (const double nu : {nu_i, nu_j})
        check("effective_modulus", "Poisson's ratio must be in (-1, 0.5]", nu, nu > -1 && nu <= 0.5);
    return 1 / ((1 - nu_i * nu_i) / E_i + (1 - nu_j * nu_j) / E_j);
}

}  // namespace hilda::contact
