// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/setting_options.hpp"

#include "io/option_values.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

/// Names of lie::LinearSolver, in its order
const std::vector<std::string> solvers = {"auto", "klu", "condensed"};

lie::LinearSolver linear_solver(const std::string& option, const std::string& text)
{
    const auto at = std::find(solvers.begin(), solvers.end(), text);
    if (at == solvers.end()) io::refuse_option(option, "must be auto, klu or condensed", text);
    return static_cast<lie::LinearSolver>(at - solvers.begin());
}

double absolute_tolerance(const std::string& option, const std::string& text)
{
    const double value = io::finite_number_in(text);
    if (!(value >= 1e-14 && value <= 0.1))
        io::refuse_option(option, "must be a number from 1e-14 to 0.1", text);
    return value;
}

}  // namespace

double relative_tolerance(const std::string& option, const std::string& text)
{
    const double value = io::finite_number_in(text);
    if (!(value >= 1e-14 && value <= 0.1))
        io::refuse_option(option, "must be a number from 1e-14 (limit of double precision) to 0.1", text);
    return value;
}

const std::vector<SettingOption>& setting_options()
{
    using Text = const std::string&;
    using io::Json;
    static const std::vector<SettingOption> all = {
        {"--tolerance", "EPS", "bound on the last Newton correction [m, rad, kg m]; default: 1e-10",
         [](auto& s, Text option, Text text) { s.tolerance = io::positive_number(option, text); },
         [](const auto& s) { return Json(s.tolerance); }},
        {"--max-iterations", "N",
         "largest number of Newton corrections of a step, before it fails; default: 30",
         [](auto& s, Text option, Text text) { s.max_iterations = io::positive_count(option, text); },
         [](const auto& s) { return Json(s.max_iterations); }},
        {"--linear-solver", "auto|klu|condensed",
         "solver of the saddle-point system; default: auto, the one with fewer operations",
         [](auto& s, Text option, Text text) { s.linear_solver = linear_solver(option, text); },
         [](const auto& s) { return Json(solvers[static_cast<size_t>(s.linear_solver)]); }},
        {"--rho-infinity", "RHO",
         "spectral radius of rA-genalpha at infinite frequency, from 0 (strongest "
         "damping) to 1 (no damping); default: 0.8",
         [](auto& s, Text option, Text text) { s.rho_infinity = io::fraction(option, text); },
         [](const auto& s) { return Json(s.rho_infinity); }},
        {"--reparametrise", "",
         "change the body frame when Euler angles approach a singular orientation, instead of stopping",
         [](auto& s, Text, Text) { s.reparametrise = true; },
         [](const auto& s) { return Json(s.reparametrise); }},
        {"--rtol", "RTOL",
         "relative local error tolerance of adaptive steps (rA-dp-5, rA-dop853, rA-radau-5, ida-rp), 1e-14 "
         "to 0.1; "
         "default: 1e-10",
         [](auto& s, Text option, Text text) { s.rtol = relative_tolerance(option, text); },
         [](const auto& s) { return Json(s.rtol); }, true},
        {"--atol", "ATOL",
         "absolute local error tolerance of adaptive steps, 1e-14 to 0.1; default: that of --rtol",
         [](auto& s, Text option, Text text) { s.atol = absolute_tolerance(option, text); },
         [](const auto& s) { return s.atol > 0 && s.atol != s.rtol ? Json(s.atol) : Json("as rtol"); },
         true}};
    return all;
}

std::string SettingOption::key() const
{
    std::string key = name.substr(2);
    std::replace(key.begin(), key.end(), '-', '_');
    return key;
}

std::string SettingOption::text(const lie::Settings& settings) const
{
    const io::Json v = value(settings);
    if (const std::string* const word = v.string()) return *word;
    if (const double* const number = v.number()) return io::shortest(*number);
    return kind.empty() ? "" : io::written(v);
}

bool SettingOption::is_default(const lie::Settings& settings) const
{
    return io::written(value(settings)) == io::written(value({}));
}

RunSettings given_settings(const lie::Settings& settings, bool adaptive)
{
    RunSettings given;
    for (const SettingOption& option : setting_options())
        if ((adaptive || !option.adaptive) && !option.is_default(settings))
            given[option.name] = option.text(settings);
    return given;
}

RunSettings with_defaults(RunSettings settings)
{
    for (const SettingOption& option : setting_options())
        if (!option.kind.empty()) settings.try_emplace(option.name, option.text({}));
    return settings;
}

io::Json settings_json(const lie::Settings& settings, bool adaptive)
{
    io::Json all = io::Json::object();
    for (const SettingOption& option : setting_options())
        if (adaptive || !option.adaptive) all[option.key()] = option.value(settings);
    return all;
}

}  // namespace hilda::run
