// SPDX-License-Identifier: GPL-3.0-or-later
/// Construction of a model, preparation of a run, names, residuals and reactions.
#include "dae/model.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/outputs/turn_counter.hpp"
#include "dae/tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hilda::dae {

namespace {

// Largest ‖AᵀA - I‖ of an orientation. Smaller errors, such as rounded digits, are admitted.
constexpr double max_orthogonality_error = 1e-3;

/// Length of the first variation of a row, without the ground
double row_length(const Variation& v, const Block& block)
{
    double sum = 0;
    if (block.i != ground) sum += v.r_i.squaredNorm() + v.pi_i.squaredNorm();
    if (block.j != ground) sum += v.r_j.squaredNorm() + v.pi_j.squaredNorm();
    return std::sqrt(sum);
}

}  // namespace

int Model::add(Body b)
{
    if (b.name.empty()) lie::reject("dae::Model::add", "the name of a body must not be empty", "''");
    if (b.name == "ground")
        lie::reject("dae::Model::add", "the name 'ground' is reserved for the fixed body", "'ground'");
    if (number_of_body.contains(b.name))
        lie::reject("dae::Model::add", "two bodies have the same name", "'" + b.name + "'");
    b.validate();
    const auto number = static_cast<int>(body.size());
    number_of_body.emplace(b.name, number);
    inertia.m.push_back(b.m);
    total_mass += b.m;
    inertia.J_bar.push_back(b.J_bar);
    body.push_back(std::move(b));
    return number;
}

int Model::find(const std::string& name) const
{
    if (name == "ground") return ground;
    const auto found = number_of_body.find(name);
    if (found == number_of_body.end())
        lie::reject("dae::Model::find", "no body has this name", "'" + name + "'");
    return found->second;
}

void Model::constrain(const std::string& name, Blocks rows)
{
    const int bodies = static_cast<int>(body.size());
    for (const auto& block : rows) {
        for (const int b : {block->i, block->j})
            if (b < ground || b >= bodies)
                lie::reject("constraint '" + name + "'", "no body has this number", b);
        if (block->i == block->j)
            lie::reject("constraint '" + name + "'", "the two bodies of a constraint must be different",
                        "'" + body_name(block->i) + "' twice");
    }
    if (!used_names.insert(name).second)
        lie::reject("dae::Model::constrain", "two constraints have the same name", "'" + name + "'");
    int number = 0;
    for (auto& block : rows) {
        active.push_back(static_cast<int>(row.size()));
        row.push_back({.block = std::move(block),
                       .complement = nullptr,
                       .branch = -1,
                       .constraint = constraints(),
                       .number = ++number});
        if (general_constraint.empty()) add_to_pattern(static_cast<int>(row.size()) - 1);
    }
    if (!general_constraint.empty()) set_pattern();  // the rows of general constraints remain the last ones
    constraint_names.push_back(name);
}

void Model::constrain(const std::string& name, std::unique_ptr<Constraint> c)
{
    const int bodies = static_cast<int>(body.size());
    for (const int b : {c->i, c->j})
        if (b < ground || b >= bodies) lie::reject("constraint '" + name + "'", "no body has this number", b);
    if (c->i == c->j)
        lie::reject("constraint '" + name + "'", "the two bodies of a constraint must be different",
                    "'" + body_name(c->i) + "' twice");
    if (!used_names.insert(name).second)
        lie::reject("dae::Model::constrain", "two constraints have the same name", "'" + name + "'");
    const Constraint::Size size = c->size();
    const int of_contact = size.algebraic_variables + size.bounded_pairs + size.may_be_inactive;
    if (of_contact > 0 && c->as_contact() == nullptr)
        lie::reject("constraint '" + name + "'",
                    "algebraic variables, bounded pairs and modes need a dae::ContactConstraint; their "
                    "number must be 0",
                    of_contact);
    c->name = name;
    if (auto* contact = dynamic_cast<ContactConstraint*>(c.get()); contact != nullptr)
        contacts.push_back(contact);
    general_constraint.push_back(std::move(c));
    set_pattern();
}

