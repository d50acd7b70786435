// SPDX-License-Identifier: GPL-3.0-or-later
/// Changes of a case before it is read: old names, --set and other options, seeds, intervals that are kept.

#pragma once

#include "io/json_source.hpp"

#include <array>
#include <string>

namespace hilda::granular {

/// A change of one entry of a case: "/json/pointer=VALUE", and the option that gave it, for messages. In the
/// pointer the name of a boundary or an insertion can stand for its number.
struct Setting {
    std::string change, origin = {};
};

/// A JSON pointer, or a change of an entry, with the number of a boundary or insertion in place of its name
std::string with_numbers(const io::Json& root, const std::string& pointer);

/// Old names of keys of a case, which are still read, and their names
inline const std::array<std::array<std::string, 2>, 3> renamed_keys = {
    {{"every", "interval"}, {"frames_every", "frame_interval"}, {"checkpoint_every", "checkpoint_interval"}}};

struct Environment;

/// The text of a case with the changes of an environment: old names, settings, seeds and intervals that are
/// kept. Throws io::PlacedError.
io::JsonSource changed_source(const std::string& text, const std::string& file,
                              const Environment& environment);

}  // namespace hilda::granular
