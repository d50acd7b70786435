// SPDX-License-Identifier: GPL-3.0-or-later
/// A multibody model: bodies, constraints, forces. Constant while a run lasts; it is a lie::System.

#pragma once

#include "dae/block.hpp"
#include "dae/constraint.hpp"
#include "dae/force.hpp"
#include "lie/check.hpp"

#include <memory>
#include <unordered_set>

namespace hilda::dae {

using Blocks = std::vector<std::unique_ptr<Block>>;

/// Input that one constraint cannot work with. what() names its row and bodies.
class ConstraintError : public lie::InvalidInput {
public:
    ConstraintError(const std::string& what, int constraint) : InvalidInput(what), constraint(constraint) {}

    int constraint;  ///< its number in the model, from 0
};

/// Input that one force cannot work with. what() names it.
class ForceError : public lie::InvalidInput {
public:
    ForceError(const std::string& what, int force) : InvalidInput(what), force(force) {}

    int force;  ///< its number in the model, from 0
};

/// Input that one constraint with unknowns, a contact that evolves, cannot work with. what() names it.
class ContactError : public lie::InvalidInput {
public:
    ContactError(const std::string& what, int contact) : InvalidInput(what), contact(contact) {}

    int contact;  ///< its number in Model::evolving(), from 0
};

class Model final : public lie::System {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²], global

    /// Adds a body and returns its number. InvalidInput for a name already taken (also "ground") or inertia
    /// that is none.
    int add(Body body);
    /// The number of a body, `ground` for "ground". InvalidInput for a name that is not there.
    int find(const std::string& name) const;
    const std::vector<Body>& all_bodies() const { return body; }

    /// Adds a named constraint made of these rows: one block, or a joint from joints.hpp.
    void constrain(const std::string& name, Blocks rows);
    template <class B>
    requires std::derived_from<B, Block>
    void constrain(const std::string& name, B block)
    {
        Blocks rows;
        rows.push_back(std::make_unique<B>(std::move(block)));
        constrain(name, std::move(rows));
    }

    /// Adds a constraint with unknowns of its own; its rows come after those of all blocks.
    void constrain(const std::string& name, std::unique_ptr<Constraint> constraint);
    const std::vector<std::unique_ptr<Constraint>>& evolving() const { return with_unknowns; }
    /// Where one of them stands in a state
    Constraint::At at(const Constraint& c, const State& x) const
    {
        return {motion(x, c.i),
                motion(x, c.j),
                x.t,
                x.alpha.data() + c.first_alpha,
                x.internal_state.data() + c.first_internal_state,
                inactive(c, x),
                &x.lambda};
    }
    /// Whether it holds nothing at present, being open or handed over. Its rows are then empty.
    static bool inactive(const Constraint& c, const State& x) { return mode(c, x) != Constraint::active; }
    static int mode(const Constraint& c, const State& x)
    {
        return c.may_be_inactive() ? x.discrete_state[c.first_discrete_state] : Constraint::active;
    }
    /// Takes its multipliers out of the state, too.
    static void set_mode(const Constraint& c, State& x, Constraint::Mode mode);
    std::string name_of(const Constraint& c) const;

    void load(std::unique_ptr<Force> force);
    template <class F>
    requires std::derived_from<F, Force>
    void load(F force) { load(std::make_unique<F>(std::move(force))); }
    const std::vector<std::unique_ptr<Force>>& forces() const { return force; }

    /// Readies the model for a run from x: puts dropped rows back, asks every body whether its orientation is
    /// one and every block, every force and every contact whether it can be used there (ConstraintError, ForceError,
    /// ContactError), gives DP1 drivers their complement, and sets x.memory, x.remembered, x.alpha and the size of x.lambda. Called
    /// by start().
    void prepare(State& x);
    /// Lets the forces remember a start in x, whatever they remembered before. Called by prepare(), and by
    /// start() once x is on the constraints.
    void set_internal_state_at_start(State& x) const;

    /// Smallest stable_step() of the forces, and the force that has it; -1 where any step is stable.
    struct StableStep {
        double h = std::numeric_limits<double>::infinity();  ///< [s]
        int force = -1;
    };
    StableStep stable_step(const State& x) const;

    /// A row of a constraint, in the equations or dropped from them.
    struct Row {
        std::unique_ptr<Block> block;
        std::unique_ptr<Block> complement;  ///< of a DP1 driver: in force while memory[branch] is 1
        int branch = -1;                    ///< index into State::memory
        int constraint = 0;
        int number = 0;  ///< within its constraint, from 1

