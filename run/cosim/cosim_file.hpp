// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of a co-simulation file (JSON): a model, a granular case, and the bodies that move boundaries.

#pragma once

#include "io/json_source.hpp"
#include "lie/so3.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

/// A body and the boundary that it moves
struct CosimPair {
    std::string body, boundary;
    lie::Vec3 r = lie::Vec3::Zero();  ///< Boundary::r relative to the centre of mass, body frame [m]
    std::string place;                ///< of its entry, for messages
};

struct CosimFile {
    io::JsonSource source;
    std::string name = {};
    std::string model = {}, granular_case = {};  ///< paths, or the name of a built-in model
    long substeps = 1;                           ///< k = H/h
    double end = 0;                              ///< [s]
    std::optional<double> interval = {};         ///< time between rows of the mechanism [s]
    std::string integrator = {};
    std::vector<CosimPair> pairs = {};
};

/// Reads a file. The model and the case must be below its folder unless `allow_paths`. Throws
/// io::InvalidInput with file, line, column and JSON pointer.
CosimFile read_cosim(const std::string& path, const std::vector<std::string>& set = {},
                     bool allow_paths = false);

/// The JSON schema of co-simulation files
io::Json cosim_schema();

/// Whether a path is that of a JSON file with the key "hilda_cosim"
bool is_cosim_file(const std::string& path);

}  // namespace hilda::run
