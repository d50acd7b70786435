// SPDX-License-Identifier: GPL-3.0-or-later
/// Stack of three spheres: two on the ground with a gap between them, a third placed on both.
///                                                                       Fang (2022), Sec. 7.1.4

#pragma once

#include "granular/validations/validation.hpp"

#include <functional>
#include <vector>

namespace hilda::granular {

/// A stack; the lower spheres have a mass of 1 kg and a radius of 0.15 m.
struct Stack {
    double gap = 0;   ///< gap between the lower spheres, over the radius
    double mu = 0;    ///< coefficient of friction of all contacts
    double mu_r = 0;  ///< coefficient of rolling friction
};

enum class StackRolling {
    half_radius,  ///< constant torque μ_r N R/2 at all contacts
    epsd          ///< spring and damper, bounded by μ_r N R*; R* is R on the ground and R/2 between spheres
};

struct StackRun {
    StackRolling rolling = StackRolling::half_radius;
    double ground = 1;               ///< factor of μ_r at the ground
    double h = 1e-5;                 ///< [s]
    double settle = 0.5, watch = 2;  ///< time before and after the insertion of the third sphere [s]
    Device device = {};
    std::function<void(const World&)> ended = [](const World&) {};  ///< called at the end of a run
    ValidationProgress kept = {};                                   ///< of an interrupted validation
};

/// Final height of the centre of the upper sphere over the radius, for each stack and its upper mass [kg].
/// The stacks are computed as replicas of one world.
std::vector<double> heights(const std::vector<Stack>& stacks, const std::vector<double>& top,
                            const StackRun& run);

/// Limit of heights(): a stack has collapsed below it. A stable upper sphere is at about 2.6, one on the
/// ground at 1.
constexpr double collapse_height = 2;

/// Smallest mass of the upper sphere with which the stack collapses [kg], by bisection up to 2.56 kg in steps
/// of 0.01 kg
std::vector<double> critical_masses(
    const std::vector<Stack>& stacks, const StackRun& run,
    const std::function<void(double)>& progress = [](double) {});

/// Smallest mass of the upper sphere for which no static equilibrium exists [kg]. `lever_ground`,
/// `lever_top`: levers of the rolling torque bounds μ_r N at the ground and between spheres, over R.
///
/// Half the weight of the upper sphere is W; θ is the angle between the line of centres and the vertical,
/// with sin θ = (1 + gap/2)/2. Friction between the spheres is at its bound μ N, so that N = W/(cos θ + μ sin
/// θ). The ground must provide the horizontal force N (sin θ - μ cos θ), otherwise the lower spheres slide.
/// They roll away if this force, with the lever R, exceeds μ N R and the rolling torques.
double static_limit(const Stack& stack, double lever_ground, double lever_top);

}  // namespace hilda::granular
