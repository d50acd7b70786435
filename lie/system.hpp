// SPDX-License-Identifier: GPL-3.0-or-later
/// The interface between a constrained mechanical system and the integrators.
///
///     M r̈ + Φ_rᵀ λ = F,    J̄ ω̄̇ + Π̄ᵀ λ = τ̄ = n̄ - ω̄ × J̄ ω̄,    Φ(r, A, t) = 0           Fang (2022), Eq. 3.4
///
/// r and A are the positions of the centres of mass and the rotation matrices of all bodies, ω̄ their angular
/// velocities in the body frames, and λ the multipliers of the constraint rows.
///
/// A system may have in addition:
///
/// - Algebraic variables α. The position constraints are then Φ(r, A, α, t) = 0 with Φ_αᵀ λ = 0 (Eq. 5.33).
///   The variables form groups, and each group occurs in its own rows only. Evolving contacts use them.
/// - Nonholonomic rows Φ_r ṙ + Π̄ ω̄ = ν, which have no Φ. They are the last rows. Example: ideal rolling.
/// - Regularised rows: pairs of nonholonomic rows with a compliance and a bound (BoundedPair). Implicit
///   friction uses them.
/// - Cones: rigid contact points with Coulomb friction, whose number changes (ConeRows).
/// - Unilateral rows, which are inactive in some states. Φ, Φ_r and Π̄ of an inactive row are zero.

#pragma once

#include "lie/bounded_pair.hpp"
#include "lie/cones/cone_rows.hpp"
#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/state.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace hilda::lie {

