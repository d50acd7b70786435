// SPDX-License-Identifier: GPL-3.0-or-later
/// The text of hilda help outputs: columns of the tables of a run, with unit and meaning.

#pragma once

#include <string>

namespace hilda::studies {

/// Columns of trajectory.csv, contacts.csv, forces.csv and outputs.csv for a model with one entity of each
/// kind. The names in capitals stand for those of the model.
std::string columns_help();

}  // namespace hilda::studies
