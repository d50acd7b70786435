// SPDX-License-Identifier: GPL-3.0-or-later
/// Import of models: URDF by liburdfdom, MJCF by MuJoCo. Each reader is a module that the program loads.

#pragma once

#include "run/importing/imported_model.hpp"

#include <string>

namespace hilda::run {

struct ImportOptions {
    std::string file;               ///< of the type of its root element, robot (URDF) or mujoco (MJCF)
    std::string output;             ///< the model file; empty: NAME.json, with the name of `file`
    bool free_base = false;         ///< the first body without a joint is free; else it is fixed
    bool balances_inertia = false;  ///< see ImportedModel
    bool contacts = false;          ///< rigid contacts of the collision geometries
    bool force = false;             ///< replace `output`
};

/// Writes the model file, and prints what it has and what was not imported. Returns the exit code.
///
/// Throws io::InvalidInput "FILE: ..." for a file that cannot be imported or is of no known type,
/// io::NotAvailable without the module of its type, io::IoError.
int import_model(const ImportOptions& options);

}  // namespace hilda::run

// Functions of the modules. They throw io::InvalidInput.
extern "C" void hilda_import_urdf(const std::string& file, bool free_base, hilda::run::ImportedModel& to);
extern "C" void hilda_import_mjcf(const std::string& file, bool free_base, hilda::run::ImportedModel& to);
