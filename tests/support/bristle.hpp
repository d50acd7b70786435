// SPDX-License-Identifier: GPL-3.0-or-later
/// A force that remembers real numbers: a spring between two centres of mass that slips once it is stretched
/// by more than so much, and so carries where it last held.

#pragma once

#include "dae/force.hpp"

#include <algorithm>

namespace hilda::tests {

class Bristle final : public dae::Force {
public:
    const int i, j;
    const double stiffness, most;  ///< [N/m], [m]

    Bristle(int i, int j, double stiffness, double most) : i(i), j(j), stiffness(stiffness), most(most) {}

    void add(const lie::State& x, lie::Loads& out) const override
    {
        const lie::Vec3 F = stiffness * (between(x) - held(x));
        push(i, F, lie::Vec3::Zero(), x, out);
        push(j, -F, lie::Vec3::Zero(), x, out);
    }

    std::string in_words() const override { return "bristle '" + name + "'"; }
    std::string objection(const lie::State& x) const override
    {
        return between(x).norm() > 0 ? "" : "the bodies must be apart at the start";
    }

    /// Whether it has begun, and the distance vector at which it is relaxed [m, global]
    int internal_states() const override { return 4; }
    void update_internal_state(lie::State& x) const override
    {
        double* const z = x.internal_state.data() + first_internal_state;
        const lie::Vec3 d = between(x), stretch = d - held(x);
        if (z[0] == 0)
            Eigen::Map<lie::Vec3>(z + 1) = d;
        else if (stretch.norm() > most)
            Eigen::Map<lie::Vec3>(z + 1) = d - most / stretch.norm() * stretch;
        z[0] = 1;
    }
    lie::Vec3 held(const lie::State& x) const
    {
        return Eigen::Map<const lie::Vec3>(x.internal_state.data() + first_internal_state + 1);
    }

    /// For a reduced mass of 1 kg
    double stable_step(const lie::State&) const override { return 2 / std::sqrt(stiffness); }

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }

private:
    lie::Vec3 between(const lie::State& x) const { return motion(x, j).r - motion(x, i).r; }
};

}  // namespace hilda::tests
