// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study.hpp"

#include "io/error.hpp"
#include "lie/schemes.hpp"

#include <algorithm>
#include <utility>

namespace hilda::studies {

namespace {

using Maker = std::vector<Study> (*)();

std::vector<Maker>& makers()
{
    static std::vector<Maker> all;
    return all;
}

/// Whether a scheme uses an option of lie::Settings
bool uses(const lie::Scheme& scheme, const std::string& option)
{
    if (option == "--rtol" || option == "--atol") return scheme.adaptive;
    if (option == "--max-iterations") return !scheme.adaptive || scheme.formulation == "rA";
    if (option == "--rho-infinity") return scheme.rho_infinity;
    if (option == "--reparametrise") return scheme.formulation == "reps";
    return true;
}

}  // namespace

void refuse_unused_settings(const std::string& where, const std::vector<std::string>& given,
                            const std::vector<const lie::Scheme*>& schemes)
{
    for (const std::string& option : given) {
        if (std::any_of(schemes.begin(), schemes.end(),
                        [&](const lie::Scheme* scheme) { return uses(*scheme, option); }))
            continue;
        std::string users;
        for (const lie::Scheme& scheme : lie::schemes())
            if (uses(scheme, option) || uses(scheme.with_adaptive_steps(), option))
                users += (users.empty() ? "" : ", ") + scheme.name;
        throw io::UsageError(where + ": no selected integrator uses " + option + "; it is for " + users);
    }
}

const std::vector<Study>& studies()
{
    while (!makers().empty())  // a maker may load a module that registers others
        for (const Maker make : std::exchange(makers(), {}))
            for (Study& study : make()) io::Registry<Study>::add(std::move(study));
    return io::Registry<Study>::all();
}

bool register_studies(Maker make)
{
    makers().push_back(make);
    return true;
}

}  // namespace hilda::studies

template class hilda::io::Registry<hilda::studies::Study>;
