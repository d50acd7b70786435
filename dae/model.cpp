// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model.hpp"

#include "dae/constraints/dp1.hpp"

#include <algorithm>
#include <numeric>

namespace hilda::dae {

namespace {

// Digits left out of an orientation are mended at the start; beyond this ‖AᵀA - I‖ it is no orientation at
// all.
constexpr double not_a_rotation = 1e-3;

double length(const Variation& v, const Block& block)
{
    double sum = 0;
    if (block.i != ground) sum += v.r_i.squaredNorm() + v.pi_i.squaredNorm();
    if (block.j != ground) sum += v.r_j.squaredNorm() + v.pi_j.squaredNorm();
    return std::sqrt(sum);
}

}  // namespace

int Model::add(Body b)
{
    if (b.name.empty()) lie::reject("dae::Model::add", "a body needs a name", "''");
    if (b.name == "ground")
        lie::reject("dae::Model::add", "the name of the fixed body cannot be given", "'ground'");
    for (const Body& other : body)
        if (other.name == b.name)
            lie::reject("dae::Model::add", "two bodies have the same name", "'" + b.name + "'");
    b.validate();
    inertia.m.push_back(b.m);
    inertia.J_bar.push_back(b.J_bar);
    body.push_back(std::move(b));
    return static_cast<int>(body.size()) - 1;
}

int Model::find(const std::string& name) const
{
    if (name == "ground") return ground;
    for (size_t k = 0; k < body.size(); ++k)
        if (body[k].name == name) return static_cast<int>(k);
    lie::reject("dae::Model::find", "no body has this name", "'" + name + "'");
}

void Model::constrain(const std::string& name, Blocks rows)
{
    const int bodies = static_cast<int>(body.size());
    for (const auto& block : rows) {
        for (const int b : {block->i, block->j})
            if (b < ground || b >= bodies)
                lie::reject("constraint '" + name + "'", "no body has this number", b);
        if (block->i == block->j)
            lie::reject("constraint '" + name + "'", "a constraint needs two different bodies",
                        "'" + body_name(block->i) + "' twice");
    }
    if (!names_taken.insert(name).second)
        lie::reject("dae::Model::constrain", "two constraints have the same name", "'" + name + "'");
    int number = 0;
    for (auto& block : rows) {
        active.push_back(static_cast<int>(row.size()));
        row.push_back({.block = std::move(block),
                       .complement = nullptr,
                       .branch = -1,
                       .constraint = constraints(),
                       .number = ++number});
        if (with_unknowns.empty()) add_to_pattern(row.back());
    }
    if (!with_unknowns.empty()) set_pattern();  // whose rows stay last
    constraint_names.push_back(name);
}

void Model::constrain(const std::string& name, std::unique_ptr<Constraint> c)
{
    const int bodies = static_cast<int>(body.size());
    for (const int b : {c->i, c->j})
        if (b < ground || b >= bodies) lie::reject("constraint '" + name + "'", "no body has this number", b);
    if (c->i == c->j)
        lie::reject("constraint '" + name + "'", "a constraint needs two different bodies",
                    "'" + body_name(c->i) + "' twice");
    if (!names_taken.insert(name).second)
        lie::reject("dae::Model::constrain", "two constraints have the same name", "'" + name + "'");
    c->name = name;
    with_unknowns.push_back(std::move(c));
    set_pattern();
}

void Model::load(std::unique_ptr<Force> f)
{
    if (f->last_body() >= static_cast<int>(body.size()))
        lie::reject(f->in_words(), "no body has this number", f->last_body());
    force.push_back(std::move(f));
}

void Model::prepare(State& x)
{
    if (x.body.size() != body.size())
        lie::reject("dae::Model::prepare", "the state must have a motion for each of the bodies",
                    x.body.size());
    for (size_t b = 0; b < x.body.size(); ++b) {
        const Mat3& A = x.body[b].A;
        if (!(lie::orthogonality_error(A) < not_a_rotation) || A.determinant() < 0)
            lie::reject("body '" + body[b].name + "'", "the orientation must be a rotation matrix", A);
    }
    for (size_t k = 0; k < force.size(); ++k)
        if (const std::string why = force[k]->objection(x); !why.empty())
            throw ForceError(force[k]->in_words() + ": " + why, static_cast<int>(k));
    discrete_state = internal_state = 0;
    for (Row& r : row) {
        const Motion &bi = motion(x, r.block->i), &bj = motion(x, r.block->j);
        if (const std::string why = r.block->objection(bi, bj, x.t); !why.empty())
            throw ConstraintError(name_of(r) + ": " + why, r.constraint);
        r.complement.reset();
        r.branch = -1;
        if (const auto* dp1 = dynamic_cast<const DP1*>(r.block.get()); dp1 != nullptr)
            r.complement = dp1->complement(bi, bj, x.t);
        if (r.complement) r.branch = discrete_state++;
    }
    dropped.clear();
    active.resize(row.size());
    std::iota(active.begin(), active.end(), 0);
    set_pattern();  // the complements may enter where their blocks do not
    int alphas = 0;
    for (const auto& c : with_unknowns) {
        c->first_alpha = alphas;
        alphas += c->unknowns();
        c->first_discrete_state = discrete_state;
        discrete_state += c->may_be_inactive();
        c->first_internal_state = internal_state;
        internal_state += c->internal_states();
    }
    x.discrete_state.assign(discrete_state, 0);
    x.alpha = Eigen::VectorXd::Zero(alphas);
    x.internal_state.assign(internal_state, 0);
    for (size_t k = 0; k < with_unknowns.size(); ++k) {
        const Constraint& c = *with_unknowns[k];
        const auto refuse = [&](const std::string& why) {
            throw ContactError(name_of(c) + ": " + why, static_cast<int>(k));
        };
        try {
            if (const std::string why = c.objection(at(c, x)); !why.empty()) {
                if (!c.has_fallback()) refuse(why);
                x.discrete_state[c.first_discrete_state] = Constraint::fallback_active;
                try {
                    c.update_alpha(at(c, x), true, x.alpha.data() + c.first_alpha);  // for who looks at it
                } catch (const lie::NumericalFailure&) {
                }
                continue;
            }
            c.update_alpha(at(c, x), true, x.alpha.data() + c.first_alpha);
        } catch (const lie::NumericalFailure& e) {  // of a start, that it is a wrong one
            refuse(e.what());
        }
        // one that may open starts open where there is a gap, or where it leaves or meets at once
        constexpr double still = 1e-9;  // [m/s]
        const Constraint::At there = at(c, x);
        const double gap = c.gap(there);
        if (c.is_unilateral() &&
            (gap > c.allowance() || (gap > -c.allowance() && std::abs(c.separation_speed(there)) > still)))
            x.discrete_state[c.first_discrete_state] = Constraint::inactive;
    }
    for (const auto& f : force) {
        f->first_discrete_state = discrete_state;
        discrete_state += f->discrete_states();
        f->first_internal_state = internal_state;
        internal_state += f->internal_states();
    }
    x.discrete_state.resize(discrete_state, 0);
    x.lambda = Eigen::VectorXd::Zero(rows());
    swap_drivers(x);  // one may start near its singular point
    set_internal_state_at_start(x);
}

void Model::set_internal_state_at_start(State& x) const
{
    for (const auto& f : force)
        std::fill_n(x.discrete_state.begin() + f->first_discrete_state, f->discrete_states(), 0);
    x.internal_state.assign(internal_state, 0);
    update_contact_states(x, true);
    for (const auto& f : force) f->update_internal_state(x);
}

Model::StableStep Model::stable_step(const State& x) const
{
    StableStep smallest;
    for (size_t k = 0; k < force.size(); ++k)
        if (const double h = force[k]->stable_step(x); h < smallest.h) smallest = {h, static_cast<int>(k)};
    return smallest;
}

void Model::drop(int k)
{
    std::erase(active, k);
    dropped.insert(std::lower_bound(dropped.begin(), dropped.end(), k), k);
    set_pattern();
}

std::string Model::name_of(const Row& r) const
{
    return "constraint '" + constraint_names[r.constraint] + "' row " + std::to_string(r.number) +
           "; bodies '" + body_name(r.block->i) + "', '" + body_name(r.block->j) + "'";
}

std::string Model::name_of(const Constraint& c) const
{
    return "contact '" + c.name + "'; bodies '" + body_name(c.i) + "', '" + body_name(c.j) + "'";
}

std::string Model::name_of(const Constraint& c, int k) const
{
    return "contact '" + c.name + "' " + c.row_name(k) + "; bodies '" + body_name(c.i) + "', '" +
           body_name(c.j) + "'";
}

std::string Model::name_of(const Residual& residual) const
{
    if (residual.row < 0) return {};
    return residual.of != nullptr ? name_of(*residual.of, residual.row) : name_of(row[residual.row]);
}

std::string Model::row_name(int k) const
{
    if (k < static_cast<int>(active.size())) return name_of(row[active[k]]);
    for (const auto& c : with_unknowns) {
        const int on_position = k - c->first_row, on_velocity = k - c->first_velocity_row;
        if (on_position >= 0 && on_position < c->rows()) return name_of(*c, on_position);
        if (on_velocity >= 0 && on_velocity < c->velocity_rows()) return name_of(*c, c->rows() + on_velocity);
    }
    return System::row_name(k);
}

void Model::set_pattern()
{
    rows_pattern = {};
    for (const int k : active) add_to_pattern(row[k]);
    int alphas = 0;
    for (const auto& c : with_unknowns) {
        c->first_row = rows_pattern.rows();
        add_to_pattern(*c, 0, c->rows());
        rows_pattern.algebraic.push_back({c->first_row, c->rows(), alphas, c->unknowns(), {}});
        rows_pattern.algebraic.back().D.setZero(c->rows(), c->unknowns());
        if (c->may_be_inactive()) rows_pattern.unilateral.push_back(c->first_row + c->rows() - 1);
        alphas += c->unknowns();
    }
    for (const auto& c : with_unknowns) {
        c->first_velocity_row = rows_pattern.rows();
        add_to_pattern(*c, c->rows(), c->velocity_rows());
        rows_pattern.velocity_rows += c->velocity_rows();
        for (int n = 0; n < c->pairs(); ++n) {
            lie::Rows::Regularised pair;
            pair.first = c->first_velocity_row + 2 * n;
            pair.normal_row = c->first_row;
            pair.solved_first = c->solved_first(n);
            rows_pattern.regularised.push_back(pair);
        }
        for (int k = 0; (c->may_be_inactive() || c->is_regularised()) && k < c->velocity_rows(); ++k)
            rows_pattern.unilateral.push_back(c->first_velocity_row + k);
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

void Model::add_to_pattern(const Row& r)
{
    const Block& block = *r.block;
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
    const Block& block = r.in_force(x);
    const Motion &bi = motion(x, block.i), &bj = motion(x, block.j);
    const double size = length(block.variation(bi, bj, x.t), block);
    return block.phi(bi, bj, x.t) / (size > 0 ? size : 1);
}

void Model::Residual::consider(double error, int in_row, const Constraint* of_constraint)
{
    if (row >= 0 && (std::abs(error) <= value || std::isnan(value))) return;
    *this = {.value = std::abs(error), .row = in_row, .of = of_constraint};
}

Model::Residual Model::largest_residual(const State& x, Over over) const
{
    Residual largest;
    if (over == Over::in_equations)
        for (const int k : active) largest.consider(scaled_residual(row[k], x), k);
    else
        for (int k = 0; k < static_cast<int>(row.size()); ++k)
            largest.consider(scaled_residual(row[k], x), k);
    if (over == Over::blocks) return largest;
    double Phi[Constraint::most_rows];
    for (const auto& c : with_unknowns) {
        if (inactive(*c, x)) continue;
        c->phi(at(*c, x), Phi);
        for (int k = 0; k < c->rows(); ++k) largest.consider(Phi[k], k, c.get());
    }
    return largest;
}

double Model::scaled_velocity_residual(const Row& r, const State& x) const
{
    const Block& block = r.in_force(x);
    const Motion &bi = motion(x, block.i), &bj = motion(x, block.j);
    const Variation v = block.variation(bi, bj, x.t);
    const double size = length(v, block);
    return (v.r_i.dot(bi.rdot) + v.pi_i.dot(bi.omega_bar) + v.r_j.dot(bj.rdot) + v.pi_j.dot(bj.omega_bar) -
            block.nu(bi, bj, x.t)) /
           (size > 0 ? size : 1);
}

double Model::scaled_acceleration_residual(const Row& r, const State& x) const
{
    const Block& block = r.in_force(x);
    const Motion &bi = motion(x, block.i), &bj = motion(x, block.j);
    const Variation v = block.variation(bi, bj, x.t);
    const double size = length(v, block);
    return (v.r_i.dot(bi.rddot) + v.pi_i.dot(bi.omegadot_bar) + v.r_j.dot(bj.rddot) +
            v.pi_j.dot(bj.omegadot_bar) - block.gamma(bi, bj, x.t)) /
           (size > 0 ? size : 1);
}

Model::Residual Model::largest_velocity_residual(const State& x) const
{
    Residual largest;
    for (int k = 0; k < static_cast<int>(row.size()); ++k)
        largest.consider(scaled_velocity_residual(row[k], x), k);
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
