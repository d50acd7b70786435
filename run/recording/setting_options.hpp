// SPDX-License-Identifier: GPL-3.0-or-later
/// The options that set lie::Settings, in one table. The command lines, their help, the identity of
/// checkpoints and of the jobs of a study, the settings in summary.json and study.json, and the keywords of
/// Python come from it.

#pragma once

#include "io/json.hpp"
#include "lie/settings.hpp"
#include "run/recording/run_settings.hpp"

#include <string>
#include <vector>

namespace hilda::run {

struct SettingOption {
    std::string name;  ///< --max-iterations
    std::string kind;  ///< of its value: N; "" for a switch
    std::string what;  ///< for the help
    /// Sets the value from the text. io::UsageError if it is not valid.
    void (*set)(lie::Settings& settings, const std::string& option, const std::string& text);
    io::Json (*value)(const lie::Settings& settings);
    bool adaptive = false;  ///< used with adaptive steps only

    /// max_iterations: the key in JSON
    std::string key() const;
    /// The value as the option takes it; "" for a switch
    std::string text(const lie::Settings& settings) const;
    /// Whether the value is that of a run without the option
    bool is_default(const lie::Settings& settings) const;
};

/// All of them. Results depend on each one.
const std::vector<SettingOption>& setting_options();

/// The settings that are not the defaults, by option: what checkpoints and the jobs of a study record
RunSettings given_settings(const lie::Settings& settings, bool adaptive);
/// The settings of a run with the default values of the options that are not among them, for comparisons
RunSettings with_defaults(RunSettings settings);
/// All settings with their values, by key; those of adaptive steps only for such a run
io::Json settings_json(const lie::Settings& settings, bool adaptive);

/// A relative tolerance: 1e-14 <= value <= 0.1. Smaller tolerances are below the rounding errors of double
/// precision.
double relative_tolerance(const std::string& option, const std::string& text);

}  // namespace hilda::run
