// SPDX-License-Identifier: GPL-3.0-or-later
/// Stack of three spheres: two on the ground and one on top of them.                  Fang (2022), Sec. 4.4.7

#pragma once

#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// Parameters of the stack: R = 0.15 m, lower spheres of 1 kg; spheres and ground have E = 2 MPa, ν = 0.3 and
/// a coefficient of restitution of 0.4. The dissertation does not state the following values; they were
/// identified from the published run: μ_s = 0.25, μ_k = 0.2, K_E = 1e5 N/m, ζ = 1, g = 9.81 m/s², and an
/// effective mass of 0.5 kg in the normal damping on the ground (as if the ground had the mass of a sphere).
struct Stack {
    double gap = 0.3;          ///< gap between the lower spheres, over R
    double top = 1;            ///< mass of the upper sphere [kg]
    double eta_r = 0.2;        ///< rolling resistance
    bool dissertation = true;  ///< preset of the friction law: dissertation or balanced

    static constexpr double R = 0.15;  ///< [m]
};

namespace stacked {
enum Body { left, right, top, ground };
enum ContactNumber { top_left, top_right, left_ground, right_ground };
}  // namespace stacked

/// Initial state, at rest: the overlap of the lower spheres with the ground supports their own weight; the
/// upper sphere touches them with zero overlap.
contact::Scene scene(const Stack& stack);

/// Outcome of a run
struct StackOutcome {
    enum { stable, collapses, undecided } state = undecided;
    double t = 0;                        ///< time at which the outcome was determined [s]
    bool rolls = false, slides = false;  ///< motion of the right lower sphere on the ground at time t
};

/// Integrates with step h [s] until the outcome is determined, at most until `end` [s].
///
/// The stack collapses if the upper sphere has descended by R/10: the lower it is, the larger is the force
/// that separates the lower spheres. The stack is stable if no friction spring has slipped for 0.2 s: the
/// spheres then perform damped oscillations with a period of about 0.1 s, and the decreasing amplitude cannot
/// cause slip again.
StackOutcome run_until_decided(contact::Scene& scene, double h, double end);

}  // namespace hilda::studies
