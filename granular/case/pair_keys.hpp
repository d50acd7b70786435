// SPDX-License-Identifier: GPL-3.0-or-later
/// The laws of a case file: what acts between two materials.

#pragma once

#include "granular/core/pair_law.hpp"
#include "granular/keys.hpp"

namespace hilda::granular {

/// The numbers of the two materials of a law. InvalidCase
std::array<std::size_t, 2> read_between(Keys& pair, const std::vector<Material>& materials);

/// InvalidCase. What is mended is told in `notices`.
PairLaw read_pair(Keys& pair, const Material& i, const Material& j, std::vector<std::string>& notices);

}  // namespace hilda::granular
