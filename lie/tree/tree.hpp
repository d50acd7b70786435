// SPDX-License-Identifier: GPL-3.0-or-later
/// Systems whose joints form a tree: each body has one joint, to the ground or to a body before it.

#pragma once

#include "lie/so3.hpp"

#include <string>
#include <vector>

namespace hilda::lie {

/// The joint of a body with the body before it.
///
/// P is a point of the body before, Q one of the body. The frames F_i and F_j belong to these two bodies; the
/// third axis of both is the axis of the joint. With the joint coordinates q
///
///     fixed   Q = P,          A_j = A_i F_i F_jᵀ                     no coordinate
///     hinge   Q = P,          A_j = A_i F_i R_z(q) F_jᵀ              angle about the axis [rad]
///     slide   Q = P + q a,    A_j = A_i F_i F_jᵀ                     displacement along the axis a [m]
///     ball    Q = P,          A_j arbitrary                          3 coordinates of a rotation
///     free    no constraint; `before` is the ground                  6 coordinates
struct TreeJoint {
    enum class Kind { fixed, hinge, slide, ball, free };

    Kind kind = Kind::free;
    int before = -1;  ///< number of the body before, -1: the ground
    int body = 0;
    Vec3 s_bar_i = Vec3::Zero(), s_bar_j = Vec3::Zero();  ///< P and Q in the frames of the two bodies [m]
    Mat3 F_i = Mat3::Identity(), F_j = Mat3::Identity();  ///< rotations to the frames of the two bodies

    /// Number of joint coordinates
    int freedoms() const
    {
        constexpr int of_kind[] = {0, 1, 1, 3, 6};
        return of_kind[static_cast<int>(kind)];
    }
};

/// The joints of a system, one for each body. A joint comes after that of the body before it.
struct Tree {
    std::vector<TreeJoint> joint;
    /// If the constraints are not those of a tree: the reason, one line, in the form "constraint 'name' …".
    /// There are no joints then.
    std::string refusal = {};
};

}  // namespace hilda::lie
