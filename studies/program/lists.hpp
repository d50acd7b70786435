// SPDX-License-Identifier: GPL-3.0-or-later
/// What there is: hilda models, hilda integrators, hilda study.

#pragma once

#include <string>

namespace hilda::studies {

int list_models(bool json);
/// The JSON of a built-in model, to a file or, for "", to stdout
int write_model(const std::string& name, const std::string& file);
int list_integrators(bool json);
int list_studies(bool json);

}  // namespace hilda::studies
