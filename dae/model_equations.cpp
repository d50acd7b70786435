// SPDX-License-Identifier: GPL-3.0-or-later
/// The lie::System interface of a model: its equations, their variations, and the update after an accepted
/// step.
#include "dae/constraints/dp1.hpp"
#include "dae/driver.hpp"
#include "dae/function_of_time.hpp"
#include "dae/model.hpp"
#include "dae/outputs/turn_counter.hpp"
#include "dae/start/differences.hpp"
#include "lie/steps/state_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace hilda::dae {

namespace {

// A DP1 driver is replaced by its complement if |f|/(|a_i||a_j|) exceeds this value. The complement then has
// |f|/(|a_i||a_j|) < 0.44.
constexpr double swap_threshold = 0.9;
// The complement must satisfy |Φ| ≤ swap_tolerance where it replaces the driver. It does not if the driven
// vectors have left their common plane of rotation.
constexpr double swap_tolerance = 1e-6;
// Largest number of pairs of groups that have blocks in the variation of the loads
constexpr int most_pairs_of_pattern = 100000;

}  // namespace

void Model::loads(const State& x, lie::Loads& out) const
{
    for (size_t b = 0; b < body.size(); ++b) {
        out.F[b] = inertia.m[b] * gravity;
        out.n_bar[b].setZero();
    }
    for_forces(x, [&](const Force& f, int) { f.add(x, out); });
    if (x.applied_loads.empty()) return;
    const double* applied = x.applied_loads.data();
    for (size_t b = 0; b < body.size(); ++b, applied += 6) {
        out.F[b] += Vec3::Map(applied);
        out.n_bar[b] += Vec3::Map(applied + 3);
    }
}

void Model::phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    for (const PointRows& rows : point_rows) rows.phi(x, out.data() + rows.first);
    for (const SingleRow& single : single_rows) {
        const Block& block = row[single.row].active_block(x);
        out[single.number] = block.phi(arguments(block, x));
    }
    for (const auto& c : general_constraint)
        if (inactive(*c, x))
            out.segment(c->place.row, c->position_rows()).setZero();
        else
            c->phi(arguments(*c, x), out.data() + c->place.row);
    out.tail(rows_pattern.velocity_rows).setZero();
}

void Model::variation(const State& x, lie::Rows& out) const
{
    for (const PointRows& rows : point_rows) rows.variation(x, out.entry.data() + rows.entry);
    for (const SingleRow& single : single_rows) {
        const Block& block = row[single.row].active_block(x);
        const Variation v = block.variation(arguments(block, x));
        lie::Rows::Entry* entry = out.entry.data() + single.entry;
        if (block.i != ground) entry->r = v.r_i, entry->pi = v.pi_i, ++entry;
        if (block.j != ground) entry->r = v.r_j, entry->pi = v.pi_j, ++entry;
    }
    Constraint::Derivatives d;
    const auto fill = [&](const Constraint& c, int first, int row, int rows) {
        for (int k = 0; k < rows; ++k)
            for (int e = out.start[row + k]; e < out.start[row + k + 1]; ++e) {
                const auto& C_body = out.entry[e].body == c.i ? d.C_i : d.C_j;
                out.entry[e].r = C_body.row(first + k).head<3>();
                out.entry[e].pi = C_body.row(first + k).tail<3>();
            }
    };
    auto group = out.algebraic.begin();
    for (const auto& constraint : general_constraint) {
        const Constraint& c = *constraint;
        d.set_zero(c);
        if (inactive(c, x))
            d.Phi_alpha.setIdentity();  // regular, so that the corrections of α are zero
        else
            c.variation(arguments(c, x), d);
        fill(c, 0, c.place.row, c.position_rows());
        fill(c, c.position_rows(), c.place.velocity_row, c.velocity_rows());
        if (c.algebraic_variables() > 0) (group++)->D = d.Phi_alpha;
    }
}

