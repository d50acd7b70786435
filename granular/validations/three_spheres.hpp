// SPDX-License-Identifier: GPL-3.0-or-later
/// Three spheres: two on the ground, a gap between them, and a third that is set down on both.  Fang (2022), Sec. 7.1.4

#pragma once

#include "granular/world/world.hpp"

#include <functional>
#include <vector>

namespace hilda::granular {

/// Lower spheres of 1 kg and 0.15 m
struct Stack {
    double gap = 0;   ///< between the lower spheres, over the radius
    double mu = 0;    ///< of friction, at all contacts
    double mu_r = 0;  ///< of rolling
};

enum class StackRolling {
    half_radius,  ///< constant torque, bounded by μ_r N R/2 at every contact
    epsd  ///< spring and dashpot, bounded by μ_r N R* where R* is R on the ground and R/2 between spheres
};

struct StackRun {
    StackRolling rolling = StackRolling::half_radius;
    double ground = 1;               ///< factor on μ_r at the ground
    double h = 1e-5;                 ///< [s]
    double settle = 0.5, watch = 2;  ///< before and after the third sphere is there [s]
    Device device = {};
};

/// Height of the upper sphere's centre at the end, over the radius, for its mass [kg]; all stacks at once
std::vector<double> heights(const std::vector<Stack>& stacks, const std::vector<double>& top,
                            const StackRun& run);

/// Below this the stack has come down: an upper sphere that is held is at 2.6, one on the ground at 1
constexpr double come_down = 2;

/// The least mass, in steps of 0.01 kg, with which the upper sphere comes down, by bisection below 2.56 kg
std::vector<double> critical_masses(
    const std::vector<Stack>& stacks, const StackRun& run,
    const std::function<void(double)>& progress = [](double) {});

/// The mass at which no forces within the bounds of friction and of rolling are in balance [kg]
double static_limit(const Stack& stack, double lever_ground, double lever_top);

}  // namespace hilda::granular
