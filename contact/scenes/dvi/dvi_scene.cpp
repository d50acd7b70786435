// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/dvi/dvi_scene.hpp"

#include "contact/scenes/dvi/half_step_momentum.hpp"
#include "contact/scenes/free_bodies.hpp"
#include "contact/tangent_basis.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double rounding = 1e-14;

bool is_spherical(const Inertia& of)
{
    if (!of.turns()) return true;
    const double mean = of.J_bar.trace() / 3;
    return (of.J_bar - mean * Mat3::Identity()).norm() <= rounding * mean;
}

}  // namespace

int DviScene::add(const Inertia& of, const Motion& at)
{
    if (of.moves() && !(of.m > 0))
        lie::reject("contact::DviScene", "the mass of a body must be positive", of.m);
    inertia.push_back(of);
    inverse.push_back({of.moves() ? 1 / of.m : 0, of.J_bar_inverse(), is_spherical(of)});
    body.push_back(at);
    return static_cast<int>(body.size()) - 1;
}

DviScene::RigidContact DviScene::make_contact(const std::string& name, const Shape& i, const Inertia& of_i,
                                              const Shape& j, const Inertia& of_j, const RigidLaw& law) const
{
    const std::string where = "contact '" + name + "'";
    if (!(law.mu >= 0) || !std::isfinite(law.mu)) lie::reject(where, "mu must not be negative", law.mu);
    if (!(law.restitution >= 0 && law.restitution <= 1))
        lie::reject(where, "the coefficient of restitution must be in [0, 1]", law.restitution);
    if (!of_i.moves() && !of_i.turns() && !of_j.moves() && !of_j.turns())
        lie::reject(where, "a contact needs at least one movable body", "two fixed bodies");
    return {name, law, make_detector(i, j)};
}

int DviScene::add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
                  const RigidLaw& law)
{
    for (const int b : {i, j})
        if (b < 0 || b >= static_cast<int>(body.size()))
            lie::reject("contact::DviScene", "no body has this index", b);
    if (i == j) lie::reject("contact::DviScene", "a contact needs two different bodies", i);
    pair.push_back({make_contact(name, shape_i, inertia[i], shape_j, inertia[j], law), i, j});
    return static_cast<int>(pair.size()) - 1;
}

int DviScene::add(const BodyType& type) { return neighbors.add_type(type); }

int DviScene::add_body(int type, const Motion& at)
{
    const int b = add(neighbors.body_type(type).inertia, at);
    neighbors.add_body(b, type);
    return b;
}

void DviScene::set_contact_law(const std::string& name, int type_i, int type_j, const RigidLaw& law)
{
    const BodyType &i = neighbors.body_type(type_i), &j = neighbors.body_type(type_j);
    neighbors.set_law(
        type_i, type_j,
        std::make_unique<RigidContact>(make_contact(name, i.shape, i.inertia, j.shape, j.inertia, law)));
}

void DviScene::step(double h)
{
    if (!(h > 0) || !std::isfinite(h)) lie::reject("contact::DviScene", "the step must be positive", h);
    const double h_before = h_previous > 0 || options.half_kick ? h_previous : h;
    const double kick = 0.5 * (h_before + h);
    predict_free_velocities(h_before, h);
    assemble_problem(h, kick);
    if (options.sliding == DviOptions::coulomb)
        outcome = solver.solve_coulomb(problem, gamma, slip);
    else
        outcome = solver.solve(problem, gamma);
    apply_impulses(h, kick);
}

/// v* and ω*: the velocities after a step without contacts
void DviScene::predict_free_velocities(double h_before, double h)
{
    const double kick = 0.5 * (h_before + h);
    const size_t bodies = body.size();
    problem.body.resize(bodies);
    momentum.resize(bodies);
    start_velocity.resize(bodies);
    free_velocity.resize(bodies);
    for (size_t b = 0; b < bodies; ++b) {
        const Motion& m = body[b];
        const Inverse& of = inverse[b];
        problem.body[b] = {of.m, m.A * of.J_bar * m.A.transpose()};
        start_velocity[b] = {m.rdot, m.A * m.omega_bar};
        free_velocity[b] = {of.m > 0 ? Vec3(m.rdot + kick * gravity) : m.rdot, start_velocity[b].omega};
        if (of.spherical) continue;
        const Mat3& J_bar = inertia[b].J_bar;
        momentum[b] = node_momentum(-h_before * m.omega_bar, J_bar * m.omega_bar);
        free_velocity[b].omega = m.A * half_step_omega(J_bar, of.J_bar, momentum[b], h, m.omega_bar);
    }
}

