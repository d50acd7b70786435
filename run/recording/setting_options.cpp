// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/setting_options.hpp"

#include "io/option_values.hpp"
#include "lie/schemes.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

using Text = const std::string&;

/// Names of lie::LinearSolver, in its order
const std::vector<std::string> solvers = {"auto", "klu", "condensed"};

lie::LinearSolver linear_solver(Text option, Text text)
{
    const auto at = std::find(solvers.begin(), solvers.end(), text);
    if (at == solvers.end()) io::refuse_option(option, "must be auto, klu or condensed", text);
    return static_cast<lie::LinearSolver>(at - solvers.begin());
}

double absolute_tolerance(Text option, Text text)
{
    const double value = io::finite_number_in(text);
    if (!(value >= 1e-14 && value <= 0.1))
        io::refuse_option(option, "must be a number from 1e-14 to 0.1", text);
    return value;
}

/// An option of the member of lie::Settings, with the function that reads its value
template <class Value, class Read>
SettingOption option_of(Value lie::Settings::*member, const std::string& name, const std::string& value,
                        const std::string& help, Read read)
{
    return {{.name = name, .value = value, .help = help, .scope = io::Scope::numerical},
            [member, read](lie::Settings& s, Text option, Text text) { s.*member = read(option, text); },
            [member](const lie::Settings& s) { return io::Json(s.*member); }};
}

/// The options of several schemes
std::vector<SettingOption> common_options()
{
    const auto given = [](Text, Text) { return true; };
    std::vector<SettingOption> all = {
        option_of(&lie::Settings::tolerance, "--tolerance", "EPS",
                  "bound on the last Newton correction [m, rad, kg m]; default: 1e-10", io::positive_number),
        option_of(&lie::Settings::max_iterations, "--max-iterations", "N",
                  "largest number of Newton corrections of a step, before it fails; default: 30",
                  io::positive_count),
        {{.name = "--linear-solver",
          .value = "auto|klu|condensed",
          .help = "solver of the saddle-point system; default: auto, the one with fewer operations",
          .scope = io::Scope::numerical},
         [](lie::Settings& s, Text option, Text text) { s.linear_solver = linear_solver(option, text); },
         [](const lie::Settings& s) { return io::Json(solvers[static_cast<size_t>(s.linear_solver)]); }},
        option_of(&lie::Settings::rho_infinity, "--rho-infinity", "RHO",
                  "spectral radius at infinite frequency, from 0 (strongest damping) to 1 (no damping); "
                  "default: 0.8",
                  io::fraction),
        option_of(
            &lie::Settings::reparametrise, "--reparametrise", "",
            "change the body frame when Euler angles approach a singular orientation, instead of stopping",
            given),
        option_of(&lie::Settings::rtol, "--rtol", "RTOL",
                  "relative local error tolerance of adaptive steps, 1e-14 to 0.1; default: 1e-10",
                  relative_tolerance),
        option_of(&lie::Settings::atol, "--atol", "ATOL",
                  "absolute local error tolerance of adaptive steps, 1e-14 to 0.1; default: that of --rtol",
                  absolute_tolerance)};
    all.back().get = [](const lie::Settings& s) {
        return s.atol > 0 && s.atol != s.rtol ? io::Json(s.atol) : io::Json("as rtol");
    };
    all.push_back(option_of(&lie::Settings::max_step, "--max-step", "H",
                            "longest step of adaptive steps [s]; default: no limit", io::positive_number));
    all.back().get = [](const lie::Settings& s) {
        return s.max_step > 0 ? io::Json(s.max_step) : io::Json("no limit");
    };
    return all;
}

/// The option of schemes that declare it
SettingOption option_of_scheme(const lie::SchemeOption& own)
{
    const std::string name = own.option.name;
    const bool is_switch = own.option.is_switch();
    return {own.option,
            [name, is_switch, check = own.option.check](lie::Settings& s, Text option, Text text) {
                if (check != nullptr) check(option, text);
                s.of_scheme[name] = is_switch ? 1 : io::number(option, text);
            },
            [name, is_switch, otherwise = own.default_value](const lie::Settings& s) {
                const auto given = s.of_scheme.find(name);
                const double value = given == s.of_scheme.end() ? otherwise : given->second;
                return is_switch ? io::Json(value != 0) : io::Json(value);
            }};
}

