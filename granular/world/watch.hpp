// SPDX-License-Identifier: GPL-3.0-or-later
/// The watch over a granular run: balances of energy and momentum, overlaps and displacements.

#pragma once

#include "granular/core/watch.hpp"
#include "io/error.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hilda::granular {

/// The overlap of two bodies is above the limit, so that the contact laws do not hold and grains may pass
/// through each other.
class OverlapTooLarge : public io::NumericalFailure {
public:
    explicit OverlapTooLarge(const std::string& what) : NumericalFailure("overlap_too_large", what) {}
};

/// A system without supply of energy has gained more energy than the error of its integrator explains.
class EnergyCreated : public io::NumericalFailure {
public:
    explicit EnergyCreated(const std::string& what) : NumericalFailure("energy_created", what) {}
};

/// A rigid body boundary has left the domain to the side to which gravity pulls it. No particle can stop it,
/// and boundaries do not touch each other.
class ToolLeft : public io::NumericalFailure {
public:
    explicit ToolLeft(const std::string& what) : NumericalFailure("tool_left", what) {}
};

/// Limits of the watch
namespace watch_limit {
constexpr double overlap = 0.05;      ///< over the smaller radius; a warning above it
constexpr double displacement = 0.1;  ///< of a particle in a step, over its radius; a warning above it
constexpr double energy = 0.01;       ///< allowed gain, over the largest kinetic energy
constexpr long interval = 128;        ///< steps between two samples
}  // namespace watch_limit

/// Record of the watch. Energies, momenta and fractions are those of the last sample, `largest` ones those of
/// all samples; largest_overlap and, if all radii are equal, largest_displacement are those of all steps.
///
///     E = T + V + U,    W - (E - E_0) = dissipated energy
///     P - P_0 = Σ h (m g + F)
///
/// T: kinetic energy at t_n; see AddKinetic. V: potential energy in the gravity along the axes that are not
/// periodic. U: energy of the contact springs. W: work of moving boundaries, of fixed particles that rotate,
/// of applied forces, and of gravity along periodic axes. F: loads of boundaries and fixed particles, applied
/// forces. A change of the particles or of their velocities from outside (World::add, World::set_velocity)
/// starts a new balance, and the dissipated energy continues.
///
/// All members have eight bytes: the record is stored in checkpoints.
struct WatchRecord {
    std::int64_t samples = 0;
    std::int64_t is_balanced = 0;  ///< 1: the reference values of the balances are set
    /// 1: an energy has been supplied: a boundary moves or has a mass, a force is applied, a fixed particle
    /// rotates, the rotation of the particles is locked, or a law has no member energy()
    std::int64_t is_driven = 0;
    std::int64_t warnings = 0;  ///< bits of Warning

    double kinetic = 0, potential = 0, normal = 0, tangential = 0;           ///< T, V and the parts of U [J]
    double work = 0, dissipated = 0;                                         ///< [J]
    double largest_kinetic = 0, largest_tangential = 0, largest_normal = 0;  ///< [J]
    double most_dissipated = 0;  ///< largest value of `dissipated`
    double largest_gain = 0;     ///< largest decrease of `dissipated` below most_dissipated [J]
    double gain_tolerance = 0;   ///< at that instant [J]
    double energy_offset = 0;    ///< W - E + this is the dissipated energy [J]

    double largest_momentum = 0;           ///< largest Σ m |v| [kg m/s]
    Vec3 momentum = {0, 0, 0};             ///< [kg m/s]
    Vec3 impulse = {0, 0, 0};              ///< since the start, of the loads and of gravity [N s]
    Vec3 momentum_offset = {0, 0, 0};      ///< P - impulse - this is the residual [kg m/s]
    Vec3 last_force = {0, 0, 0};           ///< of boundaries and forces in the previous step [N]
    double largest_momentum_residual = 0;  ///< [kg m/s]
    double mass = 0;                       ///< of the particles that are not fixed [kg]

    double largest_overlap = 0;  ///< over the smaller radius
    double deep_fraction = 0;    ///< of the contacts: overlap above 5 % of the smaller radius
    double largest_deep_fraction = 0;
    double largest_displacement = 0;  ///< of a particle in a step, over its radius
    double largest_speed = 0;         ///< [m/s]

    // the first tool that has left the domain
    double left_tool = 0;         ///< number of the boundary
    double left_time = 0;         ///< [s]
    Vec3 left_place = {0, 0, 0};  ///< of its centre of mass [m]

    enum Warning : std::int64_t { deep = 1, fast = 2, left = 4 };

    /// The value that is above the limit of a warning; of `left` the time
    double extreme(Warning of) const
    {
        return of == deep ? largest_overlap : of == fast ? largest_displacement : left_time;
    }
    /// Adds the warnings and the extremes of overlap and displacement of another record.
    void include(const WatchRecord& other);
};

/// A warning and its name, which is the status of a run that it ends with --strict
struct NamedWarning {
    WatchRecord::Warning which;
    const char* name;
};
constexpr NamedWarning watch_warnings[] = {{WatchRecord::deep, "overlap_large"},
                                           {WatchRecord::fast, "step_coarse"},
                                           {WatchRecord::left, "tool_left"}};

/// Text of a warning in one line, without the prefix "warning". `boundaries`: their names, if they have any
std::string watch_warning(const WatchRecord& record, WatchRecord::Warning which,
                          const std::vector<std::string>& boundaries = {});

}  // namespace hilda::granular
