// SPDX-License-Identifier: GPL-3.0-or-later
/// A multibody model of bodies, constraints and forces. It implements lie::System and is constant during a
/// run.

#pragma once

#include "dae/block.hpp"
#include "dae/constraints/contact_constraint.hpp"
#include "dae/forces/near_forces.hpp"
#include "dae/forces/rigid_contacts.hpp"
#include "lie/check.hpp"
#include "lie/system.hpp"
#include "lie/tree/tree.hpp"

#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>

namespace hilda::dae {

class FunctionOfTime;
class TurnCounter;

/// Invalid input of one constraint. what() gives the name of the row and of its bodies.
class ConstraintError : public lie::InvalidInput {
public:
    ConstraintError(const std::string& what, int constraint, bool general = false)
        : InvalidInput(what), constraint(constraint), general(general)
    {}

    int constraint;  ///< its number in the model, counted from 0, or its index in Model::general_constraints()
    bool general;    ///< whether it is a general constraint, such as an evolving contact
};

/// Invalid input of one force. what() gives its name.
class ForceError : public lie::InvalidInput {
public:
    ForceError(const std::string& what, int force) : InvalidInput(what), force(force) {}

    int force;  ///< its number, see Model::for_forces()
};

/// A multibody model.
///
/// Build it with add(), constrain() and load(), then call dae::start() to obtain a consistent state. The
/// number of a body is its index; `ground` is the fixed body. The rows of the equations are the rows of the
/// blocks, in the order in which they were added and without redundant ones, then the position rows of the
/// general constraints, then their velocity rows.
class Model final : public lie::System {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²], global frame
    /// Whether start() keeps redundant rows in the equations, instead of removing those that are redundant in
    /// the initial state. Mechanisms that pass through singular configurations need it.
    bool keep_redundant = false;

    /// Adds a body and returns its number. Throws lie::InvalidInput for a name that is empty, "ground" or
    /// already used, and for invalid mass properties (Body::validate).
    int add(Body body);
    /// Number of a body, `ground` for "ground". Throws lie::InvalidInput for an unknown name.
    int find(const std::string& name) const;
    const std::vector<Body>& all_bodies() const { return body; }

    /// Adds a constraint that consists of these rows: one block, or a joint of joints.hpp. Throws
    /// lie::InvalidInput for a name that is already used, an unknown body number, and equal bodies i and j.
    void constrain(const std::string& name, Blocks rows);
    template <class B>
    requires std::derived_from<B, Block>
    void constrain(const std::string& name, B block)
    {
        Blocks rows;
        rows.push_back(std::make_unique<B>(std::move(block)));
        constrain(name, std::move(rows));
    }

    /// Adds a general constraint. Its rows follow those of all blocks. Throws as for blocks.
    void constrain(const std::string& name, std::unique_ptr<Constraint> constraint);
    const std::vector<std::unique_ptr<Constraint>>& general_constraints() const { return general_constraint; }
    /// Where a constraint of this model has its rows, and its numbers in the state
    static const Constraint::Place& place(const Constraint& c) { return c.place; }
    /// Arguments of a constraint in the state x. They refer to x.
    Constraint::Arguments arguments(const Constraint& c, const State& x) const
    {
        return {motion(x, c.i),
                motion(x, c.j),
                x.t,
                x.alpha.data() + c.place.alpha,
                x.internal_state.data() + c.place.internal_state,
                mode(c, x),
                &x.lambda,
                c.place.row,
                c.place.velocity_row};
    }
    /// The same for a row of a joint, which has no algebraic variables and is always active
    static Constraint::Arguments arguments(const Block& row, const State& x)
    {
        return {motion(x, row.i), motion(x, row.j), x.t, nullptr,
                x.internal_state.data() + row.place.internal_state};
    }
    /// Whether a constraint is switched off. Its rows are then zero.
    static bool inactive(const Constraint& c, const State& x) { return mode(c, x) != Constraint::active; }
    /// Mode of a constraint, see Constraint::Size::may_be_inactive
    static int mode(const Constraint& c, const State& x)
    {
        return c.place.discrete_state < 0 ? Constraint::active : x.discrete_state[c.place.discrete_state];
    }
    /// Sets the mode in x, and the multipliers of the constraint to zero.
    static void set_mode(const ContactConstraint& c, State& x, int mode);
    std::string name_of(const Constraint& c) const;

