// SPDX-License-Identifier: GPL-3.0-or-later
/// Boundaries that move, and are loaded, as formulas in t say.

#pragma once

#include "granular/world/world.hpp"

#include <optional>

namespace hilda::granular {

using Formula = std::function<double(double t)>;
/// Makes a formula of its text; InvalidCase where it is none. The room has no grammar of its own: who reads a case brings
/// one.
using Compile = std::function<Formula(const std::string& text)>;

struct VectorFormula {
    std::array<Formula, 3> of;
    Vec3 operator()(double t) const { return {of[0](t), of[1](t), of[2](t)}; }
};

/// Of one boundary. Along axes on which it is free it moves by what touches it.
///
///     r:      v = (r(t + h) - r)/h, so that it is where r says after every step
///     v, ω:   at the middle of the step, so that it is there to second order
struct Motion {
    int boundary = 0;
    std::string name;
    std::optional<VectorFormula> r, v, omega, F;

    bool moves() const { return r || v || omega || F; }
};

/// A formula that is not finite at this time. what() says which and when.
class NotFinite : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Before a step of h: what World::before_each_step is given. NotFinite.
void drive(World& world, const std::vector<Motion>& motions, double h);

}  // namespace hilda::granular
