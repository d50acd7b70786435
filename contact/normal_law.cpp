// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal_law.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::contact {

namespace {

void check(const std::string& law, const std::string& what, double value, bool fine)
{
    if (!fine || !std::isfinite(value)) lie::reject("contact::" + law, what, value);
}

// A restitution of zero has an infinite logarithm.
constexpr double least_restitution = 1e-6;

/// Part of the critical damping that leaves a linear spring with this restitution
double damping_ratio(double restitution)
{
    const double log = std::log(std::max(restitution, least_restitution));
    return -log / std::sqrt(std::numbers::pi * std::numbers::pi + log * log);
}

void check_restitution(const std::string& law, double e)
{
    check(law, "the coefficient of restitution must be in [0, 1]", e, e >= 0 && e <= 1);
}

void check_mass(const std::string& law, double m)
{
    check(law, "the mass for the damping must be positive, or 0 for that of the pair", m, m >= 0);
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

Hooke Hooke::rebounding(double stiffness, double restitution, double m)
{
    check_restitution("Hooke", restitution);
    check_mass("Hooke", m);
    Hooke law(stiffness, 0);
    law.zeta = damping_ratio(restitution);
    law.m = m;
    return law;
}

double Hooke::damping(const Pressing& p) const { return c + 2 * zeta * std::sqrt((m > 0 ? m : p.m) * k); }

double Hooke::force(const Pressing& p) const
{
    return p.overlap > 0 ? k * p.overlap + damping(p) * p.overlap_rate : 0;
}

Hertz::Hertz(double E_star, double restitution, double m)
    : E_star(E_star), beta(damping_ratio(restitution)), m(m)
{
    check("Hertz", "the effective modulus must be positive", E_star, E_star > 0);
    check_restitution("Hertz", restitution);
    check_mass("Hertz", m);
}

double Hertz::stiffness(const Pressing& p) const
{
    return p.overlap > 0 ? 2 * E_star * std::sqrt(p.overlap / p.curvature) : 0;
}

double Hertz::damping(const Pressing& p) const
{
    return 2 * std::sqrt(5. / 6) * beta * std::sqrt(stiffness(p) * (m > 0 ? m : p.m));
}

double Hertz::force(const Pressing& p) const
{
    if (!(p.overlap > 0)) return 0;
    return 2. / 3 * stiffness(p) * p.overlap + damping(p) * p.overlap_rate;
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