void Model::nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    out.setZero();
    for (const SingleRow& single : single_rows) {
        const Block& block = row[single.row].active_block(x);
        out[single.number] = block.nu(arguments(block, x));
    }
    double nu_c[Constraint::max_rows];
    for (const auto& c : general_constraint) {
        if (inactive(*c, x)) continue;
        c->nu(arguments(*c, x), nu_c);
        std::copy_n(nu_c, c->position_rows(), out.data() + c->place.row);
        std::copy_n(nu_c + c->position_rows(), c->velocity_rows(), out.data() + c->place.velocity_row);
    }
}

void Model::gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    for (const PointRows& rows : point_rows) rows.gamma(x, out.data() + rows.first);
    for (const SingleRow& single : single_rows) {
        const Block& block = row[single.row].active_block(x);
        out[single.number] = block.gamma(arguments(block, x));
    }
    double gamma_c[Constraint::max_rows];
    for (const auto& c : general_constraint) {
        std::fill(gamma_c, gamma_c + Constraint::max_rows, 0.0);
        if (!inactive(*c, x)) c->gamma(arguments(*c, x), gamma_c);
        std::copy_n(gamma_c, c->position_rows(), out.data() + c->place.row);
        std::copy_n(gamma_c + c->position_rows(), c->velocity_rows(), out.data() + c->place.velocity_row);
    }
}

void Model::update_alpha(State& x) const
{
    for (const ContactConstraint* c : contacts)
        if (!inactive(*c, x)) c->update_alpha(arguments(*c, x), false, x.alpha.data() + c->place.alpha);
}

void Model::cones(const State& x, double h, lie::ConeRows& out) const
{
    out.cone.clear();
    for (const auto& of : rigid) of->add_cones(x, h, out);
}

std::string Model::cone_name(std::uint64_t key) const
{
    const auto pair = static_cast<int>(key >> 32);
    for (const auto& of : rigid)
        if (pair < of->first_pair + of->numbers())
            return "contact '" + of->name_of_pair(pair - of->first_pair) + "'";
    return "contact point";
}

std::vector<lie::BoundedPair> Model::bounded_pairs() const
{
    std::vector<lie::BoundedPair> pairs;
    for (const ContactConstraint* c : contacts)
        for (int n = 0; n < c->bounded_pairs(); ++n) {
            pairs.emplace_back();
            pairs.back().first = c->place.velocity_row + 2 * n;
            pairs.back().normal_row = c->place.row;
        }
    return pairs;
}

void Model::update_pairs(const State& x, std::vector<lie::BoundedPair>& pairs) const
{
    lie::BoundedPair* pair = pairs.data();
    for (const ContactConstraint* c : contacts) {
        const int number = c->bounded_pairs();
        if (number == 0) continue;
        for (int p = 0; p < number; ++p) pair[p].K = 0;
        if (!inactive(*c, x)) c->set_pairs(arguments(*c, x), pair);
        pair += number;
    }
}

/// Calls f(constraint, row, k) for all rows k of the equations without algebraic variables; `row` is the
/// number of the row within its constraint.
template <class F>
void Model::for_rows_without_alpha(const State& x, F f) const
{
    int k = 0;
    for (const int n : active) f(row[n].active_block(x), 0, k++);
    for (const auto& c : general_constraint) {
        if (c->algebraic_variables() > 0 || inactive(*c, x)) continue;
        for (int n = 0; n < c->position_rows(); ++n) f(*c, n, c->place.row + n);
        for (int n = 0; n < c->velocity_rows(); ++n) f(*c, c->position_rows() + n, c->place.velocity_row + n);
    }
}

void Model::second_variation(const State& x, lie::SecondVariation& out) const
{
    for_rows_without_alpha(x, [&](const Constraint& c, int n, int k) {
        const Mat12 H = c.second_variation(arguments(c, x), n);
        const int i = 0, j = c.i != ground ? 1 : 0;  // entry numbers
        if (c.i != ground) out.at(k, i, i) = H.topLeftCorner<6, 6>();
        if (c.j != ground) out.at(k, j, j) = H.bottomRightCorner<6, 6>();
        if (c.i == ground || c.j == ground) return;
        out.at(k, i, j) = H.topRightCorner<6, 6>();
        out.at(k, j, i) = H.bottomLeftCorner<6, 6>();
    });
}

