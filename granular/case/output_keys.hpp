// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the outputs that a case requests.

#pragma once

#include "granular/case/object_reader.hpp"
#include "granular/fields/field_spec.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::granular {

/// Reads the list `fields`. Throws io::PlacedError.
std::vector<FieldSpec> read_fields(ObjectReader& o, const WorldOptions& world);

/// Reads the number of samples of an interval [s] with steps of size h: at least 1 and at most one in each
/// step. Throws io::PlacedError.
long read_samples(ObjectReader& o, std::optional<long> fallback, double interval, double h);

/// A notice if the kernel is smaller than the largest particles: such fields have the structure of single
/// particles. Empty otherwise.
std::string width_notice(const FieldSpec& spec, double largest_diameter);

}  // namespace hilda::granular
