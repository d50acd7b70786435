// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "contact/normal/check.hpp"
#include "dae/object_reader.hpp"

namespace hilda::contact {

Hooke::Hooke(double stiffness, double damping) : k(stiffness), c(damping)
{
    check_parameter("Hooke", "the normal stiffness must be positive", k, k > 0);
    check_parameter("Hooke", "the normal damping must not be negative", c, c >= 0);
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

namespace {

std::shared_ptr<const NormalLaw> read_hooke(dae::ObjectReader& o)
{
    o.exclude("damping", "restitution");
    const double stiffness = o.positive("stiffness", {"Stiffness k [N/m].", "1e5"});
    if (o.has("restitution"))
        return std::make_shared<Hooke>(Hooke::with_restitution(
            stiffness, o.fraction("restitution",
                                  {"Coefficient of restitution e [-]. It determines the damping c from the "
                                   "effective mass of the two bodies; values below 1e-6 are treated as 1e-6.",
                                   "0.5"})));
    return std::make_shared<Hooke>(stiffness,
                                   o.not_negative("damping", {"Damping coefficient c [N s/m].", "10"}, 0));
}

const bool registered_hooke = io::Registry<NormalLawType>::add(
    {.name = "hooke",
     .schema = {.description =
                    "Linear spring and damper: N = k delta + c deltadot for overlap delta > 0 (Fang 2022, "
                    "Eq. 2.41). N is never negative. At most one of damping and restitution may be given.",
                .examples = {R"("stiffness": 1e5, "restitution": 0.5)",
                             R"("stiffness": 1e5, "damping": 10)"}},
     .read = read_hooke});

}  // namespace

}  // namespace hilda::contact
