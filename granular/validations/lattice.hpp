// SPDX-License-Identifier: GPL-3.0-or-later
/// Layers of equal spheres in one plane, pressed upon in the middle.                     Fang (2022), Sec. 7.2.1

#pragma once

#include "granular/world/world.hpp"

#include <array>
#include <functional>
#include <vector>

namespace hilda::granular {

/// 15 layers of 61 and 60 spheres in turns, in a box as wide as 61 of them
namespace lattice {
constexpr int rows = 15, widest = 61, middle = widest / 2;
constexpr int spheres = rows / 2 * (2 * widest - 1) + widest;
}  // namespace lattice

/// How a contact answers: F = √(δ/R) (k_n δ + ...) with k_n = 30000 mg/R, or F = k_n δ + ... with 3000 mg/R. At the loads
/// of a lattice that only weighs, both have about the same stiffness.
enum class Stiffness { scaled, linear };

struct Press {
    Stiffness stiffness = Stiffness::scaled;
    double mu = 0;  ///< of friction, at all contacts
    double F = 0;   ///< on the sphere in the middle of the top, over its weight
};

struct PressRun {
    double h = 1e-5;                        ///< [s]
    double settle = 2, ramp = 2, hold = 2;  ///< without F, while it grows, and at its full size [s]
    Device device = {};
};

/// Of one lattice before F and at the end; forces over the weight of a sphere
struct Pressed {
    struct At {
        std::array<double, lattice::widest>
            floor{};         ///< upward force of the floor on each of the lowest layer
        double others = 0;   ///< upward force of the floor on spheres of other layers, pressed through to it
        double sides = 0;    ///< upward force of the side walls
        double kinetic = 0;  ///< kinetic energy [m g R]
    } before, after;
    double sunk = 0;  ///< way down of the pressed sphere, over the radius

    /// What F adds to the force of the floor on a sphere, counted from the middle one, over F
    std::array<double, lattice::widest> share(double F) const;
};

/// All lattices at once
std::vector<Pressed> press(
    const std::vector<Press>& lattices, const PressRun& run,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace hilda::granular
