// SPDX-License-Identifier: GPL-3.0-or-later
/// Neighbour search: particles sorted by cell, and a Verlet list of the pairs whose surfaces are closer than
/// the skin.
///
/// The list is valid until a particle or a boundary has moved by half of the skin.

#pragma once

#include "granular/core/boundary_blocks.hpp"
#include "granular/core/contact_loop.hpp"

#include <type_traits>

namespace hilda::granular {

/// The particle arrays of a back end. A neighbour search sorts them by (replica, cell, id).
template <class Backend>
struct Particles {
    par::Array<Backend, Position> position;
    par::Array<Backend, Float4> velocity;  ///< v [m/s]; w: radius [m]
    par::Array<Backend, Float4> omega;     ///< ω [rad/s]; w: 1/m [1/kg], 0 for a fixed particle
    par::Array<Backend, Compensation> compensation;
    par::Array<Backend, Species> species;
    par::Array<Backend, std::uint32_t> id;
    par::Array<Backend, Float4> acc, alpha;  ///< of the previous step; empty if the scheme does not use them
    par::Array<Backend, Float4> orientation, orientation_compensation;  ///< (e0, e); empty unless stored
    par::Array<Backend, Position> position_at_build;  ///< positions at the last neighbour search
    /// 1 for a copy of a particle of another process, which advances it; empty if there are none. Two of them
    /// are no pair, nor is one with a boundary.
    par::Array<Backend, std::uint8_t> ghost;
    std::uint32_t count = 0;

    void resize(std::uint32_t n)
    {
        position.resize(n), velocity.resize(n), omega.resize(n), compensation.resize(n), species.resize(n);
        id.resize(n);
        count = n;
    }
    std::size_t bytes() const
    {
        return position.bytes() + velocity.bytes() + omega.bytes() + compensation.bytes() + species.bytes() +
               id.bytes() + acc.bytes() + alpha.bytes() + orientation.bytes() +
               orientation_compensation.bytes() + position_at_build.bytes() + ghost.bytes();
    }
};

/// The pair arrays of a back end; see PairView for their content.
///
/// Compressed sparse rows: the pairs with particle p as i are start[p] … start[p + 1] - 1. The pairs with p
/// as j are other[other_start[p]] … other[other_start[p + 1] - 1].
///
/// On the CPU `other` is empty, and `load` and `torque` are those of some pairs; see SweepPlan.
template <class Backend>
struct Pairs {
    static constexpr bool stores_all_loads = !std::is_same_v<Backend, par::Cpu>;

    par::Array<Backend, std::uint32_t> start, i, j, other_start, other;
    par::Array<Backend, std::uint8_t> law, in_contact;
    par::Array<Backend, std::uint8_t> image;  ///< empty unless Domain::has_images()
    par::Array<Backend, Float4> history, rotation_history, torque, internal;
    par::Array<Backend, Load> load;
    std::uint32_t count = 0;

    std::size_t bytes() const
    {
        return start.bytes() + i.bytes() + j.bytes() + other_start.bytes() + other.bytes() + law.bytes() +
               in_contact.bytes() + image.bytes() + history.bytes() + rotation_history.bytes() +
               torque.bytes() + internal.bytes() + load.bytes();
    }
};

/// Exception: a particle is outside the domain along an axis that is not periodic.
struct LeftDomain {
    std::uint32_t id;
};

/// Exception: the neighbour list has 2^31 pairs or more. The largest particle is too large for the number of
/// small ones, or the skin is too wide.
struct TooManyPairs {};

/// The cell grid of the domain and the settings of the neighbour search
struct Domain {
    CellGrid grid;
    float skin = 0;    ///< largest distance of the surfaces of a listed pair [m]
    float radius = 0;  ///< common radius of all particles [m]; 0 if they differ
    /// Radius up to which a particle is small [m]. Small particles in contact are in the same cell or in
    /// adjacent ones. A larger particle searches all cells within its reach.
    float small = 0;
    float largest = 0;           ///< radius of the largest particle [m]
    std::uint32_t replicas = 1;  ///< number of systems that share the domain and do not interact
    std::uint32_t unused = 0;    ///< explicit padding, because checkpoints store the bytes of a Domain

    /// Whether two particles can be closer than the skin through several periodic images along this axis: its
    /// period is shorter than three times the reach of the largest ones, or has less than three cells. A
    /// period is longer than the reach: a particle is never close to itself.
    bool is_short(int axis) const
    {
        const double length = grid.unit * grid.width[axis] * grid.cells[axis];
        return grid.periodic[axis] != 0 &&
               (grid.cells[axis] < 3 || length < (1 - 1e-6) * 3 * (2. * largest + skin));
    }
    /// Whether there is such an axis. The pairs of the list then have images of their own.
    bool has_images() const { return is_short(0) || is_short(1) || is_short(2); }
};

constexpr double max_cells = 0x7fffffff;  ///< of all replicas

template <class Backend>
ParticleView particle_view(const Domain& domain, const Particles<Backend>& p)
{
    return {.grid = domain.grid,
            .position = p.position.data(),
            .velocity = p.velocity.data(),
            .omega = p.omega.data(),
            .radius = domain.radius,
            .ghost = p.ghost.size() > 0 ? p.ghost.data() : nullptr};
}

/// Input of a neighbour search. Pointers refer to the memory of the back end.
struct SearchInput {
    Domain domain;
    /// Law of each pair of materials, materials × materials; nullptr if there is a single law
    const std::uint8_t* law_of = nullptr;
    std::uint32_t materials = 1;
    Surfaces surfaces;
    BoundaryBlockView near;                   ///< of these surfaces
    bool rotation_laws = false;               ///< whether a law of rolling or spin is in use
    bool internal = false;                    ///< whether a law has internal variables
    const std::uint32_t* clump_of = nullptr;  ///< see AssignCell
};

/// A contact of the previous list with its history; see PairView.
struct SavedContact {
    std::uint32_t i, j;
    float x, y, z, w;
};

template <class Backend>
class Neighbours {
public:
    /// Assigns the particles to cells, sorts them, builds the pair list, and transfers the contact histories
    /// of the previous list to it. Throws LeftDomain before the particles are sorted, and TooManyPairs; after
    /// TooManyPairs the histories are lost and the list must not be used.
    void find(const SearchInput& input, Particles<Backend>& particles, Pairs<Backend>& pairs);

    std::size_t bytes() const;
    /// A copy of the positions in memory that is not used between two searches
    Position* position_copy() { return reinterpret_cast<Position*>(scratch.data()); }
    /// Indices of the particles after the last search by those before it
    const std::uint32_t* new_indices() const { return new_index.data(); }

private:
    void sort(const SearchInput& input, Particles<Backend>& particles);
    /// Saves the contacts of the list. Returns their number.
    std::uint32_t save(const Pairs<Backend>& pairs, const ParticleView& particles, bool rotation,
                       bool internal, bool images);

    int shift = 0;  ///< see CellStarts
    par::Array<Backend, std::uint32_t> key, order, new_index, cell_start, counts;
    par::Array<Backend, Float4> scratch;
    par::Array<Backend, SavedContact> saved;  ///< of the previous list
    par::Array<Backend, Float4> saved_rotation, saved_internal;
    par::Array<Backend, Difference> saved_apart;     ///< with images: pair_difference()
    par::Array<Backend, std::uint32_t> saved_count;  ///< one number
};

extern template class Neighbours<par::Cpu>;

}  // namespace hilda::granular
