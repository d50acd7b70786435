// SPDX-License-Identifier: GPL-3.0-or-later
/// The contact laws of a case in the terms of LAMMPS: pair_style granular, fix wall/gran/region granular.
///
/// Normal force. `hertz` is `hertz/material E e' nu damping tsuji`, or `hertz K e' damping tsuji`, of LAMMPS:
///
///     HILDA     F = 2/3 S δ + c √(m* S) δ̇,   S = 2 E* a,   a = √(R* δ)
///     LAMMPS    F = K a δ + α √(m* K a) δ̇,   K = 4/3 E*
///
/// The forces are equal for α = √(3/2) c. With the coefficient of restitution e that is
/// α = -√5 ln e/√(ln² e + π²). LAMMPS computes α from its argument e' by the polynomial of Tsuji, Tanaka and
/// Ishida (1992):
///
///     α(e') = 1.2728 - 4.2783 e' + 11.087 e'² - 22.348 e'³ + 27.467 e'⁴ - 18.022 e'⁵ + 4.8218 e'⁶
///
/// It gives a smaller damping than HILDA for the same number: 0.71 of it for e = 0.9. The export therefore
/// writes the e' with α(e') = √(3/2) c, which tsuji_argument() finds. It is negative for e < 0.11. `clamped`
/// is `limit_damping`.
///
/// Friction. `mindlin` is `mindlin`, with `rescale` it is `mindlin_rescale`, and `mindlin-incremental` is
/// `mindlin_rescale/force`. Their histories are a displacement [m] or, with /force, an elastic force [N],
/// and are not scaled by the contact radius otherwise:
///
///     HILDA     k = 8 G* a,    γ = c √(m* k)
///     LAMMPS    k = k_t a,     γ = γ_t α √(m* K a);      NULL stands for k_t = 8 G* with hertz/material
///
/// Thus k_t = 8 G* and γ_t = 2 √(G*/E*). Coulomb's bound holds for the sum of spring and dashpot in both.
/// While a contact is unloaded HILDA computes the ratio of the contact radii from the rate of the overlap and
/// LAMMPS from the radius of the previous step: a difference of second order in a step.
///
/// Materials. E* and G* of two materials have the same equations in both programs (see material.hpp). LAMMPS
/// would mix damping and friction of unlike types as geometric means, so that every pair is written. A pair
/// of unlike materials has `hertz` with K and k_t.
///
/// Boundaries have `hertz` with K and k_t as well: `fix wall/gran` of the version of 29 Sep 2021 computes
/// E* = E/(2 (1 - ν)) from `hertz/material`, without the square.
///
/// Lever arm of friction. LAMMPS has R in the relative velocity, and in the torque R - δ/2 between particles
/// and R at a boundary. HILDA has R in all, or with `lever` `contact` R - δ/2: the torques differ by δ/(2 R).

#pragma once

#include "granular/core/pair_law.hpp"
#include "io/json_source.hpp"

#include <string>

namespace hilda::granular {

struct LammpsLaw {
    double E_eff = 0;        ///< E* [Pa]
    double restitution = 0;  ///< e', the argument of the polynomial
    double k_t = 0;          ///< 8 G* [Pa]
    double gamma_t = 0;      ///< γ_t [-]
    double mu = 0;
    std::string tangential;  ///< name of the law of LAMMPS; empty: without friction
    bool limit_damping = false;

    /// The arguments of pair_coeff after the types, for particles of one material
    std::string of_material(const Material& m) const;
    /// The same for particles of two materials, and of fix wall/gran/region after `granular`
    std::string of_stiffness() const;
};

/// The law of LAMMPS with the same forces. Throws io::PlacedError with the place of the entry of `laws` at
/// `pointer` if there is none.
LammpsLaw lammps_law(const PairLaw& law, const io::JsonSource& source, const std::string& pointer);

/// The argument e' with which the polynomial is √(3/2) c; c: see damping()
double tsuji_argument(double c);

}  // namespace hilda::granular
