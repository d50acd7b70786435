// SPDX-License-Identifier: GPL-3.0-or-later
/// What processes send each other about particles and contacts.

#pragma once

#include "granular/backend/engine.hpp"

#include <cstring>
#include <type_traits>

namespace hilda::granular {

/// All of a particle; see Particles
struct ParticleRecord {
    Position position = {}, position_at_build = {};
    Float4 velocity = {}, omega = {};
    Compensation compensation = {};
    Float4 acc = {}, alpha = {}, orientation = {}, orientation_compensation = {};
    Species species = {};
    std::uint32_t id = 0;
};

/// What a process needs of a particle of another one, when the neighbour list is built
struct GhostRecord {
    Position position;
    Float4 velocity, omega;
    Species species;
    std::uint32_t id;
};

/// What changes of it in a step
struct GhostState {
    std::int32_t x, y, z;
    float v[3], omega[3];
};

/// A contact with its history: ids of the particles; j of a surface has PairView::boundary_bit
struct ContactHistory {
    std::uint32_t i, j;
    Float4 history, rotation, internal;
};

/// The value k of an array that may be empty
template <class T>
T value_of(const par::Array<par::Cpu, T>& array, std::uint32_t k)
{
    return k < array.size() ? array.data()[k] : T{};
}

inline ParticleRecord record_of(const Particles<par::Cpu>& p, std::uint32_t k)
{
    return {.position = p.position.data()[k],
            .position_at_build = value_of(p.position_at_build, k),
            .velocity = p.velocity.data()[k],
            .omega = p.omega.data()[k],
            .compensation = p.compensation.data()[k],
            .acc = value_of(p.acc, k),
            .alpha = value_of(p.alpha, k),
            .orientation = value_of(p.orientation, k),
            .orientation_compensation = value_of(p.orientation_compensation, k),
            .species = p.species.data()[k],
            .id = p.id.data()[k]};
}

/// Whether the arrays have the values that only some runs use
struct UsedArrays {
    bool acceleration = false, orientation = false;
};

inline void resize(Particles<par::Cpu>& p, std::uint32_t n, const UsedArrays& used)
{
    p.resize(n);
    p.position_at_build.resize(n);
    p.acc.resize(used.acceleration ? n : 0), p.alpha.resize(used.acceleration ? n : 0);
    p.orientation.resize(used.orientation ? n : 0);
    p.orientation_compensation.resize(used.orientation ? n : 0);
}

inline void set_record(Particles<par::Cpu>& p, std::uint32_t k, const ParticleRecord& r)
{
    p.position.data()[k] = r.position, p.position_at_build.data()[k] = r.position_at_build;
    p.velocity.data()[k] = r.velocity, p.omega.data()[k] = r.omega;
    p.compensation.data()[k] = r.compensation;
    if (p.acc.size() > 0) p.acc.data()[k] = r.acc, p.alpha.data()[k] = r.alpha;
    if (p.orientation.size() > 0)
        p.orientation.data()[k] = r.orientation,
        p.orientation_compensation.data()[k] = r.orientation_compensation;
    p.species.data()[k] = r.species, p.id.data()[k] = r.id;
}

}  // namespace hilda::granular
