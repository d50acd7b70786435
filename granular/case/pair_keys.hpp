// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the contact laws of a case file.

#pragma once

#include "granular/core/pair_law.hpp"
#include "granular/keys.hpp"

namespace hilda::granular {

/// Indices of the two materials of a law, from the key `between`. Throws io::InvalidInput.
std::array<std::size_t, 2> read_between(Keys& pair, const std::vector<Material>& materials);

/// Reads the laws between the materials i and j. Throws io::InvalidInput. A restitution of 0 is raised to 1e-7,
/// with a warning in `notices`.
PairLaw read_pair(Keys& pair, const Material& i, const Material& j, std::vector<std::string>& notices);

}  // namespace hilda::granular
