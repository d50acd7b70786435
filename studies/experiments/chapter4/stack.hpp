// SPDX-License-Identifier: GPL-3.0-or-later
/// Three stacked spheres: two on the ground, one above and between them.                Fang (2022), Sec. 4.4.7

#pragma once

#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// R = 0.15 m; 1 kg below, each with E = 2 MPa, ν = 0.3, a restitution of 0.4, and so the ground. What the text
/// leaves open was found by repeating the published run: μ_s = 0.25, μ_k = 0.2, K_E = 1e5 N/m, ζ = 1, g = 9.81 m/s²,
/// and an effective mass of 0.5 kg in the normal damping on the ground, as if the ground had the mass of a sphere.
struct Stack {
    double gap = 0.3;  ///< between the lower spheres, over R
    double top = 1;    ///< mass of the upper one [kg]
    double eta_r = 0.2;
    bool dissertation = true;  ///< friction with the dissertation's choices, or balanced

    static constexpr double R = 0.15;  ///< [m]
};

namespace stacked {
enum Body { left, right, top, ground };
enum ContactNumber { top_left, top_right, left_ground, right_ground };
}  // namespace stacked

/// At t = 0, at rest: the lower spheres as deep in the ground as carries them alone, the upper one touches them
/// with no overlap.
contact::Scene scene(const Stack& stack);

/// What becomes of a stack
struct Fate {
    enum { stands, collapses, undecided } is = undecided;
    double t = 0;                        ///< when that was clear [s]
    bool rolls = false, slides = false;  ///< the lower spheres on the ground, at that time
};

/// Steps until the upper sphere has come down by a tenth of R, which no stack survives (a lower top pushes the
/// lower spheres apart the harder), or until for 0.2 s no friction spring has slipped. By then the spheres only swing
/// on springs that are damped, with a period of about 0.1 s, and what an amplitude did not break a smaller one does not.
Fate fate(contact::Scene& of, double h, double end);

}  // namespace hilda::studies