void Model::contact(std::unique_ptr<RigidContacts> contacts)
{
    const long first = rigid.empty() ? 0 : long{rigid.back()->first_pair} + rigid.back()->numbers();
    if (first + contacts->numbers() > std::numeric_limits<int>::max())
        lie::reject("dae::Model", "the rigid contacts of a model may have at most 2^31 pairs", first);
    contacts->first_pair = static_cast<int>(first);
    rigid.push_back(std::move(contacts));
}

void Model::load(std::unique_ptr<Force> f)
{
    if (f->last_body() >= static_cast<int>(body.size()))
        lie::reject(f->label(), "no body has this number", f->last_body());
    if (f->implicit && !f->may_be_implicit())
        lie::reject(f->label(), "this type of force cannot be evaluated implicitly; implicit must be", false);
    const auto number = static_cast<int>(force.size());
    const std::array<int, 2> on = f->bodies();
    forces_on_body.resize(body.size());
    for (size_t k = 0; k < on.size(); ++k)
        if (on[k] != ground && (k == 0 || on[k] != on[0])) forces_on_body[on[k]].push_back(number);
    force.push_back(std::move(f));
}

std::shared_ptr<const Force> Model::force_of(int number) const
{
    const auto others = static_cast<int>(force.size());
    if (number >= others) return near.force(number - others);
    return {std::shared_ptr<const Force>(), force[static_cast<size_t>(number)].get()};
}

void Model::count(std::shared_ptr<TurnCounter> angle)
{
    if (angle->last_body() >= static_cast<int>(body.size()))
        lie::reject(angle->label(), "no body has this number", angle->last_body());
    counters.push_back(std::move(angle));
}

std::span<const int> Model::forces_on(int b) const
{
    if (b == ground || b >= static_cast<int>(forces_on_body.size())) return {};
    return forces_on_body[b];
}

void Model::prepare(State& x)
{
    if (x.body.size() != body.size())
        lie::reject(
            "dae::Model::prepare",
            "the state must have one motion for each of the " + std::to_string(body.size()) + " bodies",
            x.body.size());
    for (size_t b = 0; b < x.body.size(); ++b) {
        const Mat3& A = x.body[b].A;
        if (!(lie::orthogonality_error(A) < max_orthogonality_error) || A.determinant() < 0)
            lie::reject("body '" + body[b].name + "'", "the orientation must be a rotation matrix", A);
    }
    for (size_t k = 0; k < force.size(); ++k)
        if (const std::string reason = force[k]->start_error(x); !reason.empty())
            throw ForceError(force[k]->label() + ": " + reason, static_cast<int>(k));
    near.set_layout(bodies(), 0, 0);
    if (!near.empty())
        for (const auto list = near.found(x); const NearForces::List::Entry& e : list->entry)
            if (const std::string reason = e.force->start_error(x); !reason.empty()) {
                const std::string& place = near.group_of(e.number).first->place;
                throw ForceError((place.empty() ? "" : place + ": ") + e.force->label() + ": " + reason,
                                 static_cast<int>(force.size()) + e.number);
            }
    discrete_states = internal_states = 0;
    for (Row& r : row) {
        r.block->place.internal_state = internal_states;
        internal_states += r.block->internal_states();
        r.complement.reset();
        r.branch = -1;
        const Constraint::Arguments at{motion(x, r.block->i), motion(x, r.block->j), x.t};
        if (const std::string reason = r.block->start_error(at); !reason.empty())
            throw ConstraintError(name_of(r) + ": " + reason, r.constraint);
        if (const auto* dp1 = dynamic_cast<const DP1*>(r.block.get()); dp1 != nullptr)
            r.complement = dp1->complement(at);
        if (r.complement) r.branch = discrete_states++;
    }
    block_counts_turns = internal_states > 0;
    set_switches(x.t);
    dropped.clear();
    active.resize(row.size());
    std::iota(active.begin(), active.end(), 0);
    set_pattern();  // a complement may have other nonzero derivatives than its block
    int alphas = 0;
    for (ContactConstraint* c : contacts) {
        c->place.alpha = alphas;
        alphas += c->algebraic_variables();
        c->place.discrete_state = c->may_be_inactive() ? discrete_states++ : -1;
    }
    for (const auto& c : general_constraint) {
        c->place.internal_state = internal_states;
        internal_states += c->internal_states();
    }
    x.discrete_state.assign(discrete_states, 0);
    x.alpha = Eigen::VectorXd::Zero(alphas);
    x.internal_state.assign(internal_states, 0);
    for (size_t k = 0; k < general_constraint.size(); ++k) {
        const Constraint& c = *general_constraint[k];
        const auto fail = [&](const std::exception& e) {
            throw ConstraintError(name_of(c) + ": " + e.what(), static_cast<int>(k), true);
        };
        try {
            if (const ContactConstraint* const contact = c.as_contact(); contact != nullptr) {
                const int mode = contact->start(arguments(c, x), x.alpha.data() + c.place.alpha);
                if (c.place.discrete_state >= 0) x.discrete_state[c.place.discrete_state] = mode;
            } else if (const std::string reason = c.start_error(arguments(c, x)); !reason.empty()) {
                throw lie::InvalidInput(reason);
            }
        } catch (const lie::InvalidInput& e) {
            fail(e);
        } catch (const lie::NumericalFailure& e) {  // at a start this is invalid input
            fail(e);
        }
    }
    for (const auto& f : force) {
        f->first_discrete_state = discrete_states;
        discrete_states += f->discrete_states();
        f->first_internal_state = internal_states;
        internal_states += f->internal_states();
    }
    for (const auto& angle : counters) {
        angle->first_discrete_state = discrete_states;
        discrete_states += angle->discrete_states();
    }
    x.discrete_state.resize(discrete_states, 0);
    near.set_layout(bodies(), discrete_states, internal_states);
    x.derived = nullptr;
    x.lambda = Eigen::VectorXd::Zero(rows());
    swap_drivers(x);  // a driver may start near its singularity
    set_internal_state_at_start(x);
}

