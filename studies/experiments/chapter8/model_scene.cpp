// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/model_scene.hpp"

#include "contact/evolving/unilateral.hpp"
#include "contact/rigid/rigid_contacts.hpp"
#include "dae/constraints/cd.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/start.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"

namespace hilda::studies {

using contact::ContactPairs;
using lie::Motion;
using lie::Vec3;

ModelScene::ModelScene(const ContactScene& of) : setup(of)
{
    model.gravity = setup.gravity;
    for (std::size_t b = 0; b < setup.body.size(); ++b) {
        const contact::Inertia& inertia = setup.body_types[setup.body[b].type].inertia;
        const Motion& start = setup.body[b].start;
        const std::string name = "body " + std::to_string(b);
        number.push_back(dae::ground);
        if (inertia.moves()) {
            number.back() = model.add({name, inertia.m, inertia.J_bar});
        } else {
            if (start.omega_bar != Vec3::Zero())
                lie::reject("studies::ModelScene", "a body without a finite mass must not rotate",
                            start.omega_bar.norm());
            if (start.rdot == Vec3::Zero()) continue;
            number.back() =
                model.add({name, setup.m, 0.4 * setup.m * setup.R * setup.R * lie::Mat3::Identity()});
            prescribe_motion(static_cast<int>(b));
        }
        initial.body.push_back(start);
    }
}

/// r = r(0) + ṙ(0) t, A = A(0)
void ModelScene::prescribe_motion(int b)
{
    const Motion& start = setup.body[b].start;
    dae::Blocks rows;
    for (int k = 0; k < 3; ++k)
        rows.push_back(std::make_unique<dae::CD>(Vec3::Unit(k), dae::ground, start.r, number[b], Vec3::Zero(),
                                                 dae::Driver(io::shortest(start.rdot[k]) + "*t")));
    for (int k = 0; k < 3; ++k)
        rows.push_back(std::make_unique<dae::DP1>(dae::ground, start.A * Vec3::Unit(k), number[b],
                                                  Vec3::Unit((k + 1) % 3)));
    model.constrain("motion of body " + std::to_string(b), std::move(rows));
}

void ModelScene::start(const std::string& scheme, const lie::Settings& settings)
{
    dae::start(model, initial, {.fix_initial = true});
    integrator = contact::make_integrator(model, lie::scheme(scheme), settings);
}

void ModelScene::step(double h)
{
    if (!march) march = std::make_unique<lie::March>(initial, *integrator, h);
    march->advance({});
}

contact::Shape ModelScene::shape(int b) const
{
    contact::Shape s = setup.body_types[setup.body[b].type].shape;
    if (number[b] != dae::ground) return s;
    const Motion& at = setup.body[b].start;
    s.position = at.r + at.A * s.position;
    s.orientation = at.A * s.orientation;
    return s;
}

double ModelScene::kinetic_energy() const
{
    double T = 0;
    for (std::size_t b = 0; b < state().body.size(); ++b) {
        const Motion& x = state().body[b];
        T += 0.5 * model.mass().m[b] * x.rdot.squaredNorm() +
             0.5 * x.omega_bar.dot(model.mass().J_bar[b] * x.omega_bar);
    }
    return T;
}

RigidScene::RigidScene(const ContactScene& setup) : of(setup)
{
    for (const ContactScene::Interaction& interaction : setup.interaction) add(interaction);
    of.start("rA-moreau-1", {});
}

void RigidScene::add(const ContactScene::Interaction& interaction)
{
    struct OfType {
        std::vector<int> moving, at_rest;  // body numbers of the model; numbers of the scene
        int example = -1;                  // a moving body of the scene
    };
    const auto of_type = [&](int type) {
        OfType out;
        for (int b = 0; b < static_cast<int>(of.setup.body.size()); ++b) {
            if (of.setup.body[b].type != type) continue;
            if (of.number[b] == dae::ground)
                out.at_rest.push_back(b);
            else
                out.moving.push_back(of.number[out.example = b]);
        }
        return out;
    };
    const auto contact_of = [&](std::vector<int> first, const contact::Shape& shape_i,
                                std::vector<int> second, const contact::Shape& shape_j, int at_rest) {
        ContactPairs pairs;
        pairs.each_two = at_rest < 0 && interaction.type_i == interaction.type_j;
        pairs.first = std::move(first), pairs.second = std::move(second);
        pairs.index();
        pairs.is_group = pairs.count() > 1;
        if (pairs.count() == 0) return;
        const contact::RigidLaw law{.mu_s = interaction.mu, .mu_k = interaction.mu};
        of.model.contact(std::make_unique<contact::RigidContacts>(interaction.name, of.model,
                                                                  std::move(pairs), shape_i, shape_j, law));
        ground_body.push_back(at_rest);
    };
    const OfType i = of_type(interaction.type_i), j = of_type(interaction.type_j);
    if (i.example >= 0 && j.example >= 0)
        contact_of(i.moving, of.shape(i.example), j.moving, of.shape(j.example), -1);
    if (i.example >= 0)
        for (const int b : j.at_rest)
            contact_of(i.moving, of.shape(i.example), {dae::ground}, of.shape(b), b);
    if (j.example >= 0 && interaction.type_i != interaction.type_j)
        for (const int b : i.at_rest)
            contact_of(j.moving, of.shape(j.example), {dae::ground}, of.shape(b), b);
}

Vec3 RigidScene::load_on(int b) const
{
    Vec3 F = Vec3::Zero();
    std::vector<contact::LoadedPoint> points;
    for (std::size_t c = 0; c < ground_body.size(); ++c) {
        const auto& contacts = dynamic_cast<const contact::RigidContacts&>(*of.model.rigid_contacts()[c]);
        contacts.for_touching_pairs(of.state(), [&](int number) {
            const auto [i, j] = contacts.pairs().pair(number);
            const bool on_j = j == dae::ground ? ground_body[c] == b : j == of.number[b];
            if (!on_j && i != of.number[b]) return;
            contacts.points(of.state(), number, points);
            for (const contact::LoadedPoint& p : points) F += (on_j ? -1 : 1) * (p.N * p.at.n + p.F);
        });
    }
    return F;
}

}  // namespace hilda::studies
