// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of a model during the time integration.

#pragma once

#include "lie/trajectory.hpp"
#include "studies/running/contact_outputs.hpp"
#include "studies/running/frames/vtk.hpp"

#include <functional>

namespace hilda::studies {

/// Collects frames of a model: its bodies, joints, springs and contacts. A body is drawn by the surfaces of its
/// contacts, or by body_drawing() if it has no bounded surface. The model must outlive this object.
class ModelFrames final : public lie::Observer {
public:
    /// A frame at each output row of the grid
    ModelFrames(const dae::Model& model, const lie::TimeGrid& grid);
    ModelFrames(const dae::Model& model, EvenSelection selected);

    void accepted(const lie::State& x, long n, int iterations) override;

    Snapshots snapshots;

private:
    ModelFrames(const dae::Model& model, std::function<bool(long)> is_selected);

    const std::function<bool(long)> is_selected;  ///< true if node n is a frame
    const ContactOutputs contacts;                ///< numbered in this order in the frames
};

}  // namespace hilda::studies
