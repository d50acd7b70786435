// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere pushed up an incline.                                               Fang (2022), Secs. 4.4.4, A.7

#pragma once

#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// Parameters of the sphere: R = 0.2 m, m = 5 kg, g = 9.8 m/s², constant normal force m g cos α, μ_s = 0.25,
/// μ_k = 0.2, K_E = 1e5 N/m. The sphere starts with velocity v_0 up the slope and without rotation. The
/// damping ratio ζ = 0.5 is that of the published sweep.
struct Incline {
    double alpha = 0;  ///< [rad]
    double eta_r = 0.3;
    bool dissertation = true;  ///< preset of the friction law: dissertation or balanced
    double v_0 = 0.5;          ///< initial velocity [m/s]
    double zeta = 0.5;         ///< damping ratio of the friction springs

    static constexpr double R = 0.2;  ///< [m]
    static constexpr double mu_s = 0.25, mu_k = 0.2;
};

/// Body 0 is the sphere, body 1 the incline; x points up the slope, z away from it.
contact::Scene scene(const Incline& incline);

/// State of motion, from the modes of the sliding and rolling friction springs                      Table 4.4
enum class InclineState { rest, rolling, rolling_with_slip, slip };
InclineState state_of(const contact::Scene& scene);

/// Largest slope on which the sphere comes to rest [rad], from the Coulomb bounds: tan α = 2 η_r μ_k, at most
/// μ_s. Sec. A.7 has μ_s instead of μ_k. The kinetic value applies, because the sphere rolls back before it
/// comes to rest.
double rest_limit(double eta_r);
/// Largest slope of rolling without slip [rad]: tan α = 7/2 μ_s - 5 η_r μ_k. On steeper slopes rolling
/// requires a friction force above μ_s N (Sec. A.7).
double rolling_limit(double eta_r);

}  // namespace hilda::studies
