// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/integrator.hpp"

#include <algorithm>

namespace hilda::lie {

namespace {

// Built on first use: files enrol their schemes before main, in an order nobody fixes.
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
    const auto refuse_unless = [&](bool Scheme::*takes, const std::string& what) {
        if (this->*takes) return;
        std::string names;
        for (const Scheme& s : schemes())
            if (s.*takes) names += (names.empty() ? "" : ", ") + s.name;
        reject("integrator " + name, "takes no " + what + "; those that do are " + names, name);
    };
    const Rows& rows = system.pattern();
    if (!rows.algebraic.empty()) refuse_unless(&Scheme::algebraic, "contacts that evolve");
    if (!rows.regularised.empty())
        refuse_unless(&Scheme::regularised, "friction in the equations of its step");
    if (rows.velocity_rows > 0) refuse_unless(&Scheme::nonholonomic, "rolling without slip");
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
