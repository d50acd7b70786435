// SPDX-License-Identifier: GPL-3.0-or-later
/// The options that set lie::Settings, in one table: those of several schemes, and those that registered
/// schemes declare (lie::Scheme::options). The command lines, their help, the identity of checkpoints and of
/// the jobs of a study, the settings in summary.json and study.json, and the keywords of Python come from it.

#pragma once

#include "io/json.hpp"
#include "io/option_values.hpp"
#include "lie/settings.hpp"
#include "run/recording/run_settings.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

struct SettingOption : io::Option {
    /// Sets the value from the text. io::UsageError if it is not valid.
    std::function<void(lie::Settings& settings, const std::string& option, const std::string& text)> set;
    std::function<io::Json(const lie::Settings& settings)> get;
    /// The value as the option takes it; "" for a switch
    std::string text(const lie::Settings& settings) const;
    /// Whether the value is that of a run without the option
    bool is_default(const lie::Settings& settings) const;
};

/// All of them. The help of an option that few schemes use ends with their names. A plug-in that is loaded
/// later may add some.
std::vector<SettingOption> setting_options();

/// The settings that the scheme uses, on which results depend, and that are not the defaults, by option: what
/// a checkpoint records
RunSettings given_settings(const lie::Settings& settings, const lie::Scheme& scheme);
/// The settings of a run with the default values of the options that are not among them, for comparisons
RunSettings with_defaults(RunSettings settings);
/// The settings with their values, by key: all, or those that a scheme uses
io::Json settings_json(const lie::Settings& settings, const lie::Scheme* scheme = nullptr);

/// io::UsageError "WHERE: ..." if an option of the table that was given is used by none of the schemes; the
/// message names the schemes that use it.
void refuse_unused_settings(const std::string& where, const std::vector<std::string>& given,
                            const std::vector<const lie::Scheme*>& schemes);

/// A relative tolerance: 1e-14 <= value <= 0.1. Smaller tolerances are below the rounding errors of double
/// precision.
double relative_tolerance(const std::string& option, const std::string& text);

}  // namespace hilda::run
