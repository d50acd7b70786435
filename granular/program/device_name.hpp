// SPDX-License-Identifier: GPL-3.0-or-later
/// Names of devices.

#pragma once

#include "granular/backend/engine.hpp"

#include <optional>
#include <string>

namespace hilda::granular {

/// The device "cpu", "cuda" or "cuda:N"; nothing for another name
std::optional<Device> device_named(const std::string& name);

}  // namespace hilda::granular
