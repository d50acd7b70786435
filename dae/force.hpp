// SPDX-License-Identifier: GPL-3.0-or-later
/// What acts on the bodies besides constraints. Derive from Force for a law of your own.

#pragma once

#include "dae/body.hpp"
#include "lie/system.hpp"

#include <array>
#include <limits>
#include <string>

namespace hilda::dae {

class Force {
public:
    virtual ~Force() = default;

    /// Adds to F [N, global, at the centre of mass] and n̄ [N m, body frame] of the bodies it acts on. Must
    /// depend on the state alone, and allocate nothing.
    virtual void add(const State& x, lie::Loads& out) const = 0;
    /// Potential energy [J] where the force has one
    virtual double potential_energy(const State&) const { return 0; }

    /// Why the force cannot be used from the start x; empty when it can. Asked before anything else, when x
    /// does not have its memory yet, and before positions and velocities are put on the constraints.
    virtual std::string objection(const State& /*x*/) const { return {}; }

    /// How many whole numbers this force keeps in State::memory from step to step (turns of a torsion spring),
    /// and how many real ones in State::remembered (a contact point, the stretch of a bristle).
    virtual int discrete_states() const { return 0; }
    virtual int internal_states() const { return 0; }
    /// Brings both up to date: at a start, where all are zero, and once per accepted step, for the state after
    /// it, which comes with what was remembered in the state before. Allocates nothing.
    virtual void update_internal_state(State& /*x*/) const {}
    /// Whether remember() reads the multipliers of x. A start then repeats itself until they and the loads agree.
    virtual bool internal_state_uses_multipliers() const { return false; }
    int first_discrete_state = 0, first_internal_state = 0;  ///< where they begin; set by the model

    /// The largest step [s] with which a scheme that takes this force as it is at the beginning of the step is
    /// stable
    virtual double stable_step(const State& /*x*/) const { return std::numeric_limits<double>::infinity(); }

    /// The bodies whose motion it depends on, and on which alone it acts; `ground` for none. A force that says
    /// so is differentiated where a scheme wants its stiffness.
    virtual std::array<int, 2> bodies() const { return {ground, ground}; }

    /// Highest body number it acts on, and a name for messages
    virtual int last_body() const = 0;
    std::string name;
    /// What messages call it
    virtual std::string in_words() const { return "force '" + name + "'"; }

protected:
    /// The ground stands still at the origin.
    static const Motion& motion(const State& x, int b)
    {
        static const Motion at_rest;
        return b == ground ? at_rest : x.body[b];
    }

    /// A force F [N, global] at the point s_bar of body b
    static void push(int b, const Vec3& F, const Vec3& s_bar, const State& x, lie::Loads& out)
    {
        if (b == ground) return;
        out.F[b] += F;
        out.n_bar[b] += s_bar.cross(x.body[b].A.transpose() * F);
    }
};

}  // namespace hilda::dae
