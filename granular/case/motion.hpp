// SPDX-License-Identifier: GPL-3.0-or-later
/// Prescribed motions and loads of boundaries as formulas in the time t.

#pragma once

#include "granular/reading/formula.hpp"
#include "granular/world/world.hpp"
#include "io/error.hpp"

#include <optional>

namespace hilda::granular {

/// Prescribed motion and load of one boundary, set before each step of size h:
///
///     r given:     v = (r(t + h) - r)/h, so that the position after the step is exact
///     v, ω given:  values at t + h/2, so that the position is accurate to second order
///     F, T given:  values at t; at t + h/2 with velocity Verlet, which keeps its order
///
/// The velocity of a boundary with a mass is not prescribed along its free axes, nor its angular velocity
/// about them.
struct BoundaryMotion {
    int boundary = 0;
    std::string name;
    std::optional<VectorFormula> r, v, omega, F, T;

    bool is_prescribed() const { return r || v || omega || F || T; }
};

/// The value of a formula is not finite. what() states the boundary, the key and the time.
class NotFinite : public io::NumericalFailure {
public:
    explicit NotFinite(const std::string& what) : NumericalFailure("not_finite", what) {}
};

/// Sets velocities and forces of the boundaries for the next step h [s]. To be called by
/// World::before_each_step. Throws NotFinite.
void apply_motions(World& world, const std::vector<BoundaryMotion>& motions, double h);

}  // namespace hilda::granular
