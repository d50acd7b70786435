// SPDX-License-Identifier: GPL-3.0-or-later
/// The grains of a co-simulation in this process.

#pragma once

#include "granular/cosim/soil.hpp"
#include "run/cosim/cosim_file.hpp"

#include <memory>

namespace hilda::run {

/// Reads the case of the file, which ends at `end` [s]. `options` need no file. The tables and meshes of the
/// case must be below its folder unless `allow_paths`. Throws io::InvalidInput and io::IoError.
std::unique_ptr<granular::Soil> local_grains(const CosimFile& file, double end, granular::RunOptions options,
                                             bool allow_paths);

/// Names of the boundaries of all pairs
std::vector<std::string> boundaries(const CosimFile& file);

}  // namespace hilda::run
