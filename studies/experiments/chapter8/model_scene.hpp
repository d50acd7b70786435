// SPDX-License-Identifier: GPL-3.0-or-later
/// A scene of contact_scenes.hpp as a multibody model.

#pragma once

#include "dae/model.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "studies/experiments/chapter8/contact_scenes.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::studies {

/// The bodies of a scene as a model, and its integration. Bodies without a finite mass that are at rest are
/// part of the ground. One that moves has the mass of a ball, and constraints prescribe its motion with
/// constant velocity and without rotation.
class ModelScene {
public:
    /// Adds the bodies. InvalidInput for a rotating body without a finite mass.
    explicit ModelScene(const ContactScene& setup);
    ModelScene(const ModelScene&) = delete;  ///< contacts refer to the model

    /// Prepares the integration, after the contacts were added. The data are projected onto the constraints.
    void start(const std::string& scheme, const lie::Settings& settings);
    /// Advances by h [s], the same h in all steps. The steps are timed beside those of methods without
    /// checks: they are those of lie::March and not of run::Simulation.
    void step(double h);

    const lie::State& state() const { return march ? march->node() : initial; }
    /// Body b of the scene, which must not be part of the ground
    const lie::Motion& body(int b) const { return state().body[static_cast<std::size_t>(number[b])]; }
    /// Shape of body b, in the frame of the ground if the body is part of the ground
    contact::Shape shape(int b) const;
    double kinetic_energy() const;  ///< [J]

    const ContactScene setup;
    dae::Model model;
    std::vector<int> number;  ///< of each body in the model; dae::ground for those at rest
    std::unique_ptr<lie::Integrator> integrator;

private:
    void prescribe_motion(int b);

    lie::State initial;
    std::unique_ptr<lie::March> march;
};

/// The rigid contacts of a scene: Signorini's condition without restitution, and Coulomb's law
class RigidScene {
public:
    /// The scheme is rA-moreau-1.
    explicit RigidScene(const ContactScene& setup);

    void step(double h) { of.step(h); }
    /// Sum of the mean contact forces of the last step on body b of the scene [N]
    lie::Vec3 load_on(int b) const;

    ModelScene of;

private:
    void add(const ContactScene::Interaction& interaction);

    std::vector<int> ground_body;  ///< of each element of Model::rigid_contacts(); -1 without a body at rest
};

}  // namespace hilda::studies
