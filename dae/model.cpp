// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model.hpp"

#include "dae/constraints/dp1.hpp"

#include <algorithm>
#include <numeric>

namespace hilda::dae {

namespace {

// A driver is swapped for its complement above this |f| / (|a_i||a_j|); the complement is then below 0.44.
constexpr double swap_above = 0.9;
// The complement must hold where it takes over; it does not when the driven vectors leave the plane of the
// turn.
constexpr double swap_mismatch = 1e-6;

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
    memory = remembered = 0;
    for (Row& r : row) {
        const Motion &bi = motion(x, r.block->i), &bj = motion(x, r.block->j);
        if (const std::string why = r.block->objection(bi, bj, x.t); !why.empty())
            throw ConstraintError(name_of(r) + ": " + why, r.constraint);
        r.complement.reset();
        r.branch = -1;
        if (const auto* dp1 = dynamic_cast<const DP1*>(r.block.get()); dp1 != nullptr)
            r.complement = dp1->complement(bi, bj, x.t);
        if (r.complement) r.branch = memory++;
    }
    dropped.clear();
    active.resize(row.size());
    std::iota(active.begin(), active.end(), 0);
    set_pattern();  // the complements may enter where their blocks do not
    int alphas = 0;
    for (const auto& c : with_unknowns) {
        c->first_alpha = alphas;
        alphas += c->unknowns();
        c->first_memory = memory;
        memory += c->opens();
        c->first_remembered = remembered;
        remembered += c->remembered();
    }
    x.memory.assign(memory, 0);
    x.alpha = Eigen::VectorXd::Zero(alphas);
    x.remembered.assign(remembered, 0);
    for (size_t k = 0; k < with_unknowns.size(); ++k) {
        const Constraint& c = *with_unknowns[k];
        const auto refuse = [&](const std::string& why) {
            throw ContactError(name_of(c) + ": " + why, static_cast<int>(k));
        };
        try {
            if (const std::string why = c.objection(at(c, x)); !why.empty()) {
                if (!c.hands_over()) refuse(why);
                x.memory[c.first_memory] = Constraint::handed_over;
                try {
                    c.track(at(c, x), true, x.alpha.data() + c.first_alpha);  // for who looks at it
                } catch (const lie::NumericalFailure&) {
                }
                continue;
            }
            c.track(at(c, x), true, x.alpha.data() + c.first_alpha);
        } catch (const lie::NumericalFailure& e) {  // of a start, that it is a wrong one
            refuse(e.what());
        }
        // one that may open starts open where there is a gap, or where it leaves or meets at once
        constexpr double still = 1e-9;  // [m/s]
        const Constraint::At there = at(c, x);
        const double gap = c.gap(there);
        if (c.one_sided() &&
            (gap > c.allowance() || (gap > -c.allowance() && std::abs(c.separation_speed(there)) > still)))
            x.memory[c.first_memory] = Constraint::is_open;
    }
    for (const auto& f : force) {
        f->first_memory = memory;
        memory += f->memory();
        f->first_remembered = remembered;
        remembered += f->remembered();
    }
    x.memory.resize(memory, 0);
    x.lambda = Eigen::VectorXd::Zero(rows());
    swap_drivers(x);  // one may start near its singular point
    remember_start(x);
}

void Model::remember_start(State& x) const
{
    for (const auto& f : force) std::fill_n(x.memory.begin() + f->first_memory, f->memory(), 0);
    x.remembered.assign(remembered, 0);
    remember_contacts(x, true);
    for (const auto& f : force) f->remember(x);
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

std::string Model::row_name(int k) const
{
    if (k < static_cast<int>(active.size())) return name_of(row[active[k]]);
    for (const auto& c : with_unknowns) {
        const int on_velocity = k - c->first_velocity_row;
        if (k >= c->first_row && k < c->first_row + c->rows())
            return "contact '" + c->name + "' " + c->row_name(k - c->first_row) + "; bodies '" +
                   body_name(c->i) + "', '" + body_name(c->j) + "'";
        if (on_velocity >= 0 && on_velocity < c->velocity_rows())
            return "contact '" + c->name + "' " + c->row_name(c->rows() + on_velocity) + "; bodies '" +
                   body_name(c->i) + "', '" + body_name(c->j) + "'";
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
        rows_pattern.massless.push_back({c->first_row, c->rows(), alphas, c->unknowns(), {}});
        rows_pattern.massless.back().D.setZero(c->rows(), c->unknowns());
        if (c->opens()) rows_pattern.opening.push_back(c->first_row + c->rows() - 1);
        alphas += c->unknowns();
    }
    for (const auto& c : with_unknowns) {
        c->first_velocity_row = rows_pattern.rows();
        add_to_pattern(*c, c->rows(), c->velocity_rows());
        rows_pattern.velocity_rows += c->velocity_rows();
        for (int n = 0; n < c->pairs(); ++n) {
            lie::Rows::Compliant pair;
            pair.first = c->first_velocity_row + 2 * n;
            pair.pressing = c->first_row;
            pair.early = c->is_early(n);
            rows_pattern.compliant.push_back(pair);
        }
        for (int k = 0; (c->opens() || c->gives_way()) && k < c->velocity_rows(); ++k)
            rows_pattern.opening.push_back(c->first_velocity_row + k);
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

Model::Residual Model::largest_residual(const State& x) const
{
    Residual largest;
    for (int k = 0; k < static_cast<int>(row.size()); ++k) {
        const double value = std::abs(scaled_residual(row[k], x));
        if (!(value <= largest.value) || largest.row < 0) largest = {value, k};
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
    for (int k = 0; k < static_cast<int>(row.size()); ++k) {
        const double value = std::abs(scaled_velocity_residual(row[k], x));
        if (!(value <= largest.value) || largest.row < 0) largest = {value, k};
    }
    return largest;
}

void Model::loads(const State& x, lie::Loads& out) const
{
    for (size_t b = 0; b < body.size(); ++b) {
        out.F[b] = inertia.m[b] * gravity;
        out.n_bar[b].setZero();
    }
    for (const auto& f : force) f->add(x, out);
}

void Model::phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    Eigen::Index n = 0;
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        out[n++] = block.phi(motion(x, block.i), motion(x, block.j), x.t);
    }
    for (const auto& c : with_unknowns)
        if (open(*c, x))
            out.segment(c->first_row, c->rows()).setZero();
        else
            c->phi(at(*c, x), out.data() + c->first_row);
    out.tail(rows_pattern.velocity_rows).setZero();
}

void Model::variation(const State& x, lie::Rows& out) const
{
    lie::Rows::Entry* entry = out.entry.data();
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        const Variation v = block.variation(motion(x, block.i), motion(x, block.j), x.t);
        if (block.i != ground) entry->r = v.r_i, entry->pi = v.pi_i, ++entry;
        if (block.j != ground) entry->r = v.r_j, entry->pi = v.pi_j, ++entry;
    }
    Constraint::Derivatives d;
    const auto fill = [&](const Constraint& c, int of_c, int row, int rows) {
        for (int k = 0; k < rows; ++k)
            for (int e = out.start[row + k]; e < out.start[row + k + 1]; ++e) {
                const auto& of_body = out.entry[e].body == c.i ? d.of_i : d.of_j;
                out.entry[e].r = of_body.row(of_c + k).head<3>();
                out.entry[e].pi = of_body.row(of_c + k).tail<3>();
            }
    };
    lie::Rows::Compliant* pair = out.compliant.data();
    for (size_t n = 0; n < with_unknowns.size(); ++n) {
        const Constraint& c = *with_unknowns[n];
        for (int p = 0; p < c.pairs(); ++p) pair[p].K = 0;
        if (!open(c, x)) c.compliance(at(c, x), pair);
        pair += c.pairs();
        d.of_i.setZero(c.rows() + c.velocity_rows(), 6);
        d.of_j.setZero(c.rows() + c.velocity_rows(), 6);
        d.of_alpha.setZero(c.rows(), c.unknowns());
        if (open(c, x))
            d.of_alpha.setIdentity();  // its unknowns stay as they are
        else
            c.variation(at(c, x), d);
        fill(c, 0, c.first_row, c.rows());
        fill(c, c.rows(), c.first_velocity_row, c.velocity_rows());
        out.massless[n].D = d.of_alpha;
    }
}

void Model::nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    Eigen::Index n = 0;
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        out[n++] = block.nu(motion(x, block.i), motion(x, block.j), x.t);
    }
    out.tail(out.size() - n).setZero();
}

