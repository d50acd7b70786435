// SPDX-License-Identifier: GPL-3.0-or-later
/// Materials, and the parameters of the contact of two materials.            Fang (2022), Sec. A.5, corrected
///
/// Corrections: the compliance in 1/G* is 2 (2 - ν)(1 + ν)/E, of both bodies; the damping coefficient is
/// positive.

#pragma once

#include <cmath>
#include <numbers>
#include <string>

namespace hilda::granular {

/// A linear elastic isotropic material
struct Material {
    std::string name;
    double density = 0;    ///< [kg/m³]
    double E = 0, nu = 0;  ///< Young's modulus [Pa], Poisson's ratio [-]
};

/// Volume of a sphere [m³]
inline double sphere_volume(double radius) { return 4.0 / 3 * std::numbers::pi * radius * radius * radius; }

/// Mass of a sphere [kg]
inline double sphere_mass(double radius, double density) { return sphere_volume(radius) * density; }

/// Rayleigh time of a sphere, π R √(ρ/G)/(0.1631 ν + 0.8766), G = E/(2 (1 + ν)) [s]
inline double rayleigh_time(double radius, const Material& m)
{
    const double G = m.E / (2 * (1 + m.nu));
    return std::numbers::pi * radius * std::sqrt(m.density / G) / (0.1631 * m.nu + 0.8766);
}

/// Effective Young's modulus E* with 1/E* = (1 - ν_i²)/E_i + (1 - ν_j²)/E_j [Pa]
inline double effective_modulus(const Material& i, const Material& j)
{
    return 1 / ((1 - i.nu * i.nu) / i.E + (1 - j.nu * j.nu) / j.E);
}

/// Effective shear modulus G* with 1/G* = 2 (2 - ν_i)(1 + ν_i)/E_i + 2 (2 - ν_j)(1 + ν_j)/E_j [Pa]
inline double effective_shear_modulus(const Material& i, const Material& j)
{
    const auto compliance = [](const Material& m) { return 2 * (2 - m.nu) * (1 + m.nu) / m.E; };
    return 1 / (compliance(i) + compliance(j));
}

/// Dimensionless damping coefficient of a Hertzian contact with the coefficient of restitution e, 0 < e ≤ 1:
///
///     c = -2 √(5/6) ln e / √(ln² e + π²)
///
/// The damping constants are c √(m* S) in the normal direction, with S = 2 E* √(R* δ), and c √(m* k) in the
/// tangential.
inline double damping(double e)
{
    const double l = std::log(e);
    return -2 * std::sqrt(5.0 / 6) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
}

}  // namespace hilda::granular
