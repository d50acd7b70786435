// SPDX-License-Identifier: GPL-3.0-or-later
/// What is known of a step that failed, for the message.

#pragma once

#include "dae/model.hpp"

#include <string>

namespace hilda::studies {

/// A step size for people: 1e-3, 5e-5, 0.02
std::string step_text(double h);

struct Diagnosis {
    std::string what;    ///< t=0.4310 step 431 (rA-half-1, h=1e-3): correction 3.2e+02 after 30 iterations
    std::string detail;  ///< where: the constraint with the largest residual, or the force that is not finite
};

/// Of the step that should have left `node`, the number-th, by h. Looks only at the node.
Diagnosis diagnose(const lie::NumericalFailure& failure, const dae::Model& model, const lie::State& node,
                   long number, double h, const std::string& scheme);

}  // namespace hilda::studies
