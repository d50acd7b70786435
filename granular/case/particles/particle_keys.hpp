// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the entries of `particles`: single particles and clumps.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/case/entry_keys.hpp"

namespace hilda::granular {

/// Reads an entry of `particles` and, if `adds`, adds its particle or clump to the world of the case. Returns
/// its diameter [m]. Throws io::InvalidInput.
double read_particle(ObjectReader& o, Case& c, EntryKeys& keys, const WorldOptions& options, bool adds);

}  // namespace hilda::granular
