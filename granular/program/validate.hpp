// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda-granular NAME: a validation instead of a case.

#pragma once

#include "granular/validations/validation.hpp"

namespace hilda::granular {

/// The validation of this name, unless a file has it; nullptr where there is none
const Validation* find_validation(const std::string& name);

/// "; validations: A, B", what may stand where a file is looked for in vain
std::string known_validations();

/// Runs it and prints its tables and checks on stdout; an exit code. DeviceError
int validate(const Validation& validation, ValidationOptions options, bool quiet);

}  // namespace hilda::granular
