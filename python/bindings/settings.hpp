// SPDX-License-Identifier: GPL-3.0-or-later
/// The settings of an integrator that a function of Python receives.

#pragma once

#include "lie/settings.hpp"

#include <map>
#include <optional>
#include <string>

namespace hilda::lie {
struct Scheme;
}

namespace hilda::python {

/// `values`: texts by the names of run::setting_options() without the dashes. `command` is the name in
/// messages. Throws io::UsageError for an invalid value, and for one that the scheme does not use.
lie::Settings settings_of(const std::string& command, const lie::Scheme& scheme,
                          const std::map<std::string, std::string>& values, bool has_step,
                          std::optional<double> interval);

}  // namespace hilda::python