    /// Adds a force. Throws lie::InvalidInput for an unknown body number.
    void load(std::unique_ptr<Force> force);
    template <class F>
    requires std::derived_from<F, Force>
    void load(F force) { load(std::make_unique<F>(std::move(force))); }
    const std::vector<std::unique_ptr<Force>>& forces() const { return force; }
    /// Adds forces between many pairs of bodies, of which the near pairs are evaluated.
    void load(std::unique_ptr<ForceGroup> group) { near.add(std::move(group)); }
    /// The forces of the groups
    const NearForces& near_forces() const { return near; }
    /// Adds rigid contacts. InvalidInput for more than 2^31 pairs in all.
    void contact(std::unique_ptr<RigidContacts> contacts);
    const std::vector<std::unique_ptr<RigidContacts>>& rigid_contacts() const { return rigid; }
    /// Calls f(force, number) for each force of forces() and then for the near pairs of the groups in x. The
    /// numbers of the pairs follow those of forces().
    template <class F>
    void for_forces(const State& x, F f) const
    {
        for (size_t k = 0; k < force.size(); ++k) f(*force[k], static_cast<int>(k));
        const auto others = static_cast<int>(force.size());
        near.visit(x, [&](const Force& one, int number) { f(one, others + number); });
    }
    /// The force with a number of for_forces(). That of a pair has the states of a pair that is not near.
    std::shared_ptr<const Force> force_of(int number) const;
    /// Adds an angle whose turns the state counts. It is not one of the forces.
    void count(std::shared_ptr<TurnCounter> angle);
    /// Indices of the forces that have this body among their bodies(), ascending
    std::span<const int> forces_on(int body) const;

    /// Number of contacts of each body in the state x, for Force::stable_step_with() and is_stable()
    void count_contacts(const State& x, Force::Counted which, std::vector<int>& of_body) const;
    /// Weight of all bodies [N]: the largest static load of a contact
    double weight() const { return total_mass * gravity.norm(); }

    /// Whether the sizes of the discrete and internal states of a state, such as one from a checkpoint, fit.
    bool fits(const State& x) const;
    /// Prepares the model and the state for a run from x. Called by dae::start().
    ///
    /// - All rows become part of the equations again, also those removed by drop().
    /// - Orientations, blocks, forces and general constraints are checked. Throws lie::InvalidInput,
    ///   ConstraintError or ForceError.
    /// - DP1 drivers receive their complement.
    /// - x.discrete_state, x.internal_state and x.alpha are set, and x.lambda is resized and set to zero.
    void prepare(State& x);
    /// Sets the internal states of forces and general constraints to those of a start in x. Called by
    /// prepare(), and by dae::start() when x satisfies the constraints.
    void set_internal_state_at_start(State& x) const;

    /// Smallest stability limit of the forces for an integrator with this evaluation of the loads. An
    /// implicit evaluation has no limit for springs and dampers (Force::spring_rows); contacts keep theirs.
    struct StableStep {
        double h = std::numeric_limits<double>::infinity();  ///< [s]
        int force = -1;  ///< number of the force, see for_forces(); -1 if no force has a limit
    };
    StableStep stable_step(const State& x, LoadEvaluation evaluation = LoadEvaluation::at_step) const;
    /// The same for a scheme, which may evaluate springs implicitly
    StableStep stable_step(const State& x, const lie::Scheme& scheme) const;

    /// Earliest end of the motions that drivers prescribe by samples
    struct MotionEnd {
        double t = std::numeric_limits<double>::infinity();  ///< [s]
        int constraint = -1;  ///< number of the constraint, -1 if there are no samples
    };
    MotionEnd motion_end() const;

