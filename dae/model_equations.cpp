// SPDX-License-Identifier: GPL-3.0-or-later
// What a model is to a stepper: its equations in a state, and what changes when a step is accepted.
#include "dae/constraints/dp1.hpp"
#include "dae/model.hpp"

namespace hilda::dae {

namespace {

// A driver is swapped for its complement above this |f| / (|a_i||a_j|); the complement is then below 0.44.
constexpr double swap_above = 0.9;
// The complement must hold where it takes over; it does not when the driven vectors leave the plane of the
// turn.
constexpr double swap_mismatch = 1e-6;

}  // namespace

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
        if (inactive(*c, x))
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
    lie::Rows::Regularised* pair = out.regularised.data();
    for (size_t n = 0; n < with_unknowns.size(); ++n) {
        const Constraint& c = *with_unknowns[n];
        for (int p = 0; p < c.pairs(); ++p) pair[p].K = 0;
        if (!inactive(c, x)) c.compliance(at(c, x), pair);
        pair += c.pairs();
        d.of_i.setZero(c.rows() + c.velocity_rows(), 6);
        d.of_j.setZero(c.rows() + c.velocity_rows(), 6);
        d.of_alpha.setZero(c.rows(), c.unknowns());
        if (inactive(c, x))
            d.of_alpha.setIdentity();  // its unknowns stay as they are
        else
            c.variation(at(c, x), d);
        fill(c, 0, c.first_row, c.rows());
        fill(c, c.rows(), c.first_velocity_row, c.velocity_rows());
        out.algebraic[n].D = d.of_alpha;
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
        if (!inactive(*c, x)) c->gamma(at(*c, x), of_c);
        std::copy_n(of_c, c->rows(), out.data() + c->first_row);
        std::copy_n(of_c + c->rows(), c->velocity_rows(), out.data() + c->first_velocity_row);
    }
}

void Model::update_alpha(State& x) const
{
    for (const auto& c : with_unknowns)
        if (!inactive(*c, x)) c->update_alpha(at(*c, x), false, x.alpha.data() + c->first_alpha);
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
    update_contact_states(after, false);
    for (const auto& f : force) f->update_internal_state(after);
}

void Model::update_contact_states(State& x, bool start) const
{
    for (const auto& c : with_unknowns)
        if (mode(*c, x) != Constraint::fallback_active &&
            !c->update_internal_state(at(*c, x), start, x.internal_state.data() + c->first_internal_state))
            set_mode(*c, x, Constraint::fallback_active);
}

void Model::set_mode(const Constraint& c, State& x, Constraint::Mode mode)
{
    x.discrete_state[c.first_discrete_state] = mode;
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
        x.discrete_state[r.branch] ^= 1;
        const Variation to = r.in_force(x).variation(bi, bj, x.t);
        x.lambda[static_cast<Eigen::Index>(n)] *= (from.pi_i.dot(to.pi_i) + from.pi_j.dot(to.pi_j)) /
                                                  (to.pi_i.squaredNorm() + to.pi_j.squaredNorm());
    }
}

}  // namespace hilda::dae
