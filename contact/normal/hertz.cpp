// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "contact/normal/check.hpp"
#include "dae/object_reader.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::contact {

Hertz::Hertz(double E_star, double restitution, double m)
    : E_star(E_star), zeta(damping_ratio(restitution)), m(m)
{
    check_parameter("Hertz", "the effective modulus must be positive", E_star, E_star > 0);
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

namespace {

double poisson_ratio(dae::ObjectReader& o, std::string_view key, std::string_view text)
{
    const double nu = o.number(key, {text, "0.3", R"("exclusiveMinimum": -1, "maximum": 0.5)"});
    if (!(nu > -1 && nu <= 0.5))
        o.fail(key, std::string(key) + " must be above -1 and at most 0.5, got " + dae::shortest(nu));
    return nu;
}

std::shared_ptr<const NormalLaw> read_hertz(dae::ObjectReader& o)
{
    for (const char* key : {"E_i", "nu_i", "E_j", "nu_j"}) o.exclude("E_star", key);
    double E_star = 0;
    if (o.has("E_i") || o.has("E_j")) {
        const double E_i = o.positive("E_i", {"Young's modulus of body i [Pa].", "7e10"}),
                     nu_i = poisson_ratio(o, "nu_i", "Poisson's ratio of body i [-].");
        const double E_j = o.positive("E_j", {"Young's modulus of body j [Pa].", "2.1e11"}),
                     nu_j = poisson_ratio(o, "nu_j", "Poisson's ratio of body j [-].");
        E_star = effective_modulus(E_i, nu_i, E_j, nu_j);
    } else {
        E_star = o.positive(
            "E_star", {"Effective modulus E* [Pa], 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j.", "1e7"});
    }
    return std::make_shared<Hertz>(E_star, o.fraction("restitution",
                                                      {"Coefficient of restitution e [-]. It determines the "
                                                       "damping c; values below 1e-6 are treated as 1e-6.",
                                                       "0.5"},
                                                      1));
}

const bool registered_hertz = io::Registry<NormalLawType>::add(
    {.name = "hertz",
     .schema =
         {.description =
              "Hertzian contact with damping: N = 4/3 E* sqrt(R) delta^(3/2) + c deltadot for overlap delta "
              "> 0 (Fang 2022, Eq. 2.42). R is the effective radius, 1/R the sum of the mean curvatures of "
              "both surfaces. N is never negative. Give either E_star or all of E_i, nu_i, E_j and nu_j.",
          .examples = {R"("E_star": 1e7, "restitution": 0.5)",
                       R"("E_i": 7e10, "nu_i": 0.3, "E_j": 2.1e11, "nu_j": 0.3)"},
          .rest = R"("oneOf": [{"required": ["E_star"]}, {"required": ["E_i", "nu_i", "E_j", "nu_j"]}])"},
     .read = read_hertz});

}  // namespace

}  // namespace hilda::contact
