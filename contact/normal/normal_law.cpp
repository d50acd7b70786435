// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "contact/normal/check.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::contact {

namespace {

/// -ln e as a function of ζ, see damping_ratio(); by its expansion near ζ = 1
double restitution_exponent(double zeta)
{
    const double x = 1 - zeta * zeta;
    if (std::abs(x) < 1e-8) return 2 * zeta * (1 + (1 - zeta) / 3);
    return 2 * zeta * (x > 0 ? std::acos(zeta) / std::sqrt(x) : std::acosh(zeta) / std::sqrt(-x));
}

}  // namespace

double damping_ratio(double e)
{
    check_parameter("damping_ratio", "the coefficient of restitution must be in [0, 1]", e, e >= 0 && e <= 1);
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
        check_parameter("effective_modulus", "Young's modulus must be positive", E, E > 0);
    for (const double nu : {nu_i, nu_j})
        check_parameter("effective_modulus", "Poisson's ratio must be in (-1, 0.5]", nu,
                        nu > -1 && nu <= 0.5);
    return 1 / ((1 - nu_i * nu_i) / E_i + (1 - nu_j * nu_j) / E_j);
}

}  // namespace hilda::contact
