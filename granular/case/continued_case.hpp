// SPDX-License-Identifier: GPL-3.0-or-later
/// The case of a run that continues another one: to the same end after an interruption, or to another end.

#pragma once

#include "granular/reading/object_reader.hpp"

namespace hilda::granular {

/// Times between outputs [s]
struct Intervals {
    double rows, frames;
};

/// Reads `interval` and `frame_interval`. Without the first, a run has 1000 rows; without the second, the
/// frames are a hundredth of the end or the interval of the rows apart, whichever is longer. Throws
/// io::PlacedError.
Intervals read_intervals(ObjectReader& o, double h, double end);

/// A key of earlier versions without effect
inline constexpr const char* key_without_effect = "checkpoint_interval";

/// The end of a case [s]. Throws io::PlacedError.
double end_of(const io::JsonSource& source);

/// Sets the intervals that a case does not state to those of `run`, the case of the run that it continues: a
/// later end does not change them. Throws io::PlacedError.
void keep_intervals(io::JsonSource& source, const io::JsonSource& run);

/// The canonical text of a case with its intervals and without its end and keys without effect: two runs with
/// the same text compute the same states. Throws io::PlacedError.
std::string identity(io::JsonSource source);

}  // namespace hilda::granular
