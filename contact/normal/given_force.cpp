// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "contact/normal/check.hpp"
#include "dae/object_reader.hpp"

namespace hilda::contact {

GivenForce::GivenForce(double N) : N(N)
{
    check_parameter("GivenForce", "a given normal force must not be negative", N, N >= 0);
}

namespace {

std::shared_ptr<const NormalLaw> read_given_force(dae::ObjectReader& o)
{
    return std::make_shared<GivenForce>(o.not_negative("force", {"Normal force N [N].", "9.81"}));
}

const bool registered_given_force = io::Registry<NormalLawType>::add(
    {.name = "given",
     .schema = {.description = "Prescribed constant normal force, independent of the overlap. It models "
                               "surfaces that are pressed together by a known force.",
                .examples = {R"("force": 9.81)"}},
     .read = read_given_force,
     .elastic = false});

}  // namespace

}  // namespace hilda::contact
