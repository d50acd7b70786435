// SPDX-License-Identifier: GPL-3.0-or-later
/// Materials and names for the tests of `granular`.
#pragma once

#include "granular/validations/soft_sphere.hpp"
#include "granular/world/double_world.hpp"

namespace hilda::tests {

using granular::hertz_mindlin;
using granular::Material;
using granular::PairLaw;
using granular::Particle;
using granular::soft;
using granular::Vec3;
using granular::World;
using granular::WorldOptions;

/// Glass beads, with a Young's modulus reduced by a factor of 1000
inline Material glass() { return {"glass", 2500, 7e7, 0.24}; }

}  // namespace hilda::tests