void Model::gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const
{
    Eigen::Index n = 0;
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        out[n++] = block.gamma(motion(x, block.i), motion(x, block.j), x.t);
    }
    double of_c[12];
    for (const auto& c : with_unknowns) {
        std::fill(of_c, of_c + 12, 0.0);
        if (!open(*c, x)) c->gamma(at(*c, x), of_c);
        std::copy_n(of_c, c->rows(), out.data() + c->first_row);
        std::copy_n(of_c + c->rows(), c->velocity_rows(), out.data() + c->first_velocity_row);
    }
}

void Model::track(State& x) const
{
    for (const auto& c : with_unknowns)
        if (!open(*c, x)) c->track(at(*c, x), false, x.alpha.data() + c->first_alpha);
}

void Model::second_variation(const State& x, lie::SecondVariation& out) const
{
    for (size_t n = 0; n < active.size(); ++n) {
        const Block& block = row[active[n]].in_force(x);
        const Mat12 H = block.second_variation(motion(x, block.i), motion(x, block.j), x.t);
        const int k = static_cast<int>(n), i = 0, j = block.i != ground ? 1 : 0;  // entries of the row
        if (block.i != ground) out.at(k, i, i) = H.topLeftCorner<6, 6>();
        if (block.j != ground) out.at(k, j, j) = H.bottomRightCorner<6, 6>();
        if (block.i == ground || block.j == ground) continue;
        out.at(k, i, j) = H.topRightCorner<6, 6>();
        out.at(k, j, i) = H.bottomLeftCorner<6, 6>();
    }
}

