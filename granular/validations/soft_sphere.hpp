// SPDX-License-Identifier: GPL-3.0-or-later
/// The sphere that is tried alone or in pairs: 1 kg, R = 0.5 m, soft enough for steps of 1e-5 s.
///                                                                                     Fang (2022), Secs. 7.1.1 to 7.1.3

#pragma once

#include "granular/world.hpp"

#include <numbers>

namespace hilda::granular {

inline Material soft() { return {"soft", 6 / std::numbers::pi, 2e5, 0.3}; }

inline Particle soft_sphere()
{
    Particle p;
    p.radius = 0.5, p.mass = 1;
    return p;
}

/// What Mindlin's spring is made of: of this material on itself
inline TangentialSpring tangential_spring(const Material& m, double restitution)
{
    return {.k_t = static_cast<float>(8 * effective_shear_modulus(m, m)),
            .c = static_cast<float>(damping(restitution))};
}

/// Hertz of this material, and Mindlin where mu is positive
inline PairLaw hertz_mindlin(const Material& m, double restitution, double mu = 0)
{
    PairLaw law;
    law.normal = Hertz{.E_eff = static_cast<float>(effective_modulus(m, m)),
                       .c = static_cast<float>(damping(restitution))};
    if (mu > 0)
        law.tangential = Mindlin{.spring = tangential_spring(m, restitution),
                                 .cap = {static_cast<float>(mu), static_cast<float>(mu)}};
    return law;
}

}  // namespace hilda::granular
