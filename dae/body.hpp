// SPDX-License-Identifier: GPL-3.0-or-later
/// A rigid body: what does not change while it moves.

#pragma once

#include "lie/state.hpp"

#include <string>

namespace hilda::dae {

using lie::Mat3;
using lie::Motion;
using lie::State;
using lie::tilde;
using lie::Vec3;

/// The fixed body at the origin. Constraints and forces may name it; it has no equations.
inline constexpr int ground = -1;

struct Body {
    std::string name;
    double m = 1;                   ///< [kg], positive
    Mat3 J_bar = Mat3::Identity();  ///< [kg m²], body frame, about the centre of mass

    /// Throws InvalidInput unless m > 0, and J̄ is symmetric, positive definite, and a possible distribution
    /// of mass: no principal moment larger than the sum of the other two.
    void validate() const;
};

}  // namespace hilda::dae
