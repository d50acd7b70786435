// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere that is pushed up an incline.                                              Fang (2022), Secs. 4.4.4, A.7

#pragma once

#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// R = 0.2 m, m = 5 kg, g = 9.8 m/s², pressed on the incline by m g cos α; μ_s = 0.25, μ_k = 0.2, K_E = 1e5 N/m. It
/// begins without turning, at v_0 up the slope. The published sweep has half of the critical damping.
struct Incline {
    double alpha = 0;  ///< [rad]
    double eta_r = 0.3;
    bool dissertation = true;  ///< friction with the dissertation's choices, or balanced
    double v_0 = 0.5;          ///< [m/s]
    double zeta = 0.5;

    static constexpr double R = 0.2;  ///< [m]
    static constexpr double mu_s = 0.25, mu_k = 0.2;
};

/// Body 0 is the sphere, body 1 the incline; x points up the slope, z away from it.
contact::Scene scene(const Incline& incline);

/// Whether the sphere slides and rolls, by what its friction springs do                           Table 4.4
enum class Motions { rest, rolls, rolls_and_slips, slips };
Motions motions(const contact::Scene& of);

/// Where one motion goes over into another, by the Coulomb bounds alone [rad]. A sphere that comes to rest after
/// rolling back is held by the kinetic torque, tan α = 2 η_r μ_k, where A.7 has μ_s.
double rest_limit(double eta_r);
/// tan α = 7/2 μ_s - 5 η_r μ_k: beyond, rolling would take more than μ_s N                                A.7
double rolling_limit(double eta_r);

}  // namespace hilda::studies
