// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/dvi/dvi_scene.hpp"

#include "contact/scenes/dvi/half_step_momentum.hpp"
#include "contact/scenes/free_bodies.hpp"
#include "contact/tangent_basis.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double rounding = 1e-14;

bool is_round(const Inertia& of)
{
    if (!of.turns()) return true;
    const double mean = of.J_bar.trace() / 3;
    return (of.J_bar - mean * Mat3::Identity()).norm() <= rounding * mean;
}

}  // namespace

int DviScene::add(const Inertia& of, const Motion& at)
{
    if (of.moves() && !(of.m > 0)) lie::reject("contact::DviScene", "a mass must be positive", of.m);
    inertia.push_back(of);
    inverse.push_back({of.moves() ? 1 / of.m : 0, of.J_bar_inverse(), is_round(of)});
    body.push_back(at);
    return static_cast<int>(body.size()) - 1;
}

DviScene::Surfaces DviScene::surfaces(const std::string& name, const Shape& i, const Inertia& of_i,
                                      const Shape& j, const Inertia& of_j, const RigidLaw& law) const
{
    const std::string where = "contact '" + name + "'";
    if (!(law.mu >= 0) || !std::isfinite(law.mu)) lie::reject(where, "mu must not be negative", law.mu);
    if (!(law.restitution >= 0 && law.restitution <= 1))
        lie::reject(where, "the coefficient of restitution must be in [0, 1]", law.restitution);
    if (!of_i.moves() && !of_i.turns() && !of_j.moves() && !of_j.turns())
        lie::reject(where, "a contact needs a body that moves", "two that do not");
    return {name, law, make_detector(i, j)};
}

int DviScene::add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
                  const RigidLaw& law)
{
    for (const int b : {i, j})
        if (b < 0 || b >= static_cast<int>(body.size()))
            lie::reject("contact::DviScene", "no body has this number", b);
    if (i == j) lie::reject("contact::DviScene", "a contact needs two different bodies", i);
    pair.push_back({surfaces(name, shape_i, inertia[i], shape_j, inertia[j], law), i, j});
    return static_cast<int>(pair.size()) - 1;
}

int DviScene::add(const BodyType& kind) { return neighbors.add(kind); }

int DviScene::enter(int kind, const Motion& at)
{
    const int b = add(neighbors.kind(kind).inertia, at);
    neighbors.enter(b, kind);
    return b;
}

void DviScene::between(const std::string& name, int kind_i, int kind_j, const RigidLaw& law)
{
    const BodyType &i = neighbors.kind(kind_i), &j = neighbors.kind(kind_j);
    neighbors.set(kind_i, kind_j,
                  std::make_unique<Surfaces>(surfaces(name, i.shape, i.inertia, j.shape, j.inertia, law)));
}

void DviScene::step(double h)
{
    if (!(h > 0) || !std::isfinite(h)) lie::reject("contact::DviScene", "the step must be positive", h);
    const double before = h_before > 0 || options.half_kick ? h_before : h;
    const double kick = 0.5 * (before + h);
    release(before, h);
    pose(h, kick);
    if (options.sliding == DviOptions::coulomb)
        solved = solver.solve_coulomb(problem, gamma, slip);
    else
        solved = solver.solve(problem, gamma);
    advance(h, kick);
}

/// v* and ω*: the step without contacts
void DviScene::release(double before, double h)
{
    const double kick = 0.5 * (before + h);
    const size_t bodies = body.size();
    problem.body.resize(bodies);
    momentum.resize(bodies);
    start.resize(bodies);
    freely.resize(bodies);
    for (size_t b = 0; b < bodies; ++b) {
        const Motion& m = body[b];
        const Inverse& of = inverse[b];
        problem.body[b] = {of.m, m.A * of.J_bar * m.A.transpose()};
        start[b] = {m.rdot, m.A * m.omega_bar};
        freely[b] = {of.m > 0 ? Vec3(m.rdot + kick * gravity) : m.rdot, start[b].omega};
        if (of.round) continue;
        const Mat3& J_bar = inertia[b].J_bar;
        momentum[b] = node_momentum(-before * m.omega_bar, J_bar * m.omega_bar);
        freely[b].omega = m.A * half_step_omega(J_bar, of.J_bar, momentum[b], h, m.omega_bar);
    }
}

void DviScene::detect_contact(const Surfaces& of, int i, int j, Encounter& state, double within)
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
    state.active = contact_point.gap < within;
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

/// The cone problem of the contacts at t_n
void DviScene::pose(double h, double kick)
{
    problem.contact.clear();
    active.clear();
    for (Pair& p : pair) detect_contact(p.surfaces, p.i, p.j, p.state, options.margin);
    for (auto& p : neighbors.find(body))
        detect_contact(*p.law, p.i, p.j, p.state, std::min(options.margin, neighbors.margin));

    problem.relative(start, u_start);
    problem.relative(freely, u_free);
    gamma.resize(active.size());
    slip.resize(active.size());
    for (size_t c = 0; c < active.size(); ++c) {
        ConeProblem::ContactPair& at = problem.contact[c];
        const Encounter& state = *active[c].state;
        const double gap = state.contact_point.gap;
        double b = (options.stabilised ? gap : std::max(gap, 0.)) / h;
        const double approach = -u_start[c][0];
        const double rebound = active[c].restitution * approach;
        if (rebound > 0 && u_free[c][0] + gap / h < 0)  // reached within this step
            b = std::min(b, -rebound);
        at.r = u_free[c];
        at.r[0] += b;
        slip[c] = std::hypot(u_start[c][1], u_start[c][2]);
        if (options.sliding == DviOptions::lagged) at.r[0] += at.mu * slip[c];
        gamma[c].noalias() = kick * (at.frame.transpose() * state.F);
    }
}

void DviScene::advance(double h, double kick)
{
    problem.respond(gamma, change);
    omega_bar.resize(body.size());
    for (size_t b = 0; b < body.size(); ++b) {
        const Motion& m = body[b];
        omega_bar[b] = m.A.transpose() * (freely[b].omega + change[b].omega);
        if (inverse[b].round) continue;
        const Mat3& J_bar = inertia[b].J_bar;
        const Vec3 moment = J_bar * (m.A.transpose() * change[b].omega);
        omega_bar[b] = half_step_omega(J_bar, inverse[b].J_bar, momentum[b] + moment, h, omega_bar[b]);
    }
    for (size_t c = 0; c < active.size(); ++c)
        active[c].state->F.noalias() = problem.contact[c].frame * gamma[c] / kick;
    for (size_t b = 0; b < body.size(); ++b) {
        Motion& m = body[b];
        const Vec3 rdot = freely[b].v + change[b].v;
        m.rddot = (rdot - m.rdot) / kick;
        m.omegadot_bar = (omega_bar[b] - m.omega_bar) / kick;
        m.rdot = rdot;
        m.omega_bar = omega_bar[b];
        drift(m, h);
    }
    h_before = h;
    t += h;
}

double DviScene::kinetic_energy() const { return contact::kinetic_energy(inertia, body); }

}  // namespace hilda::contact
