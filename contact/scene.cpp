// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scene.hpp"

#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

int Scene::add(const Inertia& of, const Motion& start)
{
    if (of.moves() && !(of.m > 0)) lie::reject("contact::Scene", "a mass must be positive", of.m);
    inertia.push_back(of);
    inverse.push_back({of.moves() ? 1 / of.m : 0, of.J_bar_inverse()});
    body.push_back(start);
    F.emplace_back();
    T.emplace_back();
    return static_cast<int>(body.size()) - 1;
}

int Scene::add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
               std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction)
{
    for (const int b : {i, j})
        if (b < 0 || b >= static_cast<int>(body.size()))
            lie::reject("contact::Scene", "no body has this number", b);
    if (i == j) lie::reject("contact::Scene", "a contact needs two different bodies", i);
    pair.push_back({.contact = Contact(name, shape_i, shape_j, inertia[i], inertia[j], std::move(law),
                                       std::move(friction)),
                    .i = i,
                    .j = j});
    return static_cast<int>(pair.size()) - 1;
}

void Scene::check(double h) const
{
    double weight = 0;  // all that may rest on a contact
    for (const Inertia& of : inertia)
        if (of.moves()) weight += gravity.norm() * of.m;
    std::vector<int> contacts(body.size());
    for (const Pair& p : pair) {
        const Motion &bi = body[p.i], &bj = body[p.j];
        if (const std::string why = p.contact.objection(bi, bj); !why.empty())
            throw lie::InvalidInput("contact '" + p.contact.name + "': " + why);
        if (p.contact.close(bi, bj, p.memory)) ++contacts[p.i], ++contacts[p.j];
    }
    for (const Pair& p : pair) {
        const Motion &bi = body[p.i], &bj = body[p.j];
        const double bound = p.contact.stable_step(p.contact.hardest(bi, bj, p.memory, weight), bi, bj,
                                                   std::max(1, contacts[p.i]), std::max(1, contacts[p.j]));
        if (h > bound) {
            std::ostringstream what;
            what << "contact '" << p.contact.name << "': the step must not exceed its stability bound of "
                 << bound << " s, got " << h;
            throw lie::InvalidInput(what.str());
        }
    }
}

void Scene::step(double h)
{
    for (size_t b = 0; b < body.size(); ++b) {
        F[b].setZero();
        T[b].setZero();
    }
    for (Pair& p : pair) {
        const Motion &bi = body[p.i], &bj = body[p.j];
        p.meeting = p.contact.meet(bi, bj, p.memory);
        p.contact.advance(p.meeting, bi, bj, p.memory);
        if (!(p.meeting.N > 0)) {
            p.wrench = {};
            continue;
        }
        p.wrench = p.contact.load(p.meeting, mean_rates(p.meeting.slip, h), p.memory);
        const Vec3 C = p.meeting.touch.C(), on_i = p.meeting.N * p.meeting.touch.n + p.wrench.F;
        F[p.i] += on_i;
        T[p.i] += (C - bi.r).cross(on_i) + p.wrench.T_i;
        F[p.j] -= on_i;
        T[p.j] += (bj.r - C).cross(on_i) + p.wrench.T_j;
    }
    for (size_t b = 0; b < body.size(); ++b) {
        Motion& m = body[b];
        const Inverse& of = inverse[b];
        if (of.m > 0) {
            m.rddot = gravity + of.m * F[b];
            m.rdot += h * m.rddot;
        }
        if (inertia[b].turns()) {
            const Mat3& J_bar = inertia[b].J_bar;
            m.omegadot_bar = of.J_bar * (m.A.transpose() * T[b] - m.omega_bar.cross(J_bar * m.omega_bar));
            m.omega_bar += h * m.omegadot_bar;
        }
        m.r += h * m.rdot;
        if (m.omega_bar != Vec3::Zero()) m.A = lie::orthonormalised(m.A * lie::exp(h * m.omega_bar));
    }
    t += h;
}

double Scene::kinetic_energy() const
{
    double T = 0;
    for (size_t b = 0; b < body.size(); ++b) {
        if (inertia[b].moves()) T += 0.5 * inertia[b].m * body[b].rdot.squaredNorm();
        if (inertia[b].turns()) T += 0.5 * body[b].omega_bar.dot(inertia[b].J_bar * body[b].omega_bar);
    }
    return T;
}

}  // namespace hilda::contact
