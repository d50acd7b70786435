// SPDX-License-Identifier: GPL-3.0-or-later
/// The model file: JSON in and out, with the place of every error.

#pragma once

#include "dae/start.hpp"

#include <span>

namespace hilda::dae {

/// What a model file says. The model is ready for start(); x is the start as given in the file.
struct Description {
    std::string name;
    double end = 1;  ///< [s], where a run stops unless told otherwise
    std::unique_ptr<Model> model;
    State x;
    std::string text;  ///< the model as read, in one form: JSON with defaults filled in and --set applied
    std::vector<std::string> warnings;          ///< one line each, with the place
    std::vector<std::string> constraint_place;  ///< "FILE:LINE:COL (/constraints/3)" of each constraint
    std::vector<std::string> force_place;       ///< the same of each force of the model
    std::vector<std::string> contact_place;     ///< the same of each of Model::evolving()
};

/// Reads a model file. `file` is its name in messages. Each of `set` is "/json/pointer=VALUE" (VALUE is JSON,
/// or else taken as a string) and changes one entry, or adds a key, before the model is built.
///
/// Throws lie::InvalidInput "FILE:LINE:COL (/json/pointer): what is wrong, the value given" for everything
/// that is not a model: syntax, unknown, missing and duplicate keys, types, ranges, names, expressions.
Description read_model(std::string_view text, const std::string& file, std::span<const std::string> set = {});

/// The same from a regular file of at most 64 MiB. One that cannot be read is InvalidInput too, without a
/// line.
Description load_model(const std::string& path, std::span<const std::string> set = {});

/// start(), with the place in the file in front of what it refuses.
StartReport start(Description& description, const StartOptions& options = {});

}  // namespace hilda::dae
