// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/settings.hpp"

#include "lie/schemes.hpp"
#include "run/recording/setting_options.hpp"
#include "run/watch/run_check.hpp"

namespace hilda::python {

lie::Settings settings_of(const std::string& command, const lie::Scheme& scheme,
                          const std::map<std::string, std::string>& values, bool has_step,
                          std::optional<double> interval)
{
    lie::Settings settings;
    std::vector<std::string> given;
    for (const run::SettingOption& option : run::setting_options())
        if (const auto value = values.find(option.name.substr(2)); value != values.end()) {
            option.set(settings, option.name, value->second);
            given.push_back(option.name);
        }
    run::check_step_options(scheme, given, has_step, interval);
    run::refuse_unused_settings(command, given, {&scheme});
    return settings;
}

}  // namespace hilda::python