struct Tree;

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
    /// Number of constraint rows, position rows and nonholonomic rows together
    int rows() const { return pattern().rows(); }

    virtual const Mass& mass() const = 0;
    /// The fixed pattern of the constraint rows. Its values are not used.
    virtual const Rows& pattern() const = 0;

    /// F [N, global frame] and n̄ [N m, body frame] in the state x, with x.applied_loads if the system takes
    /// them
    virtual void loads(const State& x, Loads& out) const = 0;
    /// Φ(r, A, α, t), one component per row; 0 for nonholonomic rows
    virtual void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Φ_r, Π̄ and Φ_α; `out` is a copy of pattern()
    virtual void variation(const State& x, Rows& out) const = 0;
    /// ν, the right side of Φ_r ṙ + Π̄ ω̄ + Φ_α α̇ = ν; -∂Φ/∂t for a position row                       Eq.
    /// 2.8
    virtual void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// γ, the right side of Φ_r r̈ + Π̄ ω̄̇ + Φ_α α̈ = γ                                                 Eq.
    /// 2.9
    virtual void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Computes x.alpha from the poses of the bodies. The present x.alpha is the initial guess. The poses may
    /// satisfy the constraints only approximately, as those of a stage of a Runge-Kutta step do. Throws
    /// NumericalFailure if no α is found.
    virtual void update_alpha(State& /*x*/) const {}

    /// The pairs of regularised rows, with the rows of each. The default is for systems without such rows.
    virtual std::vector<BoundedPair> bounded_pairs() const { return {}; }
    /// Sets K, D, mu, S, n and solved_first of the pairs in the state x; `pair` is a copy of bounded_pairs().
    virtual void update_pairs(const State& /*x*/, std::vector<BoundedPair>& /*pair*/) const {}

    /// Whether the system has rigid contacts. The default is none.
    virtual bool has_cones() const { return false; }
    /// Sets the contact points that may close in a step h [s] from x: those whose gap is smaller than h times
    /// the speed of approach of their bodies, and those that overlap. Keeps the memory of `out`. Throws
    /// NumericalFailure if the contact points of a pair are not found.
    virtual void cones(const State& /*x*/, double /*h*/, ConeRows& out) const { out.cone.clear(); }
    /// Name of a contact point for messages
    virtual std::string cone_name(std::uint64_t /*key*/) const { return "contact point"; }

    /// The springs and dampers that half-implicit schemes evaluate implicitly. Their values are not used. The
    /// default is none.
    virtual Springs spring_pattern() const { return {}; }
    /// Sets the rows, the stiffness and the damping of the springs in the state x; `out` is a copy of
    /// spring_pattern(). The function must not allocate memory.
    virtual void update_springs(const State& /*x*/, Springs& /*out*/) const {}

    /// The row with the largest error of the positions
    struct PositionError {
        double value = 0;  ///< [m or rad]
        int row = -1;      ///< -1 if there are no rows
    };
    /// The largest |Φ_k| in x. A system with rows of other units divides by the lengths of their variations.
    /// NaN counts as larger than any number.
    virtual PositionError position_error(const State& x) const;

    /// The joints, if the constraint rows are those of a tree of joints; otherwise the reason. Constant from
    /// a start on. The default is for systems that do not describe their joints.
    virtual const Tree& tree() const;

    // Derivatives for exact Newton matrices. Schemes with a frozen matrix do not use them. The defaults of
    // the derivatives of the rows are central differences. They are slow; their relative error is about
    // 1e-9 or less.

    /// ∂(Φ_r, Π̄)/∂(δr, δθ̄); see SecondVariation
    virtual void second_variation(const State& x, SecondVariation& out) const;
    /// ∂ν/∂(δr, δθ̄); `out` is a copy of pattern()
    virtual void nu_variation(const State& x, Rows& out) const;
    /// ∂γ/∂(δr, δθ̄, δṙ, δω̄); see GammaVariation
    virtual void gamma_variation(const State& x, GammaVariation& out) const;
    /// The blocks of the variation of the loads. Their values are not used. The default, no blocks, is for
    /// constant loads.
    virtual LoadVariation load_pattern() const { return {}; }
    /// ∂(F, n̄)/∂(δr, δθ̄, δṙ, δω̄); `out` is a copy of load_pattern()
    virtual void load_variation(const State& /*x*/, LoadVariation& /*out*/) const {}

    /// The functions of the state whose zeros are the places where a load is not smooth, such as the distance
    /// to a stop. Adaptive schemes end a step where one of them changes its sign. Places that depend on time
    /// alone belong to smooth_until(). The default is none.
    virtual int switches() const { return 0; }
    /// Writes their values in the state x. The function must not allocate memory.
    virtual void switching(const State& /*x*/, double* /*out*/) const {}

    /// The end of an interval of time
    struct SmoothTime {
        double end;             ///< [s]
        bool is_break = false;  ///< whether a load or a prescribed motion is not smooth there
    };
    /// The end of the longest interval from t, at most to t_end, over which loads and prescribed motions are
    /// smooth functions of time that the steps of an adaptive scheme resolve: the interval has no pulse that
    /// is short against it.
    virtual SmoothTime smooth_until(double /*t*/, double t_end) const { return {t_end}; }
    /// Whether a prescribed velocity jumps in (t, t_end], by which the velocities change by an impulse.
    /// Called for each step of fixed length.
    virtual bool velocity_jumps(double /*t*/, double /*t_end*/) const { return false; }
    /// Whether the state counts revolutions, which are lost if bodies turn relative to each other by half a
    /// turn or more from one call of accepted() to the next
    virtual bool counts_turns() const { return false; }

    /// Potential energy of the conservative loads [J]
    virtual double potential_energy(const State&) const { return 0; }
    /// Updates the discrete and internal states of `after`, and the multipliers of the rows whose meaning
    /// changes with these states. Called once for each accepted step. While the step is computed, `after` has
    /// the discrete and internal states of `before`.
    virtual void accepted(const State& /*before*/, State& /*after*/) const {}
    /// Whether the rows may be dependent, at all times or in singular configurations. The saddle matrix is
    /// then regularised (Saddle::set_shift), and the multipliers are those of minimum norm.
    virtual bool keeps_redundant_rows() const { return false; }
    /// Whether the solution depends on the history through State::internal_state, as with a friction law. If
    /// not, internal states only select among equivalent forms of the equations, such as the number of
    /// revolutions.
    virtual bool internal_states_are_history() const { return true; }
    /// Name of row k for messages, e.g. constraint 'crank-rod' row 2; bodies 'crank', 'rod'
    virtual std::string row_name(int k) const { return "constraint row " + std::to_string(k); }
    /// Name of body b for messages
    virtual std::string body_name(int b) const { return "body " + std::to_string(b); }
};

/// The states on both sides of a break point of time (System::smooth_until) are this far from it [s]: some
/// rounding errors
inline double break_distance(double t) { return 32 * std::numeric_limits<double>::epsilon() * std::abs(t); }

/// Kinetic energy plus potential energy of the conservative loads [J]
double energy(const System& system, const State& x);

}  // namespace hilda::lie
