// SPDX-License-Identifier: GPL-3.0-or-later
/// The types of constraints and forces of the model file, and the keys of each. A new type is one more entry
/// in the .cpp.

#pragma once

#include "dae/model.hpp"
#include "dae/object_reader.hpp"

namespace hilda::dae {

/// "DP1", "revolute", ...
const std::vector<std::string>& constraint_types();

/// Reads the keys of one of these types between the bodies i and j; x is the start. Throws PlacedError, and
/// without a place lie::InvalidInput or ExpressionError for what the joint itself refuses.
Blocks read_constraint(const std::string& type, ObjectReader& o, int i, int j, const State& x);

/// The types of forces between two bodies: "spring-damper", ...
const std::vector<std::string>& pair_force_types();

std::unique_ptr<Force> read_pair_force(const std::string& type, ObjectReader& o, int i, int j,
                                       const State& x);

}  // namespace hilda::dae