void Model::nu_variation(const State& x, lie::Rows& out) const
{
    for_rows_without_alpha(x, [&](const Constraint& c, int n, int k) {
        const Variation v = c.nu_variation(arguments(c, x), n);
        lie::Rows::Entry* entry = out.entry.data() + out.start[k];
        if (c.i != ground) entry->r = v.r_i, entry->pi = v.pi_i, ++entry;
        if (c.j != ground) entry->r = v.r_j, entry->pi = v.pi_j;
    });
}

void Model::gamma_variation(const State& x, lie::GammaVariation& out) const
{
    for_rows_without_alpha(x, [&](const Constraint& c, int n, int k) {
        const GammaDerivatives g = c.gamma_variation(arguments(c, x), n);
        lie::GammaVariation::Entry* entry = out.entry.data() + rows_pattern.start[k];
        if (c.i != ground) *entry++ = {g.i.r, g.i.theta, g.i.rdot, g.i.omega};
        if (c.j != ground) *entry = {g.j.r, g.j.theta, g.j.rdot, g.j.omega};
    });
}

/// The blocks of the near forces follow those of the other forces: one for each body and, if the groups do
/// not have too many pairs, two for each pair. Without them Newton's method converges more slowly.
lie::LoadVariation Model::load_pattern() const
{
    lie::LoadVariation out;
    for (const auto& f : force)
        for (const int by : f->bodies())
            for (const int on : f->bodies())
                if (on != ground && by != ground) out.block.push_back({.on = on, .by = by});
    if (!near.empty()) {
        for (int b = 0; b < bodies(); ++b) out.block.push_back({.on = b, .by = b});
        if (near.numbers() <= most_pairs_of_pattern)
            for (int n = 0; n < near.numbers(); ++n) {
                const auto [group, pair] = near.group_of(n);
                if (!group->has_pair(pair)) {
                    out.block.push_back({.on = 0, .by = 0}), out.block.push_back({.on = 0, .by = 0});
                    continue;
                }
                const auto [i, j] = group->bodies(pair);
                const int a = std::max(i, j), b = i == ground || j == ground ? a : std::min(i, j);
                out.block.push_back({.on = a, .by = b}), out.block.push_back({.on = b, .by = a});
            }
    }
    out.plus = out.minus = lie::Loads(bodies());
    return out;
}

void Model::load_variation(const State& x, lie::LoadVariation& out) const
{
    if (out.block.empty()) return;
    bool copied = false;
    Force::LoadDerivatives d;
    lie::LoadVariation::Block* block = out.block.data();
    for (const auto& f : force) {
        const std::array<int, 2> bodies = f->bodies();
        if (bodies[0] == ground && bodies[1] == ground) continue;
        if (!f->load_derivatives(x, d)) {
            if (!copied) lie::copy(x, out.x);
            copied = true;
            difference_loads(*f, x, out, d);
        }
        for (int by = 0; by < 2; ++by)
            for (int on = 0; on < 2; ++on)
                if (bodies[on] != ground && bodies[by] != ground)
                    (block++)->d << d.block<6, 6>(6 * on, 6 * by), d.block<6, 6>(6 * on, 12 + 6 * by);
    }
    if (near.empty()) return;
    for (lie::LoadVariation::Block* b = block; b != out.block.data() + out.block.size(); ++b) b->d.setZero();
    const bool has_pairs = near.numbers() <= most_pairs_of_pattern;
    near.visit(x, [&](const Force& f, int number) {
        if (!f.load_derivatives(x, d)) {
            if (!copied) lie::copy(x, out.x);
            copied = true;
            difference_loads(f, x, out, d);
        }
        const std::array<int, 2> of = f.bodies();
        const auto add = [&](lie::LoadVariation::Block& to, int on, int by) {
            to.d.leftCols<6>() += d.block<6, 6>(6 * on, 6 * by);
            to.d.rightCols<6>() += d.block<6, 6>(6 * on, 12 + 6 * by);
        };
        for (int k = 0; k < 2; ++k)
            if (of[k] != ground) add(block[of[k]], k, k);
        if (!has_pairs || of[0] == ground || of[1] == ground) return;
        const int larger = of[0] > of[1] ? 0 : 1;
        add(block[bodies() + 2 * number], larger, 1 - larger);
        add(block[bodies() + 2 * number + 1], 1 - larger, larger);
    });
}

