// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda check: validates a model and prints its properties without a simulation.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

struct CheckOptions {
    std::string model;             ///< name of a built-in model, or path of a model file
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    std::string normal_rows;       ///< of contact constraints: tangent or fixed-xy; "": the model's
    bool fix_initial = false;      ///< also report the change by the projection onto the constraints
    std::string write;             ///< file for the model with the projected initial state; "": none
    bool json = false, quiet = false;
};

/// Prints the numbers of bodies, constraints, forces and contacts, the rank of the constraints, the initial
/// residuals, the energy and the largest reactions. Returns the exit code. Writes the file
/// `write` only, which implies fix_initial. lie::InvalidInput for an invalid model.
int check_model(const CheckOptions& options);

}  // namespace hilda::studies