void Model::set_internal_state_at_start(State& x) const
{
    for (const auto& f : force)
        std::fill_n(x.discrete_state.begin() + f->first_discrete_state, f->discrete_states(), 0);
    for (const auto& angle : counters) x.discrete_state[angle->first_discrete_state] = 0;
    if (near.empty()) {
        x.internal_state.assign(internal_states, 0);
    } else {
        x.internal_state.resize(std::max(x.internal_state.size(), static_cast<size_t>(internal_states)));
        std::fill_n(x.internal_state.begin(), internal_states, 0.);
        near.restart(x);
    }
    update_constraint_states(x, true);
    for_forces(x, [&](const Force& f, int) { f.update_internal_state(x); });
}

bool Model::fits(const State& x) const
{
    if (!near.empty()) return near.fits(x);
    return static_cast<int>(x.discrete_state.size()) == discrete_states &&
           static_cast<int>(x.internal_state.size()) == internal_states;
}

void Model::set_tree(const State& x) { joints = find_tree(*this, x); }

bool Model::internal_states_are_history() const
{
    return !near.empty() ||
           std::any_of(force.begin(), force.end(), [](const auto& f) { return f->internal_states() > 0; }) ||
           std::any_of(general_constraint.begin(), general_constraint.end(), [](const auto& c) {
               return c->algebraic_variables() > 0 && c->internal_states() > 0;
           });
}

Model::MotionEnd Model::motion_end() const
{
    MotionEnd end;
    for (const Row& r : row)
        if (const Driver* f = r.block->prescribed(); f != nullptr && f->last_time() < end.t)
            end = {f->last_time(), r.constraint};
    return end;
}

void Model::count_contacts(const State& x, Force::Counted which, std::vector<int>& of_body) const
{
    of_body.assign(body.size(), 0);
    for_forces(x, [&](const Force& f, int) {
        if (!f.is_counted(x, which)) return;
        const auto [i, j] = f.bodies();
        if (i != ground) ++of_body[i];
        if (j != ground && j != i) ++of_body[j];
    });
}

template <class LimitOf>
Model::StableStep Model::smallest_limit(const State& x, LimitOf limit_of) const
{
    std::vector<int> counts;
    count_contacts(x, Force::Counted::near, counts);
    StableStep smallest;
    for_forces(x, [&](const Force& f, int number) {
        if (const double h = limit_of(f, counts); h < smallest.h) smallest = {h, number};
    });
    return smallest;
}

Model::StableStep Model::stable_step(const State& x, LoadEvaluation evaluation) const
{
    return smallest_limit(x, [&](const Force& f, const std::vector<int>& near) {
        return f.stable_step_with(x, evaluation, near);
    });
}