    /// A scalar row of a constraint. It is part of the equations, or removed from them as redundant.
    struct Row {
        std::unique_ptr<Block> block;
        std::unique_ptr<Block> complement;  ///< of a DP1 driver, else empty
        int branch = -1;     ///< index into State::discrete_state: 1 while the complement is active
        int constraint = 0;  ///< number of its constraint, counted from 0
        int number = 0;      ///< row number within its constraint, counted from 1

        /// The block, or its complement while that is active
        const Block& active_block(const State& x) const
        {
            return complement && x.discrete_state[branch] == 1 ? *complement : *block;
        }
    };
    const std::vector<Row>& all_rows() const { return row; }
    /// Numbers of the rows that are part of the equations, and of those removed as redundant; ascending
    const std::vector<int>& active_rows() const { return active; }
    const std::vector<int>& dropped_rows() const { return dropped; }
    void drop(const std::vector<int>& rows);  ///< removes rows from the equations
    const std::string& constraint_name(int constraint) const { return constraint_names[constraint]; }
    int constraints() const { return static_cast<int>(constraint_names.size()); }
    std::string name_of(const Row& row) const;

    /// Residual of one row divided by the length of its first variation |(Φ_r, Π̄)|, an error in m or rad: Φ,
    /// then Φ_r ṙ + Π̄ ω̄ - ν per second, then Φ_r r̈ + Π̄ ω̄̇ - γ per second². Defined for removed rows as
    /// well.
    double scaled_residual(const Row& row, const State& x) const;
    double scaled_velocity_residual(const Row& row, const State& x) const;
    double scaled_acceleration_residual(const Row& row, const State& x) const;
    /// A largest scaled residual and its row
    struct Residual {
        double value = 0;
        int row = -1;  ///< in all_rows(), or in `constraint` if it is set; -1 if there are no rows
        const Constraint* constraint = nullptr;

        /// Takes |error| if it is larger. NaN counts as larger than any number, so that it is not lost.
        void include(double error, int row, const Constraint* constraint = nullptr);
    };
    /// Set of rows: all, including removed ones; those in the equations; those of blocks, including removed
    /// ones
    enum class RowSet { all, in_equations, blocks };
    /// Largest residual of Φ in magnitude. The rows of active general constraints are not scaled.
    Residual largest_residual(const State& x, RowSet over = RowSet::all) const;
    Residual largest_velocity_residual(const State& x) const;  ///< over the rows of blocks
    std::string name_of(const Residual& residual) const;       ///< name of its row, or an empty string

    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const State& x, lie::Loads& out) const override;
    void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void variation(const State& x, lie::Rows& out) const override;
    void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override;
    void update_alpha(State& x) const override;
    std::vector<lie::BoundedPair> bounded_pairs() const override;
    void update_pairs(const State& x, std::vector<lie::BoundedPair>& pair) const override;
    bool has_cones() const override { return !rigid.empty(); }
    void cones(const State& x, double h, lie::ConeRows& out) const override;
    std::string cone_name(std::uint64_t key) const override;
    /// The spring rows of the forces with Force::implicit
    lie::Springs spring_pattern() const override;
    void update_springs(const State& x, lie::Springs& out) const override;
    /// The largest residual of the rows in the equations; see largest_residual()
    PositionError position_error(const State& x) const override;
    void second_variation(const State& x, lie::SecondVariation& out) const override;
    void nu_variation(const State& x, lie::Rows& out) const override;
    void gamma_variation(const State& x, lie::GammaVariation& out) const override;
    /// Derivatives of the forces whose bodies() are known, by central differences
    lie::LoadVariation load_pattern() const override;
    void load_variation(const State& x, lie::LoadVariation& out) const override;
    bool keeps_redundant_rows() const override { return keep_redundant; }
    int switches() const override { return switching_functions; }
    void switching(const State& x, double* out) const override;
    /// Throws NumericalFailure "motion_jumps" if a prescribed motion jumps at the end of the interval.
    SmoothTime smooth_until(double t, double t_end) const override;
    /// Throws NumericalFailure "motion_jumps" if a prescribed motion jumps itself.
    bool velocity_jumps(double t, double t_end) const override;
    bool counts_turns() const override { return block_counts_turns; }
    const lie::Tree& tree() const override { return joints; }
    /// Finds the tree of the joints in a consistent state. Called by dae::start().
    void set_tree(const State& x);
    double potential_energy(const State& x) const override;
    /// Replaces DP1 drivers near |f| = |a_i||a_j| by their complement, with the multiplier that gives the
    /// same torque, and updates the internal states of forces, general constraints and counted angles.
    void accepted(const State& before, State& after) const override;
    /// Whether a force or a contact has internal states
    bool internal_states_are_history() const override;
    std::string row_name(int k) const override;
    std::string body_name(int b) const override { return b == ground ? "ground" : body[b].name; }

