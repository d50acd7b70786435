// SPDX-License-Identifier: GPL-3.0-or-later
/// What the user of the granular room holds: particles, boundaries, materials, and time.

#pragma once

#include "granular/boundary.hpp"
#include "granular/integrator.hpp"
#include "granular/pair_law.hpp"

#include <array>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hilda::granular {

/// Input that makes no sense. what() says where, what and the value.
class InvalidCase : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// A particle left the domain, was faster than a cell in a step, or has no finite velocity; the world stands where the
/// step began or in its middle, and is not to be stepped on.
class ParticleLost : public std::runtime_error {
public:
    ParticleLost(const std::string& what, std::uint32_t id, double t) : runtime_error(what), id(id), t(t) {}

    std::uint32_t id;
    double t;  ///< [s]
};

struct Particle {
    Vec3 r = {0, 0, 0};  ///< [m]
    double radius = 0;   ///< [m]
    int material = 0;
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};  ///< [m/s, rad/s]
    bool fixed = false;                     ///< keeps its place
    double mass = 0;                        ///< [kg]; 0: from its density
};

struct Contact {
    std::uint32_t i = 0, j = 0;  ///< ids; j a boundary's number where `boundary`
    bool boundary = false;
    Vec3 C = {0, 0, 0};  ///< point where F acts on i, at its radius [m]; on the boundary where it is one
    Vec3 n = {0, 0, 0};  ///< into i
    double delta = 0;    ///< overlap [m]
    Vec3 F = {0, 0, 0};  ///< on i [N]
    Vec3 T = {0, 0, 0};  ///< of rolling and spin on i [N m]
    Vec3 u = {0, 0, 0};  ///< tangential displacement [m]
};

struct Wrench {
    Vec3 F = {0, 0, 0}, T = {0, 0, 0};  ///< [N, N m], about Boundary::r
};

struct WorldOptions {
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< of the domain [m]
    std::array<bool, 3> periodic = {false, false, false};
    Vec3 gravity = {0, 0, -9.81};  ///< [m/s²]
    double h = 0;                  ///< step [s]
    double skin = 0.1;             ///< of the neighbour list, in diameters of the largest particle
    Scheme scheme = Scheme::symplectic_euler;
};

/// Particles on the CPU. All that a run depends on is in the arguments of its functions: the same calls give the same
/// bits, for any number of threads.
class World {
public:
    World(const WorldOptions& options, std::vector<Material> materials);
    World(World&&) = default;
    ~World();

    /// The law between two materials; for boundaries, of the materials that they are given
    void set_law(int material_i, int material_j, const PairLaw& law);
    int add(const Boundary& boundary);
    std::uint32_t add(const Particle& particle);  ///< its id
    void reserve(std::size_t particles);

    /// n steps. ParticleLost.
    void step(long n = 1);
    double t() const { return time; }
    long steps() const { return number; }

    std::vector<Particle> particles() const;  ///< by id, at t
    std::vector<Contact> contacts() const;    ///< by ids, at t
    Wrench wrench(int boundary) const;        ///< on it, at t
    Boundary& boundary(int number) { return boundaries[number]; }
    void set_velocity(std::uint32_t id, const Vec3& v, const Vec3& omega);
    void set_omega_locked(bool locked) { locked_turning = locked; }

    /// All that the next step depends on; `of_run` tells runs apart. The world looks for its neighbours anew before its
    /// next step, as one does that was loaded, so that both have the same bits from then on.
    std::string to_bytes(const std::string& of_run);
    /// Into a world made as that one was, by the same calls. FileError, naming the file.
    void from_bytes(const std::string& bytes, const std::string& of_run, const std::string& file);

    double kinetic_energy() const;  ///< [J]
    Vec3 momentum() const;          ///< [kg m/s]
    std::size_t count() const { return particle.count + waiting.size(); }
    std::size_t candidates() const { return pairs.count; }
    long rebuilds() const { return found; }
    /// Seconds that went into each part of the steps since the last call
    struct Times {
        double neighbours = 0, loads = 0, advance = 0;
    };
    Times take_times() { return std::exchange(times, {}); }
    std::size_t bytes() const;
    /// Looks for neighbours before the next step, as a world does that was loaded from a file
    void look_again() { moved = std::numeric_limits<double>::infinity(); }

    /// What an explicit step is measured by
    struct StepLimits {
        double rayleigh = std::numeric_limits<double>::infinity();  ///< least Rayleigh time of a particle [s]
        double collision = std::numeric_limits<double>::infinity();  ///< least time of a collision of two [s]
    };
    StepLimits step_limits() const;

private:
    static constexpr std::uint8_t no_law = 255;

    void settle_in();
    void set_grid(const std::vector<Particle>& all);
    void check_laws() const;
    void check_overlaps() const;
    void look_for_neighbours();
    LawView law_view() const;
    ParticleView particle_view() const;
    PairView pair_view() const;
    Advance advance_by(Part part);
    std::string name_of(std::uint32_t id) const;

    WorldOptions options;
    std::vector<Material> materials;
    std::vector<PairLaw> laws;
    std::vector<std::uint8_t> law_of;
    std::vector<Boundary> boundaries;
    std::vector<Particle> waiting;  ///< added since the last step

    Grid grid;
    float skin = 0;           ///< [m]
    float radius_of_all = 0;  ///< [m]; 0 where they differ
    Particles<par::Cpu> particle;
    Pairs<par::Cpu> pairs;
    Neighbours<par::Cpu> neighbours;
    par::Array<par::Cpu, Four> acc, turn;
    double time = 0, moved = std::numeric_limits<double>::infinity();
    long number = 0, found = 0;
    bool locked_turning = false;
    Times times;
};

}  // namespace hilda::granular