Model::StableStep Model::stable_step(const State& x, const lie::Scheme& scheme) const
{
    return smallest_limit(
        x, [&](const Force& f, const std::vector<int>& near) { return f.stable_step_in(scheme, x, near); });
}

void Model::drop(const std::vector<int>& rows)
{
    dropped.insert(dropped.end(), rows.begin(), rows.end());
    std::sort(dropped.begin(), dropped.end());
    std::erase_if(active, [&](int k) { return std::binary_search(dropped.begin(), dropped.end(), k); });
    set_pattern();
}

std::string Model::name_of(const Row& r) const
{
    return "constraint '" + constraint_names[r.constraint] + "' row " + std::to_string(r.number) +
           "; bodies '" + body_name(r.block->i) + "', '" + body_name(r.block->j) + "'";
}

std::string Model::name_of(const Constraint& c) const
{
    return c.label() + "; bodies '" + body_name(c.i) + "', '" + body_name(c.j) + "'";
}

std::string Model::name_of(const Constraint& c, int k) const
{
    return c.label() + " " + c.row_name(k) + "; bodies '" + body_name(c.i) + "', '" + body_name(c.j) + "'";
}

std::string Model::name_of(const Residual& residual) const
{
    if (residual.row < 0) return {};
    return residual.constraint != nullptr ? name_of(*residual.constraint, residual.row)
                                          : name_of(row[residual.row]);
}

std::string Model::row_name(int k) const
{
    if (k < static_cast<int>(active.size())) return name_of(row[active[k]]);
    for (const auto& c : general_constraint) {
        const int position_row = k - c->place.row, velocity_row = k - c->place.velocity_row;
        if (position_row >= 0 && position_row < c->position_rows()) return name_of(*c, position_row);
        if (velocity_row >= 0 && velocity_row < c->velocity_rows())
            return name_of(*c, c->position_rows() + velocity_row);
    }
    return System::row_name(k);
}

void Model::set_pattern()
{
    rows_pattern = {};
    point_rows.clear(), single_rows.clear();
    for (const int k : active) add_to_pattern(k);
    int alphas = 0;
    for (const auto& c : general_constraint) {
        c->place.row = rows_pattern.rows();
        add_to_pattern(*c, 0, c->position_rows());
        if (c->algebraic_variables() > 0) {
            rows_pattern.algebraic.push_back(
                {c->place.row, c->position_rows(), alphas, c->algebraic_variables(), {}});
            rows_pattern.algebraic.back().D.setZero(c->position_rows(), c->algebraic_variables());
        }
        if (c->may_be_inactive()) rows_pattern.unilateral.push_back(c->place.row + c->position_rows() - 1);
        alphas += c->algebraic_variables();
    }
    for (const auto& c : general_constraint) {
        c->place.velocity_row = rows_pattern.rows();
        add_to_pattern(*c, c->position_rows(), c->velocity_rows());
        rows_pattern.velocity_rows += c->velocity_rows();
        for (int k = c->place.velocity_row; k < rows_pattern.rows(); ++k) {
            const bool is_bounded = k < c->place.velocity_row + 2 * c->bounded_pairs();
            if (c->may_be_inactive() || is_bounded) rows_pattern.unilateral.push_back(k);
            if (is_bounded) rows_pattern.regularised.push_back(k);
        }
    }
}

void Model::add_to_pattern(const Constraint& c, int first, int rows)
{
    for (int k = first; k < first + rows; ++k) {
        const unsigned nonzero = c.nonzero(k);
        for (const auto& [b, mask] : {std::pair{c.i, nonzero & 0b111111}, {c.j, nonzero >> 6}})
            if (b != ground && mask != 0)
                rows_pattern.entry.push_back(
                    {.body = b, .nonzero = mask, .r = Vec3::Zero(), .pi = Vec3::Zero()});
        rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
    }
}

