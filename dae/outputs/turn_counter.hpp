// SPDX-License-Identifier: GPL-3.0-or-later
/// The angle of a hinge for the output, counted through whole turns.
#pragma once

#include "dae/forces/hinge_force.hpp"

namespace hilda::dae {

/// The angle of HingeForce without a torque. Model::count() adds one to the discrete states of a model. It
/// has no effect on the motion.
///
/// After each accepted step the nearest number of quarter turns is stored. The number of turns is that of the
/// angle nearest to the prediction by the mean of the rates at both ends of the step. It is right as long as
/// the prediction is right to half a turn.
class TurnCounter final : public HingeForce {
public:
    /// As for HingeForce, with "angle" as the type
    TurnCounter(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const State& start)
        : HingeForce("angle", i, axis_bar_i, j, axis_bar_j, start)
    {}
    double torque(double, double) const override { return 0; }
    double potential(double) const override { return 0; }

    /// Updates the stored number in `after`, which is that of `before`. The step may be negative.
    void count(const State& before, State& after) const;
};

}  // namespace hilda::dae
