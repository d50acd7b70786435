// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/recommended_integrator.hpp"

#include "dae/model.hpp"
#include "lie/schemes.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

Recommendation recommended_integrator(const dae::Model& model, const lie::State& x, int degrees_of_freedom)
{
    using lie::LoadEvaluation;
    if (model.has_cones())
        return {run::default_integrator_of(model),
                "rigid contacts: joints, friction and impacts are solved together in each step"};
    const auto& constraints = model.general_constraints();
    if (std::any_of(constraints.begin(), constraints.end(),
                    [](const auto& c) { return c->algebraic_variables() > 0; }))
        return {run::default_integrator,
                "contact constraints: second order in the motion and in the normal force"};
    if (degrees_of_freedom == 0)
        return {"rA-rkmk-4",
                "no degrees of freedom: positions, velocities and constraint forces are exact at every step"};

    const dae::Model::StableStep limit = model.stable_step(x, lie::scheme(run::default_integrator)),
                                 contacts = model.stable_step(x, LoadEvaluation::implicit);
    // Implicit integrators remove the limits of springs, and not those of contacts.
    const bool stiff = limit.h < run::default_step &&
                       std::isinf(model.force_of(limit.force)->stable_step(x, LoadEvaluation::implicit));
    if (stiff && model.keep_redundant)
        return {
            "rA-full-1-exact",
            fmt::format("stiff: {} limits the step of explicit integrators to {:.2g} s; rA-full-1-exact is "
                        "implicit and takes redundant rows",
                        model.force_of(limit.force)->label(), limit.h)};
    if (stiff)
        return {"rp-bdf2",
                fmt::format("stiff: {} limits the step of explicit integrators to {:.2g} s; rp-bdf2 "
                            "and ida-rp are implicit{}",
                            model.force_of(limit.force)->label(), limit.h,
                            model.force_of(limit.force)->may_be_implicit()
                                ? fmt::format(", and {} has no limit for a force with \"implicit\": true",
                                              run::default_integrator)
                                : "")};
    if (contacts.force >= 0)
        return {
            run::default_integrator,
            fmt::format("compliant contacts: second order between their events; steps up to {:.2g} s, the "
                        "limit of {}",
                        limit.h, model.force_of(limit.force)->label())};
    return {
        run::default_integrator,
        "smooth motion: second order in positions, velocities and constraint forces, no drift of the energy"};
}

}  // namespace hilda::studies
