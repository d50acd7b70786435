// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the contact laws of a case file.

#pragma once

#include "granular/core/pair_law.hpp"
#include "granular/reading/object_reader.hpp"

namespace hilda::granular {

/// Index of the material with this name. If there is none, calls `fail` with the message; it must throw.
int material_named(const std::string& name, const std::vector<Material>& materials,
                   const std::function<void(const std::string&)>& fail);

/// Indices of the two materials of a law, from the key `between`. Throws io::PlacedError.
std::array<int, 2> read_between(ObjectReader& pair, const std::vector<Material>& materials);

/// Reads the laws between the materials i and j. Throws io::PlacedError. A restitution of 0 is raised to
/// 1e-7, with a warning in `notices`.
PairLaw read_pair(ObjectReader& pair, const Material& i, const Material& j,
                  std::vector<std::string>& notices);

/// Calls f(key of the case, name of the default law, member of PairLaw) for each kind of law. The normal law
/// is the first, because others depend on it.
template <class F>
void for_each_kind(const F& f)
{
    f("normal", "hertz", &PairLaw::normal);
    f("tangential", "none", &PairLaw::tangential);
    f("rolling", "none", &PairLaw::rolling);
    f("spin", "none", &PairLaw::spin);
    f("cohesion", "none", &PairLaw::cohesion);
}

}  // namespace hilda::granular
