// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/model_frames.hpp"

namespace hilda::studies {

ModelFrames::ModelFrames(const dae::Model& model, const lie::Grid& grid) : grid(grid)
{
    for (const auto& force : model.forces())
        if (const auto* c = dynamic_cast<const contact::ContactForce*>(force.get())) {
            contacts.push_back(c);
            snapshots.show(c->i, c->contact.i);
            snapshots.show(c->j, c->contact.j);
        }
}

void ModelFrames::accepted(const lie::State& x, long n, int)
{
    if (!grid.is_row(n)) return;
    std::vector<Snapshots::Touch> touches;
    for (size_t k = 0; k < contacts.size(); ++k) {
        const contact::ContactForce& c = *contacts[k];
        const contact::ContactForce::Instant now = c.at(x);
        if (now.meeting.N > 0)
            touches.push_back(
                Snapshots::touch(static_cast<int>(k), c.i, now.meeting, c.friction(x), now.memory.history));
    }
    snapshots.add(x.t, x.body, std::move(touches));
}

}  // namespace hilda::studies
