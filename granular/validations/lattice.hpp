// SPDX-License-Identifier: GPL-3.0-or-later
/// Two-dimensional lattice of equal spheres with a point load at the middle of the top.
///                                                                       Fang (2022), Sec. 7.2.1

#pragma once

#include "granular/validations/validation.hpp"

#include <array>
#include <functional>
#include <vector>

namespace hilda::granular {

/// 15 layers of alternately 61 and 60 spheres, in a box whose width is 61 diameters
namespace lattice {
constexpr int rows = 15, widest = 61, middle = widest / 2;
constexpr int spheres = rows / 2 * (2 * widest - 1) + widest;
}  // namespace lattice

/// Normal law: F = √(δ/R) (k_n δ + ...) with k_n = 30000 mg/R, or F = k_n δ + ... with k_n = 3000 mg/R. Under
/// the weight of the lattice both have about the same stiffness.
enum class Stiffness { scaled, linear };

struct LoadCase {
    Stiffness stiffness = Stiffness::scaled;
    double mu = 0;  ///< coefficient of friction of all contacts
    double F = 0;   ///< load on the middle sphere of the top layer, over the weight of a sphere
};

/// The lattices fall onto the floor and settle; the load grows; the lattices settle again.
///
/// They settle by kinetic damping (Cundall 1982, dynamic relaxation): whenever the kinetic energy of a
/// lattice has passed a maximum, its velocities are set to zero. A lattice has settled at a maximum below
/// `kinetic`. Without friction a lattice that is left to itself swings for tens of seconds.
struct LatticeRun {
    double h = 1e-5;         ///< [s]
    double fall = 0.5;       ///< time before the damping begins [s]
    double ramp = 2;         ///< time of increasing load [s]
    double kinetic = 1e-8;   ///< kinetic energy of a settled lattice [m g R]
    double longest = 20;     ///< longest time to settle [s]
    double interval = 1e-3;  ///< time between two values of the kinetic energy [s]
    long save_every = 200;   ///< number of intervals between the states that are kept
    Device device = {};
    std::function<void(const World&)> ended = [](const World&) {};  ///< called at the end of a run
    /// Receives the states; an interrupted run continues from the last one.
    ValidationProgress kept = {};
};

/// Forces on the boundaries of one lattice before the load is applied and at the end, over the weight of a
/// sphere
struct LatticeResponse {
    struct BoundaryForces {
        std::array<double, lattice::widest>
            floor{};              ///< upward force of the floor on each sphere of the lowest layer
        double upper_layers = 0;  ///< upward force of the floor on spheres of other layers
        double sides = 0;         ///< upward force of the side walls
        double kinetic = 0;       ///< kinetic energy at its last maximum [m g R]
    } before, after;
    double settled = 0, held = 0;  ///< times to settle without load and with it [s]
    double displacement = 0;       ///< downward displacement of the loaded sphere, over the radius

    /// Increase of the floor force on each sphere of the lowest layer, over F
    std::array<double, lattice::widest> share(double F) const;
};

/// Computes all lattices as replicas of one world. Throws io::NumericalFailure with the status not_settled if
/// a lattice has not settled after LatticeRun::longest.
std::vector<LatticeResponse> run_lattices(
    const std::vector<LoadCase>& lattices, const LatticeRun& run,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace hilda::granular