private:
    template <class F>
    void for_rows_without_alpha(const State& x, F f) const;
    template <class LimitOf>
    StableStep smallest_limit(const State& x, LimitOf limit_of) const;
    void swap_drivers(State& x) const;
    void update_constraint_states(State& x, bool start) const;
    void set_switches(double t);
    void set_pattern();
    void add_to_pattern(int row);
    void add_to_pattern(const Constraint& c, int first, int rows);
    std::string name_of(const Constraint& c, int k) const;  ///< name of its row k

    std::vector<Body> body;
    std::unordered_map<std::string, int> number_of_body;  ///< by its name
    std::vector<std::string> constraint_names;
    std::unordered_set<std::string> used_names;  ///< names of all constraints
    std::vector<Row> row;
    std::vector<int> active, dropped;  ///< ascending
    /// The active rows: those evaluated together, and the others
    std::vector<PointRows> point_rows;
    struct SingleRow {
        int row, number, entry;  ///< index in `row`, number in the equations, first entry
    };
    std::vector<SingleRow> single_rows;
    std::vector<std::unique_ptr<Constraint>> general_constraint;
    std::vector<ContactConstraint*> contacts;  ///< those of them that are contacts
    std::vector<std::unique_ptr<Force>> force;
    std::vector<std::vector<int>> forces_on_body;
    NearForces near;
    std::vector<std::unique_ptr<RigidContacts>> rigid;
    std::vector<std::shared_ptr<TurnCounter>> counters;
    int discrete_states = 0, internal_states = 0;  ///< sizes in the state
    int switching_functions = 0;                   ///< of all forces
    bool block_counts_turns = false;
    struct TimeFunction {
        std::shared_ptr<const FunctionOfTime> f;
        int driven = -1;  ///< number of the row that prescribes it; -1 for a load
    };
    std::vector<TimeFunction> functions_of_time;
    size_t driven_functions = 0;  ///< index of the first one that a driver prescribes
    bool drivers_have_breaks = false;
    void refuse_jump(const TimeFunction& of, double t) const;

    lie::Mass inertia;
    double total_mass = 0;  ///< of all bodies [kg]
    lie::Rows rows_pattern;
    lie::Tree joints{.joint = {}, .refusal = "the model has not been started"};
};

/// Resultant constraint force F = -Φ_rᵀ λ [N, global frame] and torque T = -Π̄ᵀ λ [N m, body frame] on one
/// body. They do not depend on the scaling and order of the rows, nor on the choice between a driver and its
/// complement.
struct Reaction {
    Vec3 F = Vec3::Zero(), T = Vec3::Zero();
};
std::vector<Reaction> reactions(const lie::System& system, const State& x);
/// The same without memory allocation. C is a copy of system.pattern() and receives the rows.
void reactions(const lie::System& system, const State& x, lie::Rows& C, std::vector<Reaction>& out);

}  // namespace hilda::dae
