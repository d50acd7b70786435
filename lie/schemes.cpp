// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/schemes.hpp"

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"
#include "lie/tree/tree.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hilda::lie {

const Scheme& scheme(const std::string& name)
{
    if (const Scheme* found = io::Registry<Scheme>::find(name)) return *found;
    std::string names;
    for (const Scheme& s : schemes()) names += (names.empty() ? "" : ", ") + s.name;
    reject("lie::scheme", "an integrator must be one of " + names, name);
}

std::vector<std::string> Scheme::option_names() const
{
    std::vector<std::string> names = uses;
    for (const SchemeOption& own : options) names.push_back(own.option.name);
    return names;
}

bool Scheme::uses_option(const std::string& option) const
{
    const std::vector<std::string> names = option_names();
    return std::find(names.begin(), names.end(), option) != names.end();
}

bool Scheme::takes(const System& system) const
{
    return supports.contains(features_of(system)) && (!needs_tree || system.tree().refusal.empty());
}

std::unique_ptr<Integrator> Scheme::make(const System& system, const Settings& settings) const
{
    const Features missing = features_of(system).without(supports);
    for (const auto& [feature, key, text] : all_features()) {
        if (!missing.contains(feature)) continue;
        std::string names;
        for (const Scheme& s : schemes())
            if (s.supports.contains(feature)) names += (names.empty() ? "" : ", ") + s.name;
        reject("integrator " + name,
               "does not support " + std::string(text) + "; integrators that do are " + names, name);
    }
    if (needs_tree && !system.tree().refusal.empty())
        throw InvalidInput("integrator " + name +
                           " integrates trees of joints only: " + system.tree().refusal);
    if (system.keeps_redundant_rows() && settings.linear_solver == LinearSolver::klu)
        reject("integrator " + name,
               "redundant rows (\"redundant\": \"keep\" in the model file) need the condensed linear solver",
               "klu");
    Settings complete = settings;
    for (const SchemeOption& own : options) {
        const double value = complete.of_scheme.try_emplace(own.option.name, own.default_value).first->second;
        if (!std::isfinite(value)) reject("integrator " + name, own.option.name + " must be finite", value);
    }
    return construct(system, complete);
}

namespace {

/// Whether two schemes mean the same option
bool same(const SchemeOption& a, const SchemeOption& b)
{
    return a.option.value == b.option.value && a.option.help == b.option.help &&
           a.option.scope == b.option.scope && a.default_value == b.default_value;
}

}  // namespace

bool add_scheme(Scheme scheme)
{
    for (const SchemeOption& own : scheme.options) {
        const std::string& option = own.option.name;
        if (!option.starts_with("--") || option.size() < 3)
            throw std::logic_error("integrator " + scheme.name +
                                   ": the name of an option must begin with --, got " + option);
        for (const Scheme& other : schemes())
            for (const SchemeOption& there : other.options)
                if (there.option.name == option && !same(own, there))
                    throw std::logic_error("integrators " + scheme.name + " and " + other.name + " declare " +
                                           option + " in two ways");
    }
    return io::Registry<Scheme>::add(std::move(scheme));
}

}  // namespace hilda::lie

template class hilda::io::Registry<hilda::lie::Scheme>;
