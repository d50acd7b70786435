// SPDX-License-Identifier: GPL-3.0-or-later
/// A force with internal states for tests: a spring between two centres of mass with a maximum stretch.
/// Beyond it the spring slips, and the relaxed position, which is an internal state, moves.

#pragma once

#include "dae/force.hpp"

#include <algorithm>

namespace hilda::tests {

class Bristle final : public dae::Force {
public:
    const int i, j;
    const double stiffness, max_stretch;  ///< stiffness [N/m], maximum stretch [m]

    Bristle(int i, int j, double stiffness, double max_stretch)
        : i(i), j(j), stiffness(stiffness), max_stretch(max_stretch)
    {}

    void add(const lie::State& x, lie::Loads& out) const override
    {
        const lie::Vec3 F = stiffness * (distance_vector(x) - relaxed(x));
        apply_force(i, F, lie::Vec3::Zero(), x, out);
        apply_force(j, -F, lie::Vec3::Zero(), x, out);
    }

    std::string label() const override { return "bristle '" + name + "'"; }
    std::string start_error(const lie::State& x) const override
    {
        return distance_vector(x).norm() > 0 ? "" : "the bodies must be apart at the start";
    }

    /// A flag (1 after the first step) and the distance vector at which the spring is relaxed [m, global]
    int internal_states() const override { return 4; }
    void update_internal_state(lie::State& x) const override
    {
        double* const z = x.internal_state.data() + first_internal_state;
        const lie::Vec3 d = distance_vector(x), stretch = d - relaxed(x);
        if (z[0] == 0)
            Eigen::Map<lie::Vec3>(z + 1) = d;
        else if (stretch.norm() > max_stretch)
            Eigen::Map<lie::Vec3>(z + 1) = d - max_stretch / stretch.norm() * stretch;
        z[0] = 1;
    }
    lie::Vec3 relaxed(const lie::State& x) const
    {
        return Eigen::Map<const lie::Vec3>(x.internal_state.data() + first_internal_state + 1);
    }

    /// Stability limit [s] for a reduced mass of 1 kg
    double stable_step(const lie::State&, lie::LoadEvaluation = lie::LoadEvaluation::at_step) const override
    {
        return 2 / std::sqrt(stiffness);
    }

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }

private:
    lie::Vec3 distance_vector(const lie::State& x) const { return motion(x, j).r - motion(x, i).r; }
};

}  // namespace hilda::tests
