// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of a model during the time integration.

#pragma once

#include "lie/trajectory.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/vtk.hpp"

#include <functional>

namespace hilda::studies {

/// Collects frames of the surfaces and contact points of all contacts of a model. The model must outlive this
/// object.
class ModelFrames final : public lie::Observer {
public:
    /// A frame at each output row of the grid
    ModelFrames(const dae::Model& model, const lie::TimeGrid& grid);
    ModelFrames(const dae::Model& model, EvenSelection selected);

    void accepted(const lie::State& x, long n, int iterations) override;
    bool has_contacts() const { return !contacts.empty() || !evolving.empty(); }

    Snapshots snapshots;

private:
    ModelFrames(const dae::Model& model, std::function<bool(long)> is_selected);

    const dae::Model& model;
    const std::function<bool(long)> is_selected;  ///< true if node n is a frame
    std::vector<const contact::ContactForce*> contacts;
    std::vector<const contact::EvolvingContact*> evolving;  ///< numbered after `contacts` in the frames
    std::vector<ContactForceElements> force_elements;
};

}  // namespace hilda::studies
