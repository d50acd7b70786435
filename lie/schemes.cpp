// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/schemes.hpp"

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <stdexcept>

namespace hilda::lie {

namespace {

// A local static: the schemes are registered before main(), in an unspecified order of the translation units.
std::vector<Scheme>& list()
{
    static std::vector<Scheme> schemes;
    return schemes;
}

}  // namespace

const std::vector<Scheme>& schemes() { return list(); }

const Scheme& scheme(const std::string& name)
{
    std::string names;
    for (const Scheme& s : schemes()) {
        if (s.name == name) return s;
        names += (names.empty() ? "" : ", ") + s.name;
    }
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
    return construct(system, settings);
}

bool register_scheme(Scheme scheme)
{
    std::vector<Scheme>& all = list();
    const auto at = std::lower_bound(all.begin(), all.end(), scheme,
                                     [](const Scheme& a, const Scheme& b) { return a.name < b.name; });
    if (at != all.end() && at->name == scheme.name)
        throw std::logic_error("two schemes are called " + scheme.name);
    all.insert(at, std::move(scheme));
    return true;
}

}  // namespace hilda::lie
