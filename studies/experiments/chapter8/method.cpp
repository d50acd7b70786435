// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/method.hpp"

#include "studies/experiments/chapter8/model_scene.hpp"

#include <algorithm>

namespace hilda::studies::methods {

namespace {

using contact::EvolvingContact;

/// Adds a contact constraint for each pair of bodies that are near each other at the start.
void add_contacts(ModelScene& scene, const EvolvingOptions& options)
{
    for (const ContactScene::Interaction& interaction : scene.setup.interaction)
        if (interaction.mu > 0)
            lie::reject("studies::methods::evolving", "the contacts must be frictionless, mu",
                        interaction.mu);
    for (const auto& [i, j] : contact_pairs(scene.setup, options.reach)) {
        if (scene.number[i] == dae::ground && scene.number[j] == dae::ground) continue;
        scene.model.constrain("contact " + std::to_string(i) + "-" + std::to_string(j),
                              std::make_unique<EvolvingContact>(
                                  scene.number[i], scene.shape(i), scene.number[j], scene.shape(j),
                                  EvolvingContact::Friction::none, EvolvingContact::NormalRows::tangent,
                                  contact::Unilateral{.enabled = options.unilateral}));
    }
}

}  // namespace

Method evolving(const ContactScene& setup, const EvolvingOptions& options)
{
    const auto scene = std::make_shared<ModelScene>(setup);
    add_contacts(*scene, options);
    scene->start(options.scheme, {.tolerance = options.tolerance, .linear_solver = options.solver});
    const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(scene->integrator.get());
    return {
        .step = [=](double h) { scene->step(h); },
        .body = [=](int b) -> const lie::Motion& { return scene->body(b); },
        .contacts =
            [=] {
                return static_cast<int>(std::ranges::count_if(
                    scene->model.general_constraints(),
                    [&](const auto& c) { return !dae::Model::inactive(*c, scene->state()); }));
            },
        .iterations = [=] { return scene->integrator->statistics().iterations; },
        .events = [=] { return unilateral != nullptr ? static_cast<int>(unilateral->events().size()) : 0; }};
}

Method dvi(const ContactScene& setup)
{
    const auto scene = std::make_shared<RigidScene>(setup);
    return {.step = [=](double h) { scene->step(h); },
            .body = [=](int b) -> const lie::Motion& { return scene->of.body(b); },
            .contacts = [=] { return static_cast<int>(scene->of.state().cone_forces.size()); },
            .iterations = [=] { return scene->of.integrator->statistics().cone_iterations; }};
}

Method compliant_springs(const ContactScene& setup, const Compliance& options)
{
    const auto scene = std::make_shared<contact::Scene>(compliant(setup, options));
    const auto steps = std::make_shared<long>(0);
    return {.step = [=](double h) { scene->step(h), ++*steps; },
            .body = [=](int b) -> const lie::Motion& { return scene->body[b]; },
            .contacts =
                [=] {
                    return static_cast<int>(std::ranges::count_if(
                        scene->neighbors.pair(), [](const auto& p) { return p.state.contact_state.N > 0; }));
                },
            .iterations = [=] { return *steps; }};
}

}  // namespace hilda::studies::methods
