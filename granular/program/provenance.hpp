// SPDX-License-Identifier: GPL-3.0-or-later
/// What ran: the part of a summary that may differ between two runs of the same case.

#pragma once

#include <nlohmann/json.hpp>

namespace hilda::granular {

/// "hilda-granular VERSION (git state)"
std::string version_line();

nlohmann::ordered_json provenance(const std::string& command_line, int threads, const std::string& device);

}  // namespace hilda::granular
