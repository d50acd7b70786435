// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/schemes.hpp"

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"

namespace hilda::lie {

const Scheme& scheme(const std::string& name)
{
    if (const Scheme* found = io::Registry<Scheme>::find(name)) return *found;
    std::string names;
    for (const Scheme& s : schemes()) names += (names.empty() ? "" : ", ") + s.name;
    reject("lie::scheme", "an integrator must be one of " + names, name);
}

std::unique_ptr<Integrator> Scheme::make(const System& system, const Settings& settings) const
{
    const Features missing = features_of(system).without(takes);
    for (const auto& [feature, key, text] : all_features()) {
        if (!missing.contains(feature)) continue;
        std::string names;
        for (const Scheme& s : schemes())
            if (s.takes.contains(feature)) names += (names.empty() ? "" : ", ") + s.name;
        reject("integrator " + name,
               "does not support " + std::string(text) + "; integrators that do are " + names, name);
    }
    if (system.keeps_redundant_rows() && settings.linear_solver == LinearSolver::klu)
        reject("integrator " + name,
               "redundant rows (\"redundant\": \"keep\" in the model file) need the condensed linear solver",
               "klu");
    return construct(system, settings);
}

}  // namespace hilda::lie

template class hilda::io::Registry<hilda::lie::Scheme>;
