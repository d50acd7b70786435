// SPDX-License-Identifier: GPL-3.0-or-later
/// Grains for tests of the granular room.
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

/// As beads of a millimetre are made of
inline Material glass() { return {"glass", 2500, 7e7, 0.24}; }

}  // namespace hilda::tests
