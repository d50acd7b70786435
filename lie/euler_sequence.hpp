// SPDX-License-Identifier: GPL-3.0-or-later
/// Euler angles of any sequence of axes, for input and output. The schemes on Euler angles use
/// lie/euler_angles.hpp.

#pragma once

#include "lie/so3.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace hilda::lie {

/// A sequence of three body axes. The body is rotated from the global frame by the first angle about the
/// first axis, then about the second axis as it has turned, then about the third:
///
///     A = R_i(angle 1) R_j(angle 2) R_k(angle 3)
///
/// zxz is the sequence of Fang (2022), Eq. 2.1b: (θ, φ, ψ). zyx: yaw, pitch and roll.
struct EulerSequence {
    std::array<int, 3> axis;  ///< 0, 1, 2 for x, y, z; neighbours differ

    /// The sequence with a name such as "zxz"; nothing unless it has three letters x, y, z and neighbours
    /// differ
    static std::optional<EulerSequence> named(std::string_view name);

    bool is_proper() const { return axis[0] == axis[2]; }

    Mat3 rotation(const Vec3& angles) const;
    /// Angles of a rotation: the first and the third from -π to π, the second from 0 to π if the first and
    /// the third axis are the same (zxz), and from -π/2 to π/2 otherwise (zyx). At the ends of the range of
    /// the second angle only a combination of the other two is determined; the third is then 0.
    Vec3 angles(const Mat3& A) const;
};

}  // namespace hilda::lie
