// SPDX-License-Identifier: GPL-3.0-or-later
/// A force and a torque on a body that are computed outside of the model and constant in a step.

#pragma once

#include "dae/force.hpp"

#include <functional>

namespace hilda::run {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Wrench6 = Eigen::Matrix<double, 6, 1>;  ///< F, T about the centre of mass, global frame [N, N m]

/// The internal states are the wrench, and an impulse that belongs to the next step [N s, N m s].
/// lie::March::set_internal_states() sets them before each step.
class CoupledWrench final : public dae::Force {
public:
    /// `at_start`: the wrench at a start, in the state x
    CoupledWrench(int body, std::string name, std::function<Wrench6(const dae::State& x)> at_start);

    void add(const dae::State& x, lie::Loads& out) const override;
    int internal_states() const override { return 12; }
    void update_internal_state(dae::State& x) const override;
    int last_body() const override { return body; }

    /// Calls no function at_start from here on.
    void end_start() { at_start = nullptr; }

private:
    int body;
    std::function<Wrench6(const dae::State& x)> at_start;
};

}  // namespace hilda::run
