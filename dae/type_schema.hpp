// SPDX-License-Identifier: GPL-3.0-or-later
/// The part of the schema of model files that describes one type of constraint or force.

#pragma once

#include <string>
#include <vector>

namespace hilda::dae {

/// A key of a type. model_schema() makes "NAME": {"description": DESCRIPTION, REST} of it.
struct KeySchema {
    std::string name, description;
    std::string rest;       ///< further members of the JSON object: type, limits, default, examples
    bool required = false;  ///< whether every object of the type has the key
};

/// Schema of the objects of one type
struct TypeSchema {
    std::string description;  ///< complete sentences, with the number of rows
    /// Shared definitions: "points", "axes", "derivatives". The keys body_i and body_j of "pair" are included,
    /// unless the type has "on_one_body".
    std::vector<std::string> parts = {};
    std::vector<KeySchema> keys = {};  ///< the keys besides name, type, bodies and those of `parts`
    std::string example;               ///< members of a JSON object, without "type"
};

}  // namespace hilda::dae