lie::Springs Model::spring_pattern() const
{
    lie::Springs out;
    for (const auto& f : force) {
        if (!f->implicit) continue;
        for (int n = 0; n < f->max_spring_rows(); ++n) {
            for (const int b : f->bodies())
                if (b != ground)
                    out.rows.entry.push_back(
                        {.body = b, .nonzero = 0b111111, .r = Vec3::Zero(), .pi = Vec3::Zero()});
            out.rows.start.push_back(static_cast<int>(out.rows.entry.size()));
        }
    }
    out.stiffness.resize(static_cast<size_t>(out.rows.rows()));
    out.damping.resize(out.stiffness.size());
    out.gamma.resize(out.stiffness.size());
    return out;
}

void Model::update_springs(const State& x, lie::Springs& out) const
{
    std::array<Force::SpringRow, Force::most_spring_rows> rows;
    lie::Rows::Entry* entry = out.rows.entry.data();
    size_t at = 0;
    for (const auto& f : force) {
        if (!f->implicit) continue;
        rows.fill({});
        f->spring_rows(x, rows.data());
        for (int n = 0; n < f->max_spring_rows(); ++n, ++at) {
            const Force::SpringRow& row = rows[static_cast<size_t>(n)];
            const auto [i, j] = f->bodies();
            if (i != ground) entry->r = row.r_i, entry->pi = row.pi_i, ++entry;
            if (j != ground) entry->r = row.r_j, entry->pi = row.pi_j, ++entry;
            out.stiffness[at] = row.stiffness;
            out.damping[at] = row.damping;
            out.gamma[at] = row.gamma;
        }
    }
}

void Model::switching(const State& x, double* out) const
{
    for (const auto& f : force) {
        f->switching(x, out);
        out += f->switches();
    }
}

/// Collects the switching functions and the functions of time of a run that starts at t.
void Model::set_switches(double t)
{
    switching_functions = 0;
    functions_of_time.clear();
    for (const auto& f : force) {
        f->start_time = t;
        switching_functions += f->switches();
        for (const io::Expression& g : f->functions_of_time())
            functions_of_time.push_back({std::make_shared<FunctionOfTime>(g)});
    }
    driven_functions = functions_of_time.size();
    for (size_t k = 0; k < row.size(); ++k)
        if (const Driver* driver = row[k].block->prescribed(); driver != nullptr)
            functions_of_time.push_back(
                {std::make_shared<FunctionOfTime>(driver->function_of_time()), static_cast<int>(k)});
    drivers_have_breaks =
        std::any_of(functions_of_time.begin() + static_cast<std::ptrdiff_t>(driven_functions),
                    functions_of_time.end(), [](const TimeFunction& of) { return of.f->has_breaks(); });
}

Model::SmoothTime Model::smooth_until(double t, double t_end) const
{
    SmoothTime smooth{t_end};
    for (const TimeFunction& of : functions_of_time)
        if (const auto first = of.f->first_break(t, smooth.end); first) smooth = {*first, true};
    // Values at both sides of a break point
    const double distance = smooth.is_break ? lie::break_distance(smooth.end) : 0;
    for (const TimeFunction& of : functions_of_time) {
        const double end = smooth.is_break ? smooth.end - distance : smooth.end;
        if (!(end > t)) break;
        if (const double resolved = of.f->resolved_until(t, end); resolved < end) smooth = {resolved};
    }
    if (smooth.is_break)
        for (size_t k = driven_functions; k < functions_of_time.size(); ++k)
            refuse_jump(functions_of_time[k], smooth.end);
    return smooth;
}

