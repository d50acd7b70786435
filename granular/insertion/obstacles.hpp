// SPDX-License-Identifier: GPL-3.0-or-later
/// The particles and boundaries near a region, which an inserted particle must not overlap.

#pragma once

#include "granular/insertion/closed_meshes.hpp"

#include <unordered_map>

namespace hilda::granular {

class Obstacles {
public:
    /// The boundaries of the world, and its particles of a replica that may touch one of radius R within a
    /// box
    Obstacles(const World& world, const Vec3& low, const Vec3& high, double R, std::uint16_t replica);

    /// Whether a sphere of at most the radius R within the box overlaps a particle or a boundary by more than
    /// this part of the smaller radius; 0: whether it touches one. Also if its centre is on the wrong side
    /// of a closed mesh.
    bool touches(const Vec3& r, double radius, double allowed = 0) const;
    /// Adds a sphere of at most the radius R.
    void add(const Vec3& r, double radius);

private:
    struct Sphere {
        Vec3 r;
        double radius;
    };
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& c) const
        {
            std::uint64_t all = 0;
            for (const std::int64_t k : c) all = all * 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(k);
            return all ^ all >> 29;
        }
    };
    Cell cell_of(const Vec3& r) const;

    const World& world;
    Surfaces surfaces;
    ClosedMeshes closed;
    std::vector<std::uint32_t> near;  ///< numbers of the surfaces
    Vec3 low, high;                   ///< corners of the box
    double reach, edge = 0;           ///< R; of a cell, at least the largest diameter [m]
    std::unordered_map<Cell, std::vector<Sphere>, Hash> cells;
};

}  // namespace hilda::granular
