// SPDX-License-Identifier: GPL-3.0-or-later
/// The contacts of particles with triangles of meshes, on the CPU.
///
/// The neighbour list has a candidate for each triangle that may come into contact with a particle before the
/// next search. Few candidates need the search for the closest feature in each step. A candidate is
/// - in a face: the closest point is inside of the triangle; the distance is the height above its plane,
/// - asleep: it has no contact, because the triangle owns no local minimum of the distance or is too far
///   away,
/// - examined: the closest point is on or near an edge or a vertex; nearest() is called in each step.
///
/// A candidate remains in a face or asleep until the particle has moved by a margin, see distance_in_face()
/// and distance_to_ownership(). The states and the order of the candidates do not influence the results.

#pragma once

#include "granular/core/contact_loop.hpp"

#include <vector>

namespace hilda::granular {

class TriangleContacts {
public:
    /// The candidates after a neighbour search: `which` are the numbers of the pairs with triangles.
    void list(const PairView& pairs, const Surfaces& surfaces, const std::uint32_t* which,
              std::uint32_t count);
    /// Discards the states, after positions have been changed.
    void wake();

    /// Hands the histories over and computes the loads of the candidates, as HandOver and find_loads() do.
    /// `start`: of the rows; `path`: upper bound of the path of any particle relative to any boundary since
    /// list() or wake() [m].
    void find_loads(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                    const std::uint32_t* start, double path);

    std::size_t bytes() const;

    /// Chunk k has the candidates first[k] … end[k] - 1, all those of its particles. The first `faces[k]` of
    /// them are in a face. Packs read beyond the end, where no other thread writes.
    std::vector<std::uint32_t> first, end, faces;
    std::uint32_t longest = 0;  ///< number of candidates of the longest chunk

    // The candidates; arrays, because packs of consecutive ones are read
    std::vector<double> n_x, n_y, n_z, offset;  ///< plane of the face in front of the particle; see MeshPlane
    std::vector<float> awake_at;                ///< path at which the state is determined again [m]
    std::vector<std::uint8_t> in_face;
    std::vector<std::uint32_t> pair, particle, surface, boundary;
};

}  // namespace hilda::granular
