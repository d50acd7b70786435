// SPDX-License-Identifier: GPL-3.0-or-later
/// Applied forces and torques.

#pragma once

#include "dae/body.hpp"
#include "dae/outputs/quantity.hpp"
#include "io/expression.hpp"
#include "lie/loads.hpp"

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hilda::lie {
struct Scheme;
}

namespace hilda::dae {

using lie::LoadEvaluation;
class DerivativeFindings;

/// An applied load on one or more bodies. Derive from Force to add a force law.
///
/// A force is constant during a run. Everything that changes is in the state.
class Force {
public:
    virtual ~Force() = default;

    /// Adds the loads in the state x to F [N, global frame, at the centre of mass] and n̄ [N m, body frame]
    /// of the bodies. The result may depend on x only. The function must not allocate memory.
    virtual void add(const State& x, lie::Loads& out) const = 0;
    /// Potential energy [J], or 0 for a force without potential
    virtual double potential_energy(const State&) const { return 0; }

    /// The functions of the state whose zeros are the places where the force has a kink or a jump, such as
    /// the distance to a stop. Adaptive schemes end a step where one of them changes its sign; without them
    /// they may step over the place.
    virtual int switches() const { return 0; }
    /// Writes their values in the state x; NaN where there is none. The function must not allocate memory.
    virtual void switching(const State& /*x*/, double* /*out*/) const {}
    /// The expressions in t on which the force depends. Adaptive schemes end a step where one of them jumps
    /// or has a kink, and do not step over a pulse.
    virtual std::vector<io::Expression> functions_of_time() const { return {}; }
    double start_time = -std::numeric_limits<double>::infinity();  ///< of the run [s], set by the model

    /// The quantities that values() computes, for the output
    virtual std::vector<Quantity> quantities() const { return {}; }
    /// The quantities in the state x. The function must not allocate memory.
    virtual void values(const State& /*x*/, double* /*out*/) const {}
    /// The two points between which the force acts; none for a force without points
    virtual std::optional<PointPair> points() const { return {}; }

    /// Reason why the force cannot be used from the start x, in the form "what is wrong, got value". An empty
    /// string if it can. It is called first at a start: x has no internal states yet, and its positions and
    /// velocities are not yet projected onto the constraints.
    virtual std::string start_error(const State& /*x*/) const { return {}; }

    /// Number of discrete states in State::discrete_state, such as the revolutions of a torsion spring, and
    /// of internal states in State::internal_state, such as the elastic displacement of a friction law
    virtual int discrete_states() const { return 0; }
    virtual int internal_states() const { return 0; }
    /// Updates both kinds of states in x. It is called at a start, where all are zero, and once per accepted
    /// step: x is then the state after the step, with the discrete and internal states of the state before
    /// it. The function must not allocate memory.
    virtual void update_internal_state(State& /*x*/) const {}
    /// Throws NumericalFailure "step_too_large" if the states cannot be updated over a step of this size.
    /// `after` has the discrete and internal states of `before`. Called before update_internal_state().
    virtual void check_step(const State& /*before*/, const State& /*after*/) const {}
    /// Whether update_internal_state() reads x.lambda. A start then iterates until the loads and the
    /// multipliers are consistent.
    virtual bool internal_state_uses_multipliers() const { return false; }
    int first_discrete_state = 0, first_internal_state = 0;  ///< indices into the state, set by the model

    /// A direction in which the force acts as a linear spring and damper. Its deflection S has the rate
    /// Ṡ = r_i · ṙ_i + pi_i · ω̄_i + r_j · ṙ_j + pi_j · ω̄_j, with i and j from bodies() [m/s or rad/s].
    struct SpringRow {
        Vec3 r_i = Vec3::Zero(), pi_i = Vec3::Zero();  ///< global frame, body frame
        Vec3 r_j = Vec3::Zero(), pi_j = Vec3::Zero();
        double stiffness = 0, damping = 0;  ///< [N/m], [N s/m] or [N m/rad], [N m s/rad]
        double gamma = 0;                   ///< S̈ for constant ṙ and ω̄ [m/s² or rad/s²]
    };
    static constexpr int most_spring_rows = 6;
    /// Largest number of spring rows, at most most_spring_rows
    virtual int max_spring_rows() const { return 0; }
    /// Writes the springs and dampers of the force in the state x, at most max_spring_rows(), and returns
    /// their number. The function must not allocate memory.
    virtual int spring_rows(const State& /*x*/, SpringRow* /*out*/) const { return 0; }
    /// A spring of friction that can hold the bodies of the force at rest, with one row, or with two rows and
    /// a common stiffness and bound. The force f of a row k exerts the loads -f row[k]. See
    /// dae/start/static_friction.hpp.
    struct StaticSpring {
        std::array<SpringRow, 2> row;
        int rows = 0;
        double bound = 0;          ///< of |f| while the bodies stick [N, N m]
        double bound_of_slip = 0;  ///< of |f| while they slip
        /// Its name for the warning if it cannot hold the bodies; nullptr: no warning
        const char* name = nullptr;
    };
    /// Largest number of such springs
    virtual int max_static_springs() const { return 0; }
    /// Writes the springs in the state x, at most max_static_springs(), and returns their number.
    virtual int static_springs(const State& /*x*/, StaticSpring* /*out*/) const { return 0; }
    /// The force of a spring at a start
    struct StaticForce {
        Eigen::Vector2d f = Eigen::Vector2d::Zero();
        bool slips = false;
    };
    /// Sets the deflections in x to those of the forces of static_springs().
    virtual void set_static_forces(State& /*x*/, const StaticForce* /*forces*/) const {}
    /// Whether the spring rows describe the force in every state, so that `implicit` may be set. The bodies
    /// of the rows are those of bodies().
    virtual bool may_be_implicit() const { return false; }
    /// Whether integrators evaluate the spring rows implicitly if they can (lie::Feature::springs).
    /// The force then has no stability limit with them.
    bool implicit = false;
    /// Stability limits of the steps for an explicit evaluation of the spring rows, with the effective masses
    /// of the constrained bodies at the start [s]; set by dae::start(), see dae/forces/spring_limits.hpp
    struct SpringLimits {
        double at_step = std::numeric_limits<double>::infinity();
        double extrapolated = std::numeric_limits<double>::infinity();
    } spring_limits;

