// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of a model while it marches.

#pragma once

#include "lie/trajectory.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/vtk.hpp"

#include <functional>

namespace hilda::studies {

/// Of the bodies that have a surface, by one of the contacts. The model must outlive it.
class ModelFrames final : public lie::Observer {
public:
    /// A frame at each row of the grid
    ModelFrames(const dae::Model& model, const lie::TimeGrid& grid);
    ModelFrames(const dae::Model& model, EvenChoice selected);

    void accepted(const lie::State& x, long n, int iterations) override;
    bool has_contacts() const { return !contacts.empty() || !evolving.empty(); }

    Snapshots snapshots;

private:
    ModelFrames(const dae::Model& model, std::function<bool(long)> takes);

    const dae::Model& model;
    const std::function<bool(long)> takes;  ///< node n
    std::vector<const contact::ContactForce*> contacts;
    std::vector<const contact::EvolvingContact*> evolving;  ///< counted after those
    std::vector<ContactForces> beside;
};

}  // namespace hilda::studies