        const Block& in_force(const State& x) const
        {
            return complement && x.discrete_state[branch] == 1 ? *complement : *block;
        }
    };
    const std::vector<Row>& all_rows() const { return row; }
    const std::vector<int>& active_rows() const { return active; }  ///< numbers of the rows in the equations
    const std::vector<int>& dropped_rows() const { return dropped; }
    void drop(int row);  ///< takes a row out of the equations
    const std::string& constraint_name(int constraint) const { return constraint_names[constraint]; }
    int constraints() const { return static_cast<int>(constraint_names.size()); }
    std::string name_of(const Row& row) const;

    /// Φ of one row, also a dropped one, over the length of its variation: an error in m or rad.
    double scaled_residual(const Row& row, const State& x) const;
    /// The same of Φ_r ṙ + Π̄ ω̄ - ν and of Φ_r r̈ + Π̄ ω̄̇ - γ
    double scaled_velocity_residual(const Row& row, const State& x) const;
    double scaled_acceleration_residual(const Row& row, const State& x) const;
    /// A scaled residual and the row that has it: of all_rows(), or, where there is one, of this constraint with unknowns
    struct Residual {
        double value = 0;
        int row = -1;  ///< none without rows
        const Constraint* of = nullptr;

        /// Takes this error if it is larger. What is not a number is the largest.
        void consider(double error, int row, const Constraint* of = nullptr);
    };
    /// The largest in magnitude, over all rows including the dropped ones, over those in the equations, or over those of
    /// blocks alone; rows of constraints with unknowns count as they are, where these hold.
    enum class Over { all, in_equations, blocks };
    Residual largest_residual(const State& x, Over over = Over::all) const;
    Residual largest_velocity_residual(const State& x) const;  ///< of the blocks
    std::string name_of(const Residual& residual) const;       ///< of its row; empty without one

    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const State& x, lie::Loads& out) const override;
    void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void variation(const State& x, lie::Rows& out) const override;
    void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void update_alpha(State& x) const override;
    void second_variation(const State& x, lie::SecondVariation& out) const override;
    void nu_variation(const State& x, lie::Rows& out) const override;
    void gamma_variation(const State& x, lie::GammaVariation& out) const override;
    /// Of the forces that say which bodies they act on; by differences
    lie::LoadVariation load_pattern() const override;
    void load_variation(const State& x, lie::LoadVariation& out) const override;
    double potential_energy(const State& x) const override;
    /// Swaps DP1 drivers that come near |f| = 1 for their complement, with the multiplier that gives the same
    /// torque, and lets forces remember.
    void accepted(const State& before, State& after) const override;
    std::string row_name(int k) const override;
    std::string body_name(int b) const override { return b == ground ? "ground" : body[b].name; }

private:
    void swap_drivers(State& x) const;
    void update_contact_states(State& x, bool start) const;
    void set_pattern();
    void add_to_pattern(const Row& row);
    void add_to_pattern(const Constraint& c, int first, int rows);
    std::string name_of(const Constraint& c, int k) const;  ///< of its row k

    const Motion& motion(const State& x, int b) const { return b == ground ? ground_motion : x.body[b]; }

    std::vector<Body> body;
    std::vector<std::string> constraint_names;
    std::unordered_set<std::string> names_taken;  ///< of constraints
    std::vector<Row> row;
    std::vector<int> active, dropped;  ///< ascending
    std::vector<std::unique_ptr<Constraint>> with_unknowns;
    std::vector<std::unique_ptr<Force>> force;
    int discrete_state = 0, internal_state = 0;  ///< numbers in the state

    lie::Mass inertia;
    lie::Rows rows_pattern;
    const Motion ground_motion{};
};

/// Resultant constraint force [N, global] and torque [N m, body frame] on one body: -Φ_rᵀ λ and -Π̄ᵀ λ. They
/// do not depend on how the constraints are scaled, ordered or swapped.
struct Reaction {
    Vec3 F = Vec3::Zero(), T = Vec3::Zero();
};
std::vector<Reaction> reactions(const lie::System& system, const State& x);
/// The same with rows evaluated into C, a copy of system.pattern(): allocates nothing.
void reactions(const lie::System& system, const State& x, lie::Rows& C, std::vector<Reaction>& out);

}  // namespace hilda::dae