void Model::add_to_pattern(int k)
{
    const Row& r = row[k];
    const Block& block = *r.block;
    const int number = rows_pattern.rows(), entry = static_cast<int>(rows_pattern.entry.size());
    if (const std::optional<PointRow> point = block.point_row(); !point)
        single_rows.push_back({k, number, entry});
    else if (point_rows.empty() || !point_rows.back().add(*point, number))
        point_rows.emplace_back(*point, number, entry);
    const unsigned nonzero = block.nonzero() | (r.complement ? r.complement->nonzero() : 0);
    if (block.i != ground)
        rows_pattern.entry.push_back(
            {.body = block.i, .nonzero = nonzero & 0b111111, .r = Vec3::Zero(), .pi = Vec3::Zero()});
    if (block.j != ground)
        rows_pattern.entry.push_back(
            {.body = block.j, .nonzero = nonzero >> 6, .r = Vec3::Zero(), .pi = Vec3::Zero()});
    rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
}

double Model::scaled_residual(const Row& r, const State& x) const
{
    const Block& block = r.active_block(x);
    const double length = row_length(block.variation(arguments(block, x)), block);
    return block.phi(arguments(block, x)) / (length > 0 ? length : 1);
}

void Model::Residual::include(double error, int in_row, const Constraint* in_constraint)
{
    if (row >= 0 && (std::abs(error) <= value || std::isnan(value))) return;
    *this = {.value = std::abs(error), .row = in_row, .constraint = in_constraint};
}

Model::Residual Model::largest_residual(const State& x, RowSet over) const
{
    Residual largest;
    if (over == RowSet::in_equations)
        for (const int k : active) largest.include(scaled_residual(row[k], x), k);
    else
        for (int k = 0; k < static_cast<int>(row.size()); ++k) largest.include(scaled_residual(row[k], x), k);
    if (over == RowSet::blocks) return largest;
    double Phi[Constraint::max_position_rows];
    for (const auto& c : general_constraint) {
        if (inactive(*c, x)) continue;
        c->phi(arguments(*c, x), Phi);
        for (int k = 0; k < c->position_rows(); ++k) largest.include(Phi[k], k, c.get());
    }
    return largest;
}

Model::PositionError Model::position_error(const State& x) const
{
    const Residual largest = largest_residual(x, RowSet::in_equations);
    if (largest.row < 0) return {};
    const auto in_equations = std::lower_bound(active.begin(), active.end(), largest.row) - active.begin();
    const int row = largest.constraint != nullptr ? largest.constraint->place.row + largest.row
                                                  : static_cast<int>(in_equations);
    return {.value = largest.value, .row = row};
}

double Model::scaled_velocity_residual(const Row& r, const State& x) const
{
    const Block& block = r.active_block(x);
    const Motion &bi = motion(x, block.i), &bj = motion(x, block.j);
    const Variation v = block.variation(arguments(block, x));
    const double length = row_length(v, block);
    return (v.r_i.dot(bi.rdot) + v.pi_i.dot(bi.omega_bar) + v.r_j.dot(bj.rdot) + v.pi_j.dot(bj.omega_bar) -
            block.nu(arguments(block, x))) /
           (length > 0 ? length : 1);
}

double Model::scaled_acceleration_residual(const Row& r, const State& x) const
{
    const Block& block = r.active_block(x);
    const Motion &bi = motion(x, block.i), &bj = motion(x, block.j);
    const Variation v = block.variation(arguments(block, x));
    const double length = row_length(v, block);
    return (v.r_i.dot(bi.rddot) + v.pi_i.dot(bi.omegadot_bar) + v.r_j.dot(bj.rddot) +
            v.pi_j.dot(bj.omegadot_bar) - block.gamma(arguments(block, x))) /
           (length > 0 ? length : 1);
}

Model::Residual Model::largest_velocity_residual(const State& x) const
{
    Residual largest;
    for (int k = 0; k < static_cast<int>(row.size()); ++k)
        largest.include(scaled_velocity_residual(row[k], x), k);
    return largest;
}

void reactions(const lie::System& system, const State& x, lie::Rows& C, std::vector<Reaction>& out)
{
    system.variation(x, C);
    out.assign(x.body.size(), {});
    for (int k = 0; k < C.rows(); ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            out[C.entry[n].body].F -= x.lambda[k] * C.entry[n].r;
            out[C.entry[n].body].T -= x.lambda[k] * C.entry[n].pi;
        }
}

std::vector<Reaction> reactions(const lie::System& system, const State& x)
{
    lie::Rows C = system.pattern();
    std::vector<Reaction> out;
    reactions(system, x, C, out);
    return out;
}

}  // namespace hilda::dae
