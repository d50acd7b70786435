// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of a model during the time integration.

#pragma once

#include "lie/trajectory.hpp"
#include "run/columns/contact_outputs.hpp"
#include "run/frames/vtk.hpp"

namespace hilda::run {

/// The drawing of a model: its bodies, joints, springs and contacts. A body is drawn by the surfaces of its
/// contacts, or by body_drawing() if it has no bounded surface. The model must outlive this object.
class ModelDrawing {
public:
    explicit ModelDrawing(const dae::Model& model);

    /// Adds what is drawn.
    void add_to(Drawing& drawing) const;
    Drawing::Frame frame(const lie::State& x) const;

private:
    const dae::Model& model;
    const ContactOutputs contacts;  ///< numbered in this order in the frames
};

/// Collects frames of a model. The model must outlive this object.
class ModelFrames final : public lie::Observer {
public:
    ModelFrames(const dae::Model& model, EvenSelection selected);

    void accepted(const lie::State& x, long n, int iterations) override;

    Snapshots snapshots;

private:
    EvenSelection selected;
    const ModelDrawing drawing;
};

}  // namespace hilda::run
