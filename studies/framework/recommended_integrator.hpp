// SPDX-License-Identifier: GPL-3.0-or-later
/// The integrator that suits a model.

#pragma once

#include "lie/state.hpp"

#include <string>

namespace hilda::dae {
class Model;
}

namespace hilda::studies {

struct Recommendation {
    std::string integrator;  ///< name of a scheme
    std::string reason;      ///< one line
};

/// The integrator that suits the model, in this order: contact constraints, no degrees of freedom, springs
/// and dampers that limit explicit steps to less than the default step, else the default integrator. x is the
/// state at the start.
Recommendation recommended_integrator(const dae::Model& model, const lie::State& x, int degrees_of_freedom);

}  // namespace hilda::studies
