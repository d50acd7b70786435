// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/recommended_integrator.hpp"

#include "dae/model.hpp"
#include "lie/schemes.hpp"
#include "studies/running/run_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

Recommendation recommended_integrator(const dae::Model& model, const lie::State& x, int degrees_of_freedom)
{
    using lie::LoadEvaluation;
    const auto& constraints = model.general_constraints();
    if (std::any_of(constraints.begin(), constraints.end(),
                    [](const auto& c) { return c->algebraic_variables() > 0; }))
        return {default_integrator,
                "contact constraints: second order in the motion and in the normal force"};
    if (degrees_of_freedom == 0)
        return {"rA-rkmk-4",
                "no degrees of freedom: positions, velocities and constraint forces are exact at every step"};

    const auto name = [&](const dae::Model::StableStep& limit) {
        return model.forces()[static_cast<size_t>(limit.force)]->label();
    };
    const dae::Model::StableStep all = model.stable_step(x, lie::scheme(default_integrator)),
                                 contacts = model.stable_step(x, LoadEvaluation::implicit);
    if (all.h < default_step && all.h < contacts.h)
        return {"rp-bdf2",
                fmt::format("stiff: {} limits the step of explicit integrators to {:.2g} s; rp-bdf2 "
                            "and ida-rp are implicit{}",
                            name(all), all.h,
                            model.forces()[static_cast<size_t>(all.force)]->may_be_implicit()
                                ? fmt::format(", and {} has no limit for a force with \"implicit\": true",
                                              default_integrator)
                                : "")};
    if (contacts.force >= 0)
        return {
            default_integrator,
            fmt::format("compliant contacts: second order between their events; steps up to {:.2g} s, the "
                        "limit of {}",
                        all.h, name(all))};
    return {
        default_integrator,
        "smooth motion: second order in positions, velocities and constraint forces, no drift of the energy"};
}

}  // namespace hilda::studies