/// Names of the schemes that use an option, with fixed or with adaptive steps
std::vector<std::string> users_of(const std::string& option)
{
    std::vector<std::string> names;
    for (const lie::Scheme& scheme : lie::schemes())
        if (scheme.uses_option(option) || scheme.with_adaptive_steps().uses_option(option))
            names.push_back(scheme.name);
    return names;
}

/// The first names, and the number of the others
std::string listed(const std::vector<std::string>& names, size_t most)
{
    std::string text;
    for (size_t k = 0; k < std::min(names.size(), most); ++k) text += (k == 0 ? "" : ", ") + names[k];
    return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " others" : text;
}

}  // namespace

double relative_tolerance(Text option, Text text)
{
    const double value = io::finite_number_in(text);
    if (!(value >= 1e-14 && value <= 0.1))
        io::refuse_option(option, "must be a number from 1e-14 (limit of double precision) to 0.1", text);
    return value;
}

std::vector<SettingOption> setting_options()
{
    std::vector<SettingOption> all = common_options();
    const size_t common = all.size();
    for (const lie::Scheme& scheme : lie::schemes())
        for (const lie::SchemeOption& own : scheme.options) {
            const auto known = std::find_if(all.begin(), all.end(), [&](const SettingOption& other) {
                return other.name == own.option.name;
            });
            if (known == all.end())
                all.push_back(option_of_scheme(own));
            else if (known < all.begin() + static_cast<std::ptrdiff_t>(common))
                throw std::logic_error("integrator " + scheme.name + " declares " + own.option.name +
                                       ", which is an option of all integrators");
        }
    constexpr size_t few = 8;
    for (SettingOption& option : all)
        if (const std::vector<std::string> users = users_of(option.name); users.size() <= few)
            option.help += "; for " + listed(users, few);
    return all;
}

std::string SettingOption::text(const lie::Settings& settings) const
{
    const io::Json v = get(settings);
    if (const std::string* const word = v.string()) return *word;
    if (const double* const number = v.number()) return io::shortest(*number);
    return is_switch() ? "" : io::written(v);
}

bool SettingOption::is_default(const lie::Settings& settings) const
{
    return io::written(get(settings)) == io::written(get({}));
}

RunSettings given_settings(const lie::Settings& settings, const lie::Scheme& scheme)
{
    RunSettings given;
    for (const SettingOption& option : setting_options())
        if (option.scope == io::Scope::numerical && scheme.uses_option(option.name) &&
            !option.is_default(settings))
            given[option.name] = option.text(settings);
    return given;
}

RunSettings with_defaults(RunSettings settings)
{
    for (const SettingOption& option : setting_options())
        if (!option.is_switch() && option.scope == io::Scope::numerical)
            settings.try_emplace(option.name, option.text({}));
    return settings;
}

io::Json settings_json(const lie::Settings& settings, const lie::Scheme* scheme)
{
    io::Json all = io::Json::object();
    for (const SettingOption& option : setting_options())
        if (scheme == nullptr || scheme->uses_option(option.name)) all[option.key()] = option.get(settings);
    return all;
}

void refuse_unused_settings(const std::string& where, const std::vector<std::string>& given,
                            const std::vector<const lie::Scheme*>& schemes)
{
    for (const SettingOption& option : setting_options()) {
        if (std::find(given.begin(), given.end(), option.name) == given.end() ||
            std::any_of(schemes.begin(), schemes.end(),
                        [&](const lie::Scheme* scheme) { return scheme->uses_option(option.name); }))
            continue;
        throw io::UsageError(where + ": no selected integrator uses " + option.name + "; it is for " +
                             listed(users_of(option.name), 8));
    }
}

}  // namespace hilda::run
