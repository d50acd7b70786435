// SPDX-License-Identifier: GPL-3.0-or-later
/// Which pairs may touch: particles sorted by cell, and a list that holds until something has moved half the skin.

#pragma once

#include "granular/core/contact_loop.hpp"

namespace hilda::granular {

/// Particles of a back end, in the order of their cells
template <class Backend>
struct Particles {
    par::Array<Backend, Position> position;
    par::Array<Backend, Four> velocity;  ///< [m/s], radius [m]
    par::Array<Backend, Four> omega;     ///< [rad/s], 1/m [1/kg]: 0 for what is fixed
    par::Array<Backend, Compensation> rest;
    par::Array<Backend, Species> kind;
    par::Array<Backend, std::uint32_t> id;
    par::Array<Backend, Four> acc, turn;  ///< of the step before; none where the scheme asks for none
    par::Array<Backend, Four> orientation, orientation_rest;  ///< e0, e; none where it is not kept
    par::Array<Backend, Position> before;                     ///< where neighbours were last looked for
    std::uint32_t count = 0;

    void resize(std::uint32_t n)
    {
        position.resize(n), velocity.resize(n), omega.resize(n), rest.resize(n), kind.resize(n);
        id.resize(n);
        count = n;
    }
    std::size_t bytes() const
    {
        return position.bytes() + velocity.bytes() + omega.bytes() + rest.bytes() + kind.bytes() +
               id.bytes() + acc.bytes() + turn.bytes() + orientation.bytes() + orientation_rest.bytes() +
               before.bytes();
    }
};

/// Pairs by rows: those of particle p are start[p] … start[p + 1] - 1, with p as i, and in `other` those with p as j
template <class Backend>
struct Pairs {
    par::Array<Backend, std::uint32_t> start, i, j, other_start, other;
    par::Array<Backend, std::uint8_t> law, touches;
    par::Array<Backend, Four> history, turning, torque;
    par::Array<Backend, Load> load;
    std::uint32_t count = 0;

    std::size_t bytes() const
    {
        return start.bytes() + i.bytes() + j.bytes() + other_start.bytes() + other.bytes() + law.bytes() +
               touches.bytes() + history.bytes() + turning.bytes() + torque.bytes() + load.bytes();
    }
};

/// A particle is outside a domain that is not periodic there.
struct LeftDomain {
    std::uint32_t id;
};

/// More than 2^31 pairs: the largest particle is too large for so many small ones, or the skin too wide.
struct TooManyPairs {};

/// Where particles are and how far neighbours are looked for
struct Scene {
    CellGrid grid;
    float skin = 0;              ///< [m]
    float radius = 0;            ///< of all [m]; 0 where they differ
    std::uint32_t replicas = 1;  ///< systems in the same place that do not see each other
    std::uint32_t unused = 0;    ///< no byte of a scene is left to chance: it is written as it is
};

template <class Backend>
ParticleView particle_view(const Scene& scene, const Particles<Backend>& p)
{
    return {scene.grid, p.position.data(), p.velocity.data(), p.omega.data(), scene.radius};
}

/// What decides which pairs there are
struct Reach {
    Scene scene;
    const std::uint8_t* law_of = nullptr;  ///< materials × materials
    std::uint32_t materials = 1;
    const Boundary* boundary = nullptr;
    std::uint32_t boundaries = 0;
    bool turning = false;  ///< whether a law keeps a history of turning
};

template <class Backend>
class Neighbours {
public:
    /// Puts particles into the cells where they are, sorts them, finds pairs and gives them the histories of the pairs of
    /// before. Throws LeftDomain, with the particles where they were, and TooManyPairs.
    void find(const Reach& reach, Particles<Backend>& particles, Pairs<Backend>& pairs);

    std::size_t bytes() const;

private:
    void sort(const Reach& reach, Particles<Backend>& particles);

    par::Array<Backend, std::uint64_t> key;
    par::Array<Backend, std::uint32_t> order, where, cell_start, counts;
    par::Array<Backend, Four> scratch;
};

extern template class Neighbours<par::Cpu>;

}  // namespace hilda::granular
