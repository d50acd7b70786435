// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the outputs that a case requests.

#pragma once

#include "granular/case/output_spec.hpp"
#include "granular/reading/object_reader.hpp"
#include "granular/world/world.hpp"

#include <string>

namespace hilda::granular {

/// Reads `fields`, `contacts` and `loads`. Throws io::PlacedError.
OutputSpecs read_outputs(ObjectReader& o, const WorldOptions& world);

/// A notice if the kernel is smaller than the largest particles: such fields have the structure of single
/// particles. Empty otherwise.
std::string width_notice(const FieldSpec& spec, double largest_diameter);

}  // namespace hilda::granular
