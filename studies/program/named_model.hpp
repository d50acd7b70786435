// SPDX-License-Identifier: GPL-3.0-or-later
/// A model as the command line names it.

#pragma once

#include "dae/model_file.hpp"

#include <span>
#include <string>

namespace hilda::studies {

bool is_built_in(const std::string& name);

/// True for what names a file: with a slash or ending in .json, or no built-in model but there.
bool is_model_path(const std::string& name_or_path);

/// Reads a built-in model by its name, or else the model file at that path. lie::InvalidInput as read_model()
/// and problem().
dae::Description named_model(const std::string& name_or_path, std::span<const std::string> set);

/// The settings `set`, and besides --normal-rows `rows` for each contact whose normal is a constraint; "": none. UsageError
/// where there is no such contact.
std::vector<std::string> normal_rows(const std::string& name_or_path, const std::vector<std::string>& set,
                                     const std::string& rows);

/// The name of its output directory below out/
std::string short_name(const std::string& name_or_path);

}  // namespace hilda::studies
