// SPDX-License-Identifier: GPL-3.0-or-later
/// The force laws of the program: their names, and their keys in the schema of cases.

#pragma once

#include "io/schema/schema_recorder.hpp"

namespace hilda::granular {

/// The names of the laws of a kind, which is a key of the case file: normal, tangential, rolling, spin or
/// cohesion
std::vector<std::string> law_names(const std::string& kind);

/// Records the keys that each law reads, and the conditions of an entry of `laws` on several keys. Returns
/// the definitions that select among the laws of each kind.
io::Json record_laws(io::SchemaRecorder& recorder);

}  // namespace hilda::granular
