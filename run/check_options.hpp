// SPDX-License-Identifier: GPL-3.0-or-later
/// Options of the command hilda check.

#pragma once

#include <string>
#include <vector>

namespace hilda::run {

struct CheckOptions {
    std::string model;             ///< name of a built-in model, or path of a model file
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    std::string normal_rows;       ///< of contact constraints: tangent or fixed-xy; "": the model's
    bool allow_paths = false;      ///< files that a file names need not be below its folder
    bool fix_initial = false;      ///< also report the change by the projection onto the constraints
    std::string write;             ///< file for the model with the projected initial state; "": none
    bool json = false, quiet = false;
};

}  // namespace hilda::run
