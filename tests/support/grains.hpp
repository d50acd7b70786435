// SPDX-License-Identifier: GPL-3.0-or-later
/// Grains for tests of the granular room.
#pragma once

#include "granular/double_world.hpp"

#include <numbers>

namespace hilda::tests {

using granular::Material;
using granular::PairLaw;
using granular::Particle;
using granular::Vec3;
using granular::World;
using granular::WorldOptions;

/// Hertz of this material, and Mindlin where mu is positive
inline PairLaw hertz_mindlin(const Material& m, double restitution, double mu = 0)
{
    PairLaw law;
    const auto c = static_cast<float>(granular::damping(restitution));
    law.normal = granular::Hertz{.E_eff = static_cast<float>(granular::effective_modulus(m, m)), .c = c};
    if (mu > 0)
        law.tangential = granular::Mindlin{
            .spring = {.k_t = static_cast<float>(8 * granular::effective_shear_modulus(m, m)), .c = c},
            .cap = {static_cast<float>(mu), static_cast<float>(mu)}};
    return law;
}

/// A sphere of 1 kg and 0.5 m, as in Secs. 7.1.1 to 7.1.3 of the dissertation
inline Material soft() { return {"soft", 6 / std::numbers::pi, 2e5, 0.3}; }

}  // namespace hilda::tests