/// Throws if a prescribed motion jumps at t.
void Model::refuse_jump(const TimeFunction& of, double t) const
{
    constexpr double rounding = 1e-9;
    const double distance = lie::break_distance(t), before = of.f->value(t - distance),
                 after = of.f->value(t + distance);
    if (std::abs(after - before) <= rounding * (1 + std::abs(before))) return;
    std::ostringstream what;
    what << name_of(row[of.driven]) << ": the prescribed motion jumps from " << before << " to " << after
         << " at t = " << t << " s; a motion must be continuous";
    throw lie::NumericalFailure("motion_jumps", what.str());
}

bool Model::velocity_jumps(double t, double t_end) const
{
    if (!drivers_have_breaks) return false;
    bool jumps = false;
    for (size_t k = driven_functions; k < functions_of_time.size(); ++k) {
        const TimeFunction& of = functions_of_time[k];
        const Driver& driver = *row[of.driven].block->prescribed();
        for (double from = t; const auto first = of.f->first_break(from, t_end);) {
            refuse_jump(of, *first);
            const double distance = lie::break_distance(*first);
            const double before = driver.fdot(*first - distance), after = driver.fdot(*first + distance);
            constexpr double rounding = 1e-6;
            jumps = jumps || !(std::abs(after - before) <= rounding * (1 + std::abs(before)));
            from = *first + distance;
        }
    }
    return jumps;
}

double Model::potential_energy(const State& x) const
{
    double e = 0;
    for (size_t b = 0; b < body.size(); ++b) e -= inertia.m[b] * gravity.dot(x.body[b].r);
    for_forces(x, [&](const Force& f, int) { e += f.potential_energy(x); });
    return e;
}

void Model::accepted(const State& before, State& after) const
{
    if (near.empty() || near.is_kept(before, after)) {
        for_forces(after, [&](const Force& f, int) { f.check_step(before, after); });
    } else {
        State with_new_pairs = before;
        near.renew(with_new_pairs, after);
        for_forces(after, [&](const Force& f, int) { f.check_step(with_new_pairs, after); });
    }
    swap_drivers(after);
    update_constraint_states(after, false);
    for_forces(after, [&](const Force& f, int) { f.update_internal_state(after); });
    for (const auto& angle : counters) angle->count(before, after);
}

void Model::update_constraint_states(State& x, bool start) const
{
    for (const Row& r : row)
        r.block->update_internal_state(arguments(*r.block, x), start,
                                       x.internal_state.data() + r.block->place.internal_state);
    for (const auto& c : general_constraint) {
        double* const state = x.internal_state.data() + c->place.internal_state;
        if (const ContactConstraint* const contact = c->as_contact(); contact == nullptr)
            c->update_internal_state(arguments(*c, x), start, state);
        else if (const int after = contact->update_mode(arguments(*c, x), start, state); after != mode(*c, x))
            set_mode(*contact, x, after);
    }
}

void Model::set_mode(const ContactConstraint& c, State& x, int mode)
{
    x.discrete_state[c.place.discrete_state] = mode;
    x.lambda.segment(c.place.row, c.position_rows()).setZero();
    x.lambda.segment(c.place.velocity_row, c.velocity_rows()).setZero();
}

void Model::swap_drivers(State& x) const
{
    for (size_t n = 0; n < active.size(); ++n) {
        const Row& r = row[active[n]];
        if (!r.complement) continue;
        const auto& current = static_cast<const DP1&>(r.active_block(x));
        if (current.alignment(x.t) <= swap_threshold) continue;
        const Block& candidate = &current == r.block.get() ? *r.complement : *r.block;
        if (std::abs(candidate.phi(arguments(candidate, x))) > swap_tolerance) continue;
        const Variation from = current.variation(arguments(current, x));
        // λ' = λ (Π·Π')/(Π'·Π'): the parallel rows then exert the same torque.
        x.discrete_state[r.branch] ^= 1;
        const Variation to = candidate.variation(arguments(candidate, x));
        x.lambda[static_cast<Eigen::Index>(n)] *= (from.pi_i.dot(to.pi_i) + from.pi_j.dot(to.pi_j)) /
                                                  (to.pi_i.squaredNorm() + to.pi_j.squaredNorm());
    }
}

}  // namespace hilda::dae
