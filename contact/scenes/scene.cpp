// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/scene.hpp"

#include "contact/scenes/free_bodies.hpp"
#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

int Scene::add(const Inertia& of, const Motion& start)
{
    if (of.moves() && !(of.m > 0)) lie::reject("contact::Scene", "the mass of a body must be positive", of.m);
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
            lie::reject("contact::Scene", "no body has this index", b);
    if (i == j) lie::reject("contact::Scene", "a contact needs two different bodies", i);
    pair.push_back({.contact = CompliantContact(name, shape_i, shape_j, inertia[i], inertia[j],
                                                std::move(law), std::move(friction)),
                    .i = i,
                    .j = j});
    return static_cast<int>(pair.size()) - 1;
}

int Scene::add(const BodyType& type) { return neighbors.add_type(type); }

int Scene::add_body(int type, const Motion& start)
{
    const int b = add(neighbors.body_type(type).inertia, start);
    neighbors.add_body(b, type);
    return b;
}

void Scene::set_contact_law(const std::string& name, int type_i, int type_j,
                            std::shared_ptr<const NormalLaw> law,
                            std::shared_ptr<const FrictionModel> friction)
{
    const BodyType &i = neighbors.body_type(type_i), &j = neighbors.body_type(type_j);
    neighbors.set_law(type_i, type_j,
                      std::make_unique<CompliantContact>(name, i.shape, j.shape, i.inertia, j.inertia,
                                                         std::move(law), std::move(friction)));
}

void Scene::check(double h) const
{
    double weight = 0;  // of all bodies: an upper estimate of the load on one contact [N]
    for (const Inertia& of : inertia)
        if (of.moves()) weight += gravity.norm() * of.m;
    struct CheckedContact {
        const CompliantContact& contact;
        int i, j;
        const ContactHistory& history;
    };
    std::vector<CheckedContact> checked;
    for (const Pair& p : pair) checked.push_back({p.contact, p.i, p.j, p.history});
    const auto near = neighbors.pairs_near(body);
    for (const auto& p : near) checked.push_back({*p.law, p.i, p.j, p.state.history});
    std::vector<double> contacts(body.size());
    for (const CheckedContact& p : checked) {
        const Motion &bi = body[p.i], &bj = body[p.j];
        if (const std::string why = p.contact.start_error(bi, bj); !why.empty())
            throw lie::InvalidInput("contact '" + p.contact.name + "': " + why);
        if (p.contact.is_near_contact(bi, bj, p.history)) ++contacts[p.i], ++contacts[p.j];
    }
    for (const CheckedContact& p : checked) {
        const Motion &bi = body[p.i], &bj = body[p.j];
        const double bound =
            p.contact.stable_step(p.contact.state_at_largest_compression(bi, bj, p.history, weight), bi, bj,
                                  {std::max(1., contacts[p.i]), std::max(1., contacts[p.j])});
        if (h > bound) {
            std::ostringstream what;
            what << "contact '" << p.contact.name << "': the step must not exceed its stability bound of "
                 << bound << " s, got " << h;
            throw lie::InvalidInput(what.str());
        }
    }
}

/// Adds the loads of one contact at t_n to F and T and updates its history.
template <class PairData>
void Scene::add_contact_loads(const CompliantContact& contact, int i, int j, PairData& data, double h)
{
    const Motion &bi = body[i], &bj = body[j];
    data.contact_state = contact.evaluate(bi, bj, data.history);
    contact.advance(data.contact_state, bi, bj, data.history);
    if (!(data.contact_state.N > 0)) {
        data.wrench = {};
        return;
    }
    data.wrench = contact.load(data.contact_state, mean_rates(data.contact_state.slip, h), data.history);
    const Vec3 C = data.contact_state.contact_point.C(),
               on_i = data.contact_state.N * data.contact_state.contact_point.n + data.wrench.F;
    F[i] += on_i;
    T[i] += (C - bi.r).cross(on_i) + data.wrench.T_i;
    F[j] -= on_i;
    T[j] += (bj.r - C).cross(on_i) + data.wrench.T_j;
}

void Scene::step(double h)
{
    for (size_t b = 0; b < body.size(); ++b) {
        F[b].setZero();
        T[b].setZero();
    }
    for (Pair& p : pair) add_contact_loads(p.contact, p.i, p.j, p, h);
    for (auto& p : neighbors.find(body)) add_contact_loads(*p.law, p.i, p.j, p.state, h);
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
        drift(m, h);
    }
    t += h;
}

double Scene::kinetic_energy() const { return contact::kinetic_energy(inertia, body); }

}  // namespace hilda::contact
