// SPDX-License-Identifier: GPL-3.0-or-later
/// The lists of models, integrators and studies: hilda models, hilda integrators, hilda study. Each function
/// prints to stdout, as JSON or as text, and returns the exit code.

#pragma once

#include <string>

namespace hilda::studies {

int list_models(bool json);
/// Writes the JSON of a built-in model to a file, to NAME.json in an existing folder, or to stdout if `to` is
/// "". lie::InvalidInput for an unknown name.
int write_model(const std::string& name, const std::string& to);
/// Writes each built-in model to NAME.json in a folder, which is made if it does not exist. io::UsageError
/// for the name of a JSON file.
int write_models(const std::string& folder);
int list_integrators(bool json);
int list_studies(bool json);
/// Prints the schema of model files, or that of co-simulation files
int print_schema(bool of_cosim);

}  // namespace hilda::studies
