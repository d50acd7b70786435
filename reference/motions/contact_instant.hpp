// SPDX-License-Identifier: GPL-3.0-or-later
/// What is known of one body that touches a fixed one: the common language of the motions that contact is judged by.

#pragma once

#include "lie/state.hpp"

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

/// A body in contact with a fixed one, at one instant. All is two-sided, as in an equation of motion: F_N < 0
/// says that the bodies would have parted.
struct ContactInstant {
    double t = 0;           ///< [s]
    Motion body;            ///< accelerations included
    Vec3 p = Vec3::Zero();  ///< contact point, global [m]: ᾱ of the fixed body, whose frame is the global one
    Vec3 a_bar = Vec3::Zero();   ///< the same point in the frame of the moving body [m]
    Vec3 n = Vec3::UnitZ();      ///< unit normal of the fixed body at p, towards the moving one, global
    double F_N = 0;              ///< [N], along n on the moving body; 0 where nothing touches
    Vec3 F_t = Vec3::Zero();     ///< [N], friction on the moving body, global, perpendicular to n
    Vec3 moment = Vec3::Zero();  ///< [N m], on the moving body besides that of F, global: rolling resistance

    Vec3 F() const { return F_N * n + F_t; }
    /// Velocity of the material point of the moving body at the contact, global [m/s]: zero in rolling
    Vec3 slip() const { return body.rdot + body.A * body.omega_bar.cross(a_bar); }
};

}  // namespace hilda::reference
