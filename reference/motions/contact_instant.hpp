// SPDX-License-Identifier: GPL-3.0-or-later
/// State and contact forces of one body in contact with a fixed body, at one instant.
///
/// Common result type of the reference motions for contact.

#pragma once

#include "dae/body.hpp"

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

/// A body in contact with a fixed body at time t. The contact is bilateral: F_N < 0 means that a unilateral
/// contact would have opened.
struct ContactInstant {
    double t = 0;                ///< [s]
    Motion body;                 ///< position and attitude with velocities and accelerations
    Vec3 p = Vec3::Zero();       ///< contact point, global [m]; equals ᾱ of the fixed body
    Vec3 a_bar = Vec3::Zero();   ///< contact point in the frame of the moving body, from its origin [m]
    Vec3 n = Vec3::UnitZ();      ///< unit normal of the fixed body at p, towards the moving one, global
    double F_N = 0;              ///< normal force on the moving body, along n [N]; 0 without contact
    Vec3 F_t = Vec3::Zero();     ///< friction force on the moving body, global, perpendicular to n [N]
    Vec3 moment = Vec3::Zero();  ///< moment of rolling resistance on the moving body, global [N m]

    /// Contact force on the moving body, global [N]
    Vec3 F() const { return F_N * n + F_t; }
    /// Sliding velocity: velocity of the material point of the moving body at the contact, global [m/s]. Zero
    /// in rolling.
    Vec3 slip() const { return dae::velocity_at(body, body.A * a_bar); }
};

}  // namespace hilda::reference
