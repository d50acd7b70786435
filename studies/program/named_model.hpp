// SPDX-License-Identifier: GPL-3.0-or-later
/// Models by the name or path that the command line gives.

#pragma once

#include <span>
#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}

namespace hilda::studies {

bool is_built_in(const std::string& name);

/// True if the text is the path of a model file: it contains a slash, or ends in .json, or is not the name of
/// a built-in model and such a file exists.
bool is_model_path(const std::string& name_or_path);

/// Reads a model file, or a built-in model if the text is not a path (is_model_path()). `set`: changes of the
/// form /json/pointer=VALUE. lie::InvalidInput as in read_model() and problem().
dae::Description named_model(const std::string& name_or_path, std::span<const std::string> set);

/// The changes `set`, followed by /contacts/K/normal/rows=ROWS for each contact constraint K of the model,
/// where `rows` is tangent or fixed-xy. Returns `set` if `rows` is "". io::UsageError if the model has no contact
/// constraint.
std::vector<std::string> normal_rows(const std::string& name_or_path, const std::vector<std::string>& set,
                                     const std::string& rows);

/// Name of the output directory below out/: the name of the file without .json, or of the built-in model
std::string short_name(const std::string& name_or_path);

}  // namespace hilda::studies
