// SPDX-License-Identifier: GPL-3.0-or-later
/// Formulas in the time t.

#pragma once

#include "granular/core/boundary.hpp"

#include <functional>

namespace hilda::granular {

using Formula = std::function<double(double t)>;

struct VectorFormula {
    std::array<Formula, 3> of;
    Vec3 operator()(double t) const { return {of[0](t), of[1](t), of[2](t)}; }
};

}  // namespace hilda::granular
