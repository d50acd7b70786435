// SPDX-License-Identifier: GPL-3.0-or-later
/// What acts on the bodies besides constraints. Derive from Force for a law of your own.

#pragma once

#include "dae/body.hpp"
#include "lie/system.hpp"

#include <array>

namespace hilda::dae {

class Force {
public:
    virtual ~Force() = default;

    /// Adds to F [N, global, at the centre of mass] and n̄ [N m, body frame] of the bodies it acts on. Must
    /// depend on the state alone, and allocate nothing.
    virtual void add(const State& x, lie::Loads& out) const = 0;
    /// Potential energy [J] where the force has one
    virtual double potential_energy(const State&) const { return 0; }

    /// Whole numbers this force keeps in State::memory from step to step (turns of a torsion spring), and
    /// where they start.
    virtual int memory() const { return 0; }
    virtual void remember(State& /*x*/) const {}
    int first_memory = 0;  ///< set by the model

    /// The bodies whose motion it depends on, and on which alone it acts; `ground` for none. A force that says
    /// so is differentiated where a scheme wants its stiffness.
    virtual std::array<int, 2> bodies() const { return {ground, ground}; }

    /// Highest body number it acts on, and a name for messages
    virtual int last_body() const = 0;
    std::string name;

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
