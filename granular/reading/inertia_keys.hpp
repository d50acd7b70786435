// SPDX-License-Identifier: GPL-3.0-or-later
/// The key inertia of a rigid body.

#pragma once

#include "granular/reading/object_reader.hpp"

namespace hilda::granular {

/// Reads the key inertia: one number, three principal moments, or a symmetric matrix of three rows. Throws
/// io::PlacedError.
Inertia read_inertia(ObjectReader& o);

}  // namespace hilda::granular
