// SPDX-License-Identifier: GPL-3.0-or-later
/// The sphere that is tried alone or in pairs: 1 kg, R = 0.5 m, soft enough for steps of 1e-5 s.
///                                                                                     Fang (2022), Secs. 7.1.1 to 7.1.3

#pragma once

#include "granular/world/world.hpp"

#include <numbers>

namespace hilda::granular {

inline Material soft() { return {"soft", 6 / std::numbers::pi, 2e5, 0.3}; }

inline Particle soft_sphere()
{
    Particle p;
    p.radius = 0.5, p.mass = 1;
    return p;
}

}  // namespace hilda::granular
