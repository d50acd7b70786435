// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lie/so3.hpp"

/// The origin and the unit vectors of the axes
namespace hilda::tests::axes {

inline const lie::Vec3 O = lie::Vec3::Zero(), X = lie::Vec3::UnitX(), Y = lie::Vec3::UnitY(),
                       Z = lie::Vec3::UnitZ();

}  // namespace hilda::tests::axes
