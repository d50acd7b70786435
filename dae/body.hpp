// SPDX-License-Identifier: GPL-3.0-or-later
/// Constant properties of a rigid body.

#pragma once

#include "dae/body_shape.hpp"
#include "lie/state.hpp"

#include <optional>
#include <string>

namespace hilda::dae {

using lie::Mat3;
using lie::Motion;
using lie::State;
using lie::tilde;
using lie::Vec3;

/// Number of the fixed body at the origin. Constraints and forces may refer to it. It has no equations.
inline constexpr int ground = -1;

inline const Motion motion_of_ground;  ///< at rest at the origin

/// Motion of body b in the state x
inline const Motion& motion(const State& x, int b) { return b == ground ? motion_of_ground : x.body[b]; }

/// Velocity of the material point of a body at this arm from the centre of mass, global frame [m/s]
inline Vec3 velocity_at(const Motion& body, const Vec3& arm)
{
    return body.rdot + (body.A * body.omega_bar).cross(arm);
}

/// Point P of body i and point Q of body j, for drawings: the ends of a spring, the points of a joint
struct PointPair {
    int i, j;
    Vec3 s_bar_i, s_bar_j;  ///< [m], body frames

    bool operator==(const PointPair&) const = default;
};

struct Body {
    std::string name;
    double m = 1;                         ///< mass [kg]
    Mat3 J_bar = Mat3::Identity();        ///< inertia about the centre of mass [kg m²], body frame
    std::optional<BodyShape> shape = {};  ///< for pictures; without effect on the motion

    /// Throws lie::InvalidInput unless m is positive and finite and J̄ is symmetric, positive definite and
    /// physical: no principal moment exceeds the sum of the other two.
    void validate() const;
};

}  // namespace hilda::dae
