// SPDX-License-Identifier: GPL-3.0-or-later
/// Models by the name or path that the user gives.

#pragma once

#include "io/registry.hpp"

#include <span>
#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}

namespace hilda::run {

/// Name and text of a model
struct NamedText {
    std::string name, text;
};

/// A list of models that have names, such as the problems of the studies. A file registers it by
/// io::Registry<ModelSource>::add.
struct ModelSource {
    std::string name;
    /// The model with this name. Throws lie::InvalidInput if there is none.
    NamedText (*find)(const std::string& name);
};

/// Whether a source has a model with this name: a built-in model
bool is_built_in(const std::string& name);

/// True if the text is the path of a model file: it contains a slash, or ends in .json, or is not the name of
/// a built-in model and such a file exists.
bool is_model_path(const std::string& name_or_path);

/// Reads a model file, or a built-in model if the text is not a path (is_model_path()). `set`: changes of the
/// form /json/pointer=VALUE; `normal_rows`: rows of all contact constraints, "": those of the model;
/// `allow_paths`: a model file may name files that are not below its folder.
/// lie::InvalidInput as in read_model() and problem(); io::UsageError if `normal_rows` is given and the model
/// has no contact constraint.
dae::Description named_model(const std::string& name_or_path, std::span<const std::string> set,
                             const std::string& normal_rows, bool allow_paths = false);

/// Name of the output directory below out/: the name of the file without .json, or of the built-in model
std::string short_name(const std::string& name_or_path);

}  // namespace hilda::run
