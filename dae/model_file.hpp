// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of model files (JSON). Error messages give the location in the file.

#pragma once

#include "dae/model.hpp"
#include "dae/outputs/event.hpp"
#include "dae/start.hpp"

#include <span>

namespace hilda::io {
class SchemaRecorder;
}

namespace hilda::dae {

/// The content of a model file. The model is complete and ready for start(). x holds the initial data as
/// given in the file.
struct Description {
    std::string name;
    double end = 1;  ///< default end time of a run [s]
    std::unique_ptr<Model> model;
    State x;
    /// Canonical form of the model: JSON with defaults filled in and --set applied, in which expressions of
    /// parameters are replaced by numbers
    std::string text;
    /// Changes of the text by the arguments of the reader: `set`, then /contacts/K/normal/rows=ROWS for each
    /// contact K to which `normal_rows` applies
    std::vector<std::string> changes;
    std::vector<std::unique_ptr<Output>> outputs;
    std::vector<Event> events;
    std::vector<std::pair<std::string, double>> parameters;  ///< names and values in the order of the file
    std::vector<std::string> files;     ///< that were read: the model file, then those that it names
    std::vector<std::string> warnings;  ///< one line each, with the location
    std::vector<std::string>
        constraint_place;                    ///< location "FILE:LINE:COL (/constraints/3)" of each constraint
    std::vector<std::string> force_place;    ///< location of each element of Model::forces()
    std::vector<std::string> general_place;  ///< location of each element of Model::general_constraints()
};

/// Reads a model from a text. `file` is the file name used in messages. Each element of `set` has the form
/// "/json/pointer=VALUE" and changes one value, or adds a key, before the model is built. A VALUE that is not
/// valid JSON is taken as a string. `normal_rows` replaces the key "rows" of all contact constraints: tangent
/// or fixed-xy; "": as in the text. `folder` contains the files that the text names by relative paths;
/// "": the current directory. All files that the text names must be below `within`; "": they may be anywhere.
///
/// Throws lie::InvalidInput "FILE:LINE:COL (/json/pointer): what is wrong, the value given" for invalid
/// syntax, for unknown, missing and duplicate keys, and for invalid types, ranges, names and expressions.
Description read_model(std::string_view text, const std::string& file, std::span<const std::string> set = {},
                       const std::string& normal_rows = "", const std::string& folder = "",
                       const std::string& within = "");

/// Records the keys of a model file for the schema, by reading an example. `name` is that of the example in
/// messages. Throws as read_model().
void record_model(const std::string& example, const std::string& name, io::SchemaRecorder& recorder);

/// Reads a model from a regular file of at most 64 MiB. The files that it names must be below its folder
/// unless `allow_paths`. Throws lie::InvalidInput without a line number if the file cannot be read.
Description load_model(const std::string& path, std::span<const std::string> set = {},
                       const std::string& normal_rows = "", bool allow_paths = false);

/// The canonical form of the model with the positions, orientations and velocities of x as initial data, for
/// example those that start() has projected onto the constraints. Angles, displacements and orientations that
/// a joint, driver or force measures from the start are then measured from x.
std::string text_at(const Description& description, const State& x);

/// Calls start() for the model and adds the location in the file to the messages of its exceptions.
StartReport start(Description& description, const StartOptions& options = {});

}  // namespace hilda::dae