void Model::nu_variation(const State& x, lie::Rows& out) const
{
    lie::Rows::Entry* entry = out.entry.data();
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        const Variation v = block.nu_variation(motion(x, block.i), motion(x, block.j), x.t);
        if (block.i != ground) entry->r = v.r_i, entry->pi = v.pi_i, ++entry;
        if (block.j != ground) entry->r = v.r_j, entry->pi = v.pi_j, ++entry;
    }
}

void Model::gamma_variation(const State& x, lie::GammaVariation& out) const
{
    lie::GammaVariation::Entry* entry = out.entry.data();
    for (const int k : active) {
        const Block& block = row[k].in_force(x);
        const GammaChange g = block.gamma_variation(motion(x, block.i), motion(x, block.j), x.t);
        if (block.i != ground) *entry++ = {g.i.r, g.i.theta, g.i.rdot, g.i.omega};
        if (block.j != ground) *entry++ = {g.j.r, g.j.theta, g.j.rdot, g.j.omega};
    }
}

lie::LoadVariation Model::load_pattern() const
{
    lie::LoadVariation out;
    for (const auto& f : force)
        for (const int by : f->bodies())
            for (const int on : f->bodies())
                if (on != ground && by != ground) out.block.push_back({.on = on, .by = by});
    out.plus = out.minus = lie::Loads(bodies());
    return out;
}

void Model::load_variation(const State& x, lie::LoadVariation& out) const
{
    if (out.block.empty()) return;
    constexpr double h = 6e-6;  // truncation h² and rounding 1e-16/h balance here
    out.x = x;
    size_t first = 0;
    for (const auto& f : force) {
        size_t blocks = 0;
        for (const int by : f->bodies()) {
            if (by == ground) continue;
            Motion& moved = out.x.body[by];
            for (int c = 0; c < 12; ++c) {
                const auto evaluate = [&](double step, lie::Loads& loads) {
                    Vec3* const part[] = {&moved.r, nullptr, &moved.rdot, &moved.omega_bar};
                    if (c / 3 == 1)
                        moved.A = moved.A * lie::exp(step * Vec3::Unit(c - 3));
                    else
                        (*part[c / 3])[c % 3] += step;
                    loads.set_zero();
                    f->add(out.x, loads);
                    moved = x.body[by];
                };
                evaluate(h, out.plus);
                evaluate(-h, out.minus);
                size_t at = first + blocks;
                for (const int on : f->bodies())
                    if (on != ground)
                        out.block[at++].d.col(c) << (out.plus.F[on] - out.minus.F[on]) / (2 * h),
                            (out.plus.n_bar[on] - out.minus.n_bar[on]) / (2 * h);
            }
            for (const int on : f->bodies()) blocks += on != ground;
        }
        first += blocks;
    }
}

double Model::potential_energy(const State& x) const
{
    double e = 0;
    for (size_t b = 0; b < body.size(); ++b) e -= inertia.m[b] * gravity.dot(x.body[b].r);
    for (const auto& f : force) e += f->potential_energy(x);
    return e;
}

void Model::accepted(const State&, State& after) const
{
    swap_drivers(after);
    remember_contacts(after, false);
    for (const auto& f : force) f->remember(after);
}

void Model::remember_contacts(State& x, bool start) const
{
    for (const auto& c : with_unknowns)
        if (mode(*c, x) != Constraint::handed_over &&
            !c->remember(at(*c, x), start, x.remembered.data() + c->first_remembered))
            set_mode(*c, x, Constraint::handed_over);
}

void Model::set_mode(const Constraint& c, State& x, Constraint::Mode mode)
{
    x.memory[c.first_memory] = mode;
    x.lambda.segment(c.first_row, c.rows()).setZero();
    x.lambda.segment(c.first_velocity_row, c.velocity_rows()).setZero();
}

void Model::swap_drivers(State& x) const
{
    for (size_t n = 0; n < active.size(); ++n) {
        const Row& r = row[active[n]];
        if (!r.complement) continue;
        const auto& in_force = static_cast<const DP1&>(r.in_force(x));
        if (in_force.alignment(x.t) <= swap_above) continue;
        const Motion &bi = motion(x, in_force.i), &bj = motion(x, in_force.j);
        const Block& other = &in_force == r.block.get() ? *r.complement : *r.block;
        if (std::abs(other.phi(bi, bj, x.t)) > swap_mismatch) continue;
        const Variation from = in_force.variation(bi, bj, x.t);
        x.memory[r.branch] ^= 1;
        const Variation to = r.in_force(x).variation(bi, bj, x.t);
        x.lambda[static_cast<Eigen::Index>(n)] *= (from.pi_i.dot(to.pi_i) + from.pi_j.dot(to.pi_j)) /
                                                  (to.pi_i.squaredNorm() + to.pi_j.squaredNorm());
    }
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