void DviScene::add_contact_rows(const RigidContact& of, int i, int j, PairState& state, double margin)
{
    const Motion &bi = body[i], &bj = body[j];
    try {
        state.contact_point = of.detector->detect(bi, bj, state.found ? &state.points : nullptr);
    } catch (const lie::NumericalFailure& e) {
        throw lie::NumericalFailure(e.status, "contact '" + of.name + "': " + e.what());
    }
    const ContactPoint& contact_point = state.contact_point;
    state.points = {bi.A.transpose() * (contact_point.C_i - bi.r),
                    bj.A.transpose() * (contact_point.C_j - bj.r)};
    state.found = true;
    state.active = contact_point.gap < margin;
    if (!state.active) {
        state.F.setZero();
        return;
    }
    Mat3 frame;
    frame << contact_point.n, tangent_basis(contact_point.n);
    const Vec3 C = contact_point.C();
    problem.contact.push_back({i, j, frame, C - bi.r, C - bj.r, of.law.mu, Vec3::Zero()});
    active.push_back({&state, of.law.restitution});
}

/// The cone problem of the contacts at t_n and its initial guess
void DviScene::assemble_problem(double h, double kick)
{
    problem.contact.clear();
    active.clear();
    for (Pair& p : pair) add_contact_rows(p.contact, p.i, p.j, p.state, options.margin);
    for (auto& p : neighbors.find(body))
        add_contact_rows(*p.law, p.i, p.j, p.state, std::min(options.margin, neighbors.margin));

    problem.relative_velocities(start_velocity, u_start);
    problem.relative_velocities(free_velocity, u_free);
    gamma.resize(active.size());
    slip.resize(active.size());
    for (size_t c = 0; c < active.size(); ++c) {
        ConeProblem::ContactPair& at = problem.contact[c];
        const PairState& state = *active[c].state;
        const double gap = state.contact_point.gap;
        double b = (options.stabilised ? gap : std::max(gap, 0.)) / h;
        const double approach = -u_start[c][0];
        const double rebound = active[c].restitution * approach;
        if (rebound > 0 && u_free[c][0] + gap / h < 0)  // the contact closes within this step
            b = std::min(b, -rebound);
        at.r = u_free[c];
        at.r[0] += b;
        slip[c] = std::hypot(u_start[c][1], u_start[c][2]);
        if (options.sliding == DviOptions::lagged) at.r[0] += at.mu * slip[c];
        gamma[c].noalias() = kick * (at.frame.transpose() * state.F);
    }
}

void DviScene::apply_impulses(double h, double kick)
{
    problem.velocity_change(gamma, velocity_change);
    omega_bar.resize(body.size());
    for (size_t b = 0; b < body.size(); ++b) {
        const Motion& m = body[b];
        omega_bar[b] = m.A.transpose() * (free_velocity[b].omega + velocity_change[b].omega);
        if (inverse[b].spherical) continue;
        const Mat3& J_bar = inertia[b].J_bar;
        const Vec3 moment = J_bar * (m.A.transpose() * velocity_change[b].omega);
        omega_bar[b] = half_step_omega(J_bar, inverse[b].J_bar, momentum[b] + moment, h, omega_bar[b]);
    }
    for (size_t c = 0; c < active.size(); ++c)
        active[c].state->F.noalias() = problem.contact[c].frame * gamma[c] / kick;
    for (size_t b = 0; b < body.size(); ++b) {
        Motion& m = body[b];
        const Vec3 rdot = free_velocity[b].v + velocity_change[b].v;
        m.rddot = (rdot - m.rdot) / kick;
        m.omegadot_bar = (omega_bar[b] - m.omega_bar) / kick;
        m.rdot = rdot;
        m.omega_bar = omega_bar[b];
        drift(m, h);
    }
    h_previous = h;
    t += h;
}

double DviScene::kinetic_energy() const { return contact::kinetic_energy(inertia, body); }

}  // namespace hilda::contact
