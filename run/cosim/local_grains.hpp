// SPDX-License-Identifier: GPL-3.0-or-later
/// The grains of a co-simulation in this process.

#pragma once

#include "granular/cosim/soil.hpp"
#include "run/cosim/cosim_file.hpp"

#include <memory>

namespace hilda::run {

/// Reads the case of the file, which ends at `end` [s]. `options` need no file. Throws io::InvalidInput and
/// io::IoError.
std::unique_ptr<granular::Soil> local_grains(const CosimFile& file, double end, granular::RunOptions options);

/// Names of the boundaries of all pairs
std::vector<std::string> boundaries(const CosimFile& file);

}  // namespace hilda::run
