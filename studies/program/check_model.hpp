// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda check: what a model is, without running it.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

struct CheckOptions {
    std::string model;             ///< a built-in name or a path
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    std::string normal_rows;       ///< of contacts that are constraints; "": as the model has it
    bool fix_initial = false;      ///< also say what the projection onto the constraints would change
    bool json = false, quiet = false;
};

/// Prints counts, rank, initial residuals, energy and loads; returns the exit code. Writes no file.
int check_model(const CheckOptions& options);

}  // namespace hilda::studies
