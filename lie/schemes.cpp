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
    const auto require = [&](bool Scheme::*supports, const std::string& what) {
        if (this->*supports) return;
        std::string names;
        for (const Scheme& s : schemes())
            if (s.*supports) names += (names.empty() ? "" : ", ") + s.name;
        reject("integrator " + name, "does not support " + what + "; integrators that do are " + names, name);
    };
    const Rows& rows = system.pattern();
    if (!rows.algebraic.empty()) require(&Scheme::algebraic, "evolving contacts");
    if (!rows.regularised.empty()) require(&Scheme::regularised, "implicit friction");
    if (rows.velocity_rows > 0) require(&Scheme::nonholonomic, "rolling without slip");
    if (system.keeps_redundant_rows()) {
        require(&Scheme::redundant, "redundant rows (\"redundant\": \"keep\" in the model file)");
        if (settings.linear_solver == LinearSolver::klu)
            reject(
                "integrator " + name,
                "redundant rows (\"redundant\": \"keep\" in the model file) need the condensed linear solver",
                "klu");
    }
    return construct(system, settings);
}

}  // namespace hilda::lie

template class hilda::io::Registry<hilda::lie::Scheme>;