    /// Stability limit of the step [s] for schemes that evaluate this force explicitly, at the beginning of a
    /// step: the smallest h for which 4 M - 2 d h D - h² K is singular. d is 1 for a scheme whose loads
    /// contain the velocities of the last step, and 2 if they contain velocities extrapolated to the node.
    /// The default is spring_limits.
    virtual double stable_step(const State& /*x*/, LoadEvaluation evaluation = LoadEvaluation::at_step) const
    {
        return evaluation == LoadEvaluation::at_step        ? spring_limits.at_step
               : evaluation == LoadEvaluation::extrapolated ? spring_limits.extrapolated
                                                            : std::numeric_limits<double>::infinity();
    }
    /// The contacts that a stability limit counts: those whose surfaces touch or nearly touch in the state,
    /// or those that are in contact according to the internal state
    enum class Counted { near, touching };
    /// Whether the force is such a contact. The limits of contacts divide the mass of a body equally among
    /// its contacts.
    virtual bool is_counted(const State& /*x*/, Counted) const { return false; }
    /// stable_step() with the numbers of near contacts of each body, see Model::count_contacts(). The caller
    /// counts once for many forces.
    virtual double stable_step_with(const State& x, LoadEvaluation evaluation,
                                    std::span<const int> /*near*/) const
    {
        return stable_step(x, evaluation);
    }
    /// stable_step_with() for the loads of a scheme. Infinite if it evaluates this force implicitly.
    double stable_step_in(const lie::Scheme& scheme, const State& x, std::span<const int> near) const;
    bool is_implicit_in(const lie::Scheme& scheme) const;
    /// Whether a step h [s] is within the stability limit for the present stiffness and damping, with the
    /// numbers of touching contacts of each body. Called for each accepted step; the function must not
    /// allocate memory.
    virtual bool is_stable(const State& x, double h, LoadEvaluation evaluation,
                           std::span<const int> /*touching*/) const
    {
        return !(h > stable_step(x, evaluation));
    }
    /// Whether the force cannot supply energy: the work that it does is at most the decrease of
    /// potential_energy() + internal_energy()
    virtual bool is_passive() const { return false; }
    /// Whether the force may dissipate energy. If none of a passive model does, its energy is constant.
    virtual bool is_dissipative() const { return true; }
    /// Energy of springs whose deflections are internal states, such as those of friction [J]
    virtual double internal_energy(const State& /*x*/) const { return 0; }

    /// The bodies on which the force acts, if it depends on the motion of these bodies only; `ground` fills
    /// an unused place. Schemes with an exact Newton matrix differentiate the force by the motions of these
    /// bodies. With the default, two times `ground`, the force does not contribute to the Newton matrix.
    virtual std::array<int, 2> bodies() const { return {ground, ground}; }
    /// The derivatives of the loads (F, n̄ of the first of bodies(); F, n̄ of the second) by (δr, δθ̄ of the
    /// first; δr, δθ̄ of the second; δṙ, δω̄ of the first; δṙ, δω̄ of the second), with A ← A exp(δθ̄~)
    using LoadDerivatives = Eigen::Matrix<double, 12, 24>;
    /// Sets the derivatives in the state x and returns true. The default, false, is for forces without closed
    /// formulas: the model computes differences. The function must not allocate memory.
    virtual bool load_derivatives(const State& /*x*/, LoadDerivatives& /*out*/) const { return false; }

    /// Compares the functions of the parts of this force, such as surfaces and contact laws, with
    /// differences. The load derivatives are compared without it. See dae/start/derivative_check.hpp.
    virtual void check_derivatives(const State& /*x*/, DerivativeFindings& /*out*/) const {}

    /// Highest number of the bodies on which the force acts
    virtual int last_body() const = 0;
    std::string name;
    /// Type and name for messages
    virtual std::string label() const { return "force '" + name + "'"; }

protected:
    /// Motion of body b. The ground is at rest at the origin.
    static const Motion& motion(const State& x, int b) { return dae::motion(x, b); }

    /// Adds a force F [N, global frame] that acts at the point s_bar [m, body frame] of body b, and its
    /// moment about the centre of mass. Does nothing for the ground.
    static void apply_force(int b, const Vec3& F, const Vec3& s_bar, const State& x, lie::Loads& out)
    {
        if (b == ground) return;
        out.F[b] += F;
        out.n_bar[b] += s_bar.cross(x.body[b].A.transpose() * F);
    }
};

}  // namespace hilda::dae
