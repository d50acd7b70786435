// SPDX-License-Identifier: GPL-3.0-or-later
/// Diagnosis of a failed step, for the error message.

#pragma once

#include <string>

namespace hilda::dae {
class Model;
}

namespace hilda::io {
class NumericalFailure;
}

namespace hilda::lie {
struct Scheme;
class Integrator;
struct State;
}  // namespace hilda::lie

namespace hilda::run {

/// A step size as text, in scientific notation below 0.01: 1e-3, 5e-5, 0.02
std::string step_text(double h);

struct Diagnosis {
    std::string what;    ///< t=0.4310 step 431 (rA-half-1, h=1e-3): correction 3.2e+02 after 30 iterations
    std::string detail;  ///< constraint with the largest residual, or force or constraint that is not finite
};

/// Diagnosis of the step of size h [s] that starts at `node`, the node with this number. Evaluates the model
/// at the node and at the node shifted in time by h.
Diagnosis diagnose(const io::NumericalFailure& failure, const dae::Model& model, const lie::State& node,
                   long number, double h, const lie::Scheme& scheme);

/// Warning of a run with adaptive steps whose constraints nearly lost rank; empty if they did not
std::string rank_warning(const lie::Integrator& integrator);

}  // namespace hilda::run
