// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda-granular NAME: runs a validation.

#pragma once

#include "granular/validations/validation.hpp"

namespace hilda::granular {

/// The validation with this name; nullptr if there is none or if a file with this name exists
const Validation* find_validation(const std::string& name);

/// Runs the validation, prints its tables and checks on stdout and returns the exit code. The warnings of the
/// watch go to stderr; with `strict` they are a failure. Throws DeviceError.
int validate(const Validation& validation, ValidationOptions options, bool quiet, bool strict);

}  // namespace hilda::granular
