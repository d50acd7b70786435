// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/method.hpp"

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"

#include <algorithm>

namespace hilda::studies::methods {

namespace {

using contact::EvolvingContact;
using contact::Shape;
using lie::Motion;

bool has_finite_mass(const ContactScene& setup, int b)
{
    return std::isfinite(setup.body_types[setup.body[b].type].inertia.m);
}

/// A model with the bodies of finite mass, and a contact constraint for each pair
class EvolvingScene {
public:
    EvolvingScene(const ContactScene& setup, const EvolvingOptions& options)
    {
        for (const ContactScene::Interaction& interaction : setup.interaction)
            if (interaction.mu > 0)
                lie::reject("studies::methods::evolving", "the contacts must be frictionless, mu",
                            interaction.mu);
        model.gravity = setup.gravity;
        lie::State x;
        for (size_t b = 0; b < setup.body.size(); ++b) {
            const contact::BodyType& type = setup.body_types[setup.body[b].type];
            number.push_back(dae::ground);
            if (!has_finite_mass(setup, static_cast<int>(b))) continue;
            number.back() = model.add({"body " + std::to_string(b), type.inertia.m, type.inertia.J_bar});
            x.body.push_back(setup.body[b].start);
        }
        for (const contact::Candidate& pair : contact_pairs(setup, options.reach))
            add(setup, options, pair.i, pair.j);
        dae::start(model, x, {.fix_initial = true});
        integrator =
            contact::make_integrator(model, lie::scheme(options.scheme),
                                     {.tolerance = options.tolerance, .linear_solver = options.solver});
        start = x;
    }

    void step(double h)
    {
        // The steps are timed beside those of methods without checks: no run::Simulation
        if (!march) march = std::make_unique<lie::March>(start, *integrator, h);
        march->advance({});
    }
    const lie::State& state() const { return march ? march->node() : start; }

    dae::Model model;
    std::vector<int> number;  // index of each body in the model; ground for fixed bodies
    std::unique_ptr<lie::Integrator> integrator;

private:
    void add(const ContactScene& setup, const EvolvingOptions& options, int i, int j)
    {
        if (!has_finite_mass(setup, i) && !has_finite_mass(setup, j)) return;
        model.constrain(
            "contact " + std::to_string(i) + "-" + std::to_string(j),
            std::make_unique<EvolvingContact>(
                number[i], shape(setup, i), number[j], shape(setup, j), EvolvingContact::Friction::none,
                EvolvingContact::NormalRows::tangent, contact::Unilateral{.enabled = options.unilateral}));
    }

    /// Shape of body b, in the frame of the ground if the body is part of the ground
    Shape shape(const ContactScene& setup, int b) const
    {
        Shape s = setup.body_types[setup.body[b].type].shape;
        if (number[b] != dae::ground) return s;
        const Motion& at = setup.body[b].start;
        if (at.rdot != lie::Vec3::Zero() || at.omega_bar != lie::Vec3::Zero())
            lie::reject("studies::methods::evolving", "a body without a finite mass must be at rest", b);
        s.position = at.r + at.A * s.position;
        s.orientation = at.A * s.orientation;
        return s;
    }

    lie::State start;
    std::unique_ptr<lie::March> march;
};

}  // namespace

Method evolving(const ContactScene& setup, const EvolvingOptions& options)
{
    const auto scene = std::make_shared<EvolvingScene>(setup, options);
    const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(scene->integrator.get());
    return {
        .step = [=](double h) { scene->step(h); },
        .body = [=](int b) -> const Motion& { return scene->state().body[scene->number[b]]; },
        .contacts =
            [=] {
                return static_cast<int>(std::ranges::count_if(
                    scene->model.general_constraints(),
                    [&](const auto& c) { return !dae::Model::inactive(*c, scene->state()); }));
            },
        .iterations = [=] { return scene->integrator->statistics().iterations; },
        .events = [=] { return unilateral != nullptr ? static_cast<int>(unilateral->events().size()) : 0; }};
}

Method dvi(const ContactScene& setup, const DviMethodOptions& options)
{
    const auto scene = std::make_shared<contact::DviScene>(rigid(setup));
    scene->options.stabilised = options.stabilised;
    scene->options.half_kick = options.half_kick;
    scene->solver.tolerance = options.tolerance;
    scene->solver.max_iterations = options.max_iterations;
    const auto sum = std::make_shared<long>(0);
    return {.step = [=](double h) { scene->step(h), *sum += scene->outcome.iterations; },
            .body = [=](int b) -> const Motion& { return scene->body[b]; },
            .contacts = [=] { return scene->contacts(); },
            .iterations = [=] { return *sum; }};
}

Method compliant_springs(const ContactScene& setup, const Compliance& options)
{
    const auto scene = std::make_shared<contact::Scene>(compliant(setup, options));
    const auto steps = std::make_shared<long>(0);
    return {.step = [=](double h) { scene->step(h), ++*steps; },
            .body = [=](int b) -> const Motion& { return scene->body[b]; },
            .contacts =
                [=] {
                    return static_cast<int>(std::ranges::count_if(
                        scene->neighbors.pair(), [](const auto& p) { return p.state.contact_state.N > 0; }));
                },
            .iterations = [=] { return *steps; }};
}

}  // namespace hilda::studies::methods
