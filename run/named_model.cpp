// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/named_model.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <filesystem>

namespace hilda::run {

namespace fs = std::filesystem;

namespace {

/// lie::InvalidInput of the last source if none has the model
NamedText built_in_model(const std::string& name)
{
    const std::vector<ModelSource>& sources = io::Registry<ModelSource>::all();
    for (const ModelSource& source : sources) {
        try {
            return source.find(name);
        } catch (const lie::InvalidInput&) {
            if (&source == &sources.back()) throw;
        }
    }
    throw lie::InvalidInput("no model is called '" + name + "'; expected the path of a model file");
}

}  // namespace

bool is_built_in(const std::string& name)
{
    try {
        built_in_model(name);
        return true;
    } catch (const lie::InvalidInput&) {
        return false;
    }
}

bool is_model_path(const std::string& name_or_path)
{
    std::error_code error;
    return name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".json") ||
           (!is_built_in(name_or_path) && fs::exists(name_or_path, error));
}

dae::Description named_model(const std::string& name_or_path, std::span<const std::string> set,
                             const std::string& normal_rows, bool allow_paths)
{
    dae::Description d;
    if (is_model_path(name_or_path)) {
        d = dae::load_model(name_or_path, set, normal_rows, allow_paths);
    } else {
        const NamedText built_in = built_in_model(name_or_path);
        d = dae::read_model(built_in.text, built_in.name, set, normal_rows);
    }
    if (!normal_rows.empty() && d.changes.size() == set.size())
        throw io::UsageError("--normal-rows applies to contacts whose normal is a constraint; model " +
                             d.name + " has none");
    return d;
}

std::string short_name(const std::string& name_or_path)
{
    const fs::path path(name_or_path);
    const std::string name = path.extension() == ".json" ? path.stem() : path.filename();
    return name.empty() || name == "." || name == ".." ? "model" : name;
}

}  // namespace hilda::run
