// SPDX-License-Identifier: GPL-3.0-or-later
/// Components of a vector in the text of a model file.

#pragma once

#include "lie/so3.hpp"

#include <fmt/format.h>

#include <string>

namespace hilda::studies {

/// "[x, y, z]"
inline std::string components(const lie::Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

}  // namespace hilda::studies
