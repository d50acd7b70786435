// SPDX-License-Identifier: GPL-3.0-or-later
/// Sphere of the validations with one or two bodies: mass 1 kg, R = 0.5 m, E = 2e5 Pa, which allows steps of
/// 1e-5 s.
///
/// Source: Fang (2022), Secs. 7.1.1 to 7.1.3.

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

/// hertz_mindlin() of soft(), with the law mindlin-incremental in place of mindlin if requested
inline PairLaw soft_law(double restitution, double mu, bool incremental)
{
    PairLaw law = hertz_mindlin(soft(), restitution, mu);
    const auto bound = static_cast<float>(mu);
    if (incremental)
        law.tangential = MindlinIncremental{
            .spring = TangentialSpring::of_materials(soft(), soft(), restitution), .cap = {bound, bound}};
    return law;
}

}  // namespace hilda::granular
