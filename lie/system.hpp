// SPDX-License-Identifier: GPL-3.0-or-later
/// The interface between a constrained mechanical system and the integrators.
///
///     M r̈ + Φ_rᵀ λ = F,    J̄ ω̄̇ + Π̄ᵀ λ = τ̄ = n̄ - ω̄ × J̄ ω̄,    Φ(r, A, t) = 0           Fang (2022), Eq. 3.4
///
/// A system may have, in addition,
///
/// - algebraic variables α, in groups of rows: Φ(r, A, α, t) = 0 and Φ_αᵀ λ = 0 (Eq. 5.33), for evolving
///   contacts;
/// - nonholonomic rows Φ_r ṙ + Π̄ ω̄ = ν without a position constraint, for rolling; they are the last rows;
/// - regularised rows: pairs of nonholonomic rows with a compliance and a bound, for implicit friction;
/// - unilateral rows, which are inactive in some states: their derivatives and Φ are zero there.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/state.hpp"

#include <string>

namespace hilda::lie {

/// A constrained mechanical system. It is constant during a run; everything that changes is in State.
///
/// Output arguments have their final size on entry, and are overwritten.
class System {
public:
    System() = default;
    System(const System&) = delete;
    System& operator=(const System&) = delete;
    virtual ~System() = default;

    int bodies() const { return static_cast<int>(mass().m.size()); }
    int rows() const { return pattern().rows(); }

    virtual const Mass& mass() const = 0;
    /// The fixed pattern of the constraint rows. Its values are not used.
    virtual const Rows& pattern() const = 0;

    /// F and n̄ in the state x.
    virtual void loads(const State& x, Loads& out) const = 0;
    /// Φ(r, A, α, t), one component per row; 0 for nonholonomic rows
    virtual void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Φ_r, Π̄ and Φ_α; `out` is a copy of pattern()
    virtual void variation(const State& x, Rows& out) const = 0;
    /// ν = -∂Φ/∂t, the right side of Φ_r ṙ + Π̄ ω̄ + Φ_α α̇ = ν                                         Eq. 2.8
    virtual void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// γ, the right side of Φ_r r̈ + Π̄ ω̄̇ + Φ_α α̈ = γ                                                 Eq. 2.9
    virtual void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Computes x.alpha from the poses of the bodies, starting from its present value. The poses may satisfy
    /// the constraints only approximately, as those of a stage of a Runge-Kutta step do.
    virtual void update_alpha(State& /*x*/) const {}

    /// Derivatives for exact Newton matrices; schemes with a frozen matrix do not use them. The defaults are
    /// central differences: slow, with a relative error below about 1e-9.
    virtual void second_variation(const State& x, SecondVariation& out) const;
    /// ∂ν/∂(δr, δθ̄); `out` is a copy of pattern()
    virtual void nu_variation(const State& x, Rows& out) const;
    virtual void gamma_variation(const State& x, GammaVariation& out) const;
    /// The blocks of the variation of the loads; their values are not used. The default is no blocks:
    /// constant loads.
    virtual LoadVariation load_pattern() const { return {}; }
    virtual void load_variation(const State& /*x*/, LoadVariation& /*out*/) const {}

    /// Potential energy of the conservative loads [J]
    virtual double potential_energy(const State&) const { return 0; }
    /// Updates the discrete and internal states of `after`, and the multipliers of rows whose meaning changes
    /// with them. Called once for each accepted step. While a step is computed, they are those of `before`.
    virtual void accepted(const State& /*before*/, State& /*after*/) const {}
    /// Name of row k for messages, e.g. constraint 'crank-rod' row 2; bodies 'crank', 'rod'
    virtual std::string row_name(int k) const { return "constraint row " + std::to_string(k); }
    /// Name of body b for messages
    virtual std::string body_name(int b) const { return "body " + std::to_string(b); }
};

/// Kinetic energy plus potential energy of the conservative loads [J]
double energy(const System& system, const State& x);

}  // namespace hilda::lie
