// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of a model while it marches.

#pragma once

#include "contact/contact_force.hpp"
#include "contact/evolving_contact.hpp"
#include "lie/trajectory.hpp"
#include "studies/vtk.hpp"

namespace hilda::studies {

/// Of the bodies that have a surface, by one of the contacts. The model must outlive it.
class ModelFrames final : public lie::Observer {
public:
    /// A frame at each row of the grid
    ModelFrames(const dae::Model& model, const lie::Grid& grid);

    void accepted(const lie::State& x, long n, int iterations) override;
    bool has_contacts() const { return !contacts.empty() || !evolving.empty(); }

    Snapshots snapshots;

private:
    const dae::Model& model;
    const lie::Grid grid;
    std::vector<const contact::ContactForce*> contacts;
    std::vector<const contact::EvolvingContact*> evolving;  ///< counted after those
};

}  // namespace hilda::studies
