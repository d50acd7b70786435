// SPDX-License-Identifier: GPL-3.0-or-later
/// What the user of the granular room holds: particles, boundaries, materials, and time.

#pragma once

#include "granular/backend/engine.hpp"
#include "granular/core/boundary.hpp"
#include "granular/core/pair_law.hpp"

#include <array>
#include <functional>
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
    bool fixed = false;                     ///< keeps its place; turns on with omega
    double mass = 0;                        ///< [kg]; 0: from its density
    std::uint16_t replica = 0;              ///< meets those of the same replica alone
    /// Euler parameters e0, e1, e2, e3 from its frame to the global one, made of length 1; kept where WorldOptions say so
    std::array<double, 4> e = {1, 0, 0, 0};
};

struct ContactRecord {
    std::uint32_t i = 0, j = 0;  ///< ids; j a boundary's number where `boundary`
    bool boundary = false;
    Vec3 C = {0, 0, 0};  ///< point where F acts on i, at its radius [m]; on the boundary where it is one
    Vec3 n = {0, 0, 0};  ///< into i
    double delta = 0;    ///< overlap [m]
    Vec3 F = {0, 0, 0};  ///< on i [N]
    Vec3 T = {0, 0, 0};  ///< of rolling and spin on i [N m]
    Vec3 u = {0, 0, 0};  ///< tangential displacement [m]; of mindlin-incremental its elastic force [N]
    std::uint16_t replica = 0;
};

struct WorldOptions {
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< of the domain [m]
    std::array<bool, 3> periodic = {false, false, false};
    Vec3 gravity = {0, 0, -9.81};  ///< [m/s²]
    double h = 0;                  ///< step [s]
    double skin = 0.1;             ///< of the neighbour list, in diameters of the largest particle
    Scheme scheme = Scheme::symplectic_euler;
    bool orientation = false;  ///< of particles is kept: 32 bytes for each
    Device device = {};
};

/// Particles, on the CPU or a GPU. All that a run depends on is in the arguments of its functions: the same calls give the
/// same bits, for any number of threads.
///
/// Replicas are systems side by side: each has its particles, and all have the same boundaries.
class World {
public:
    /// InvalidCase; DeviceError
    World(const WorldOptions& options, std::vector<Material> materials);
    /// On an engine of the caller's
    World(const WorldOptions& options, std::vector<Material> materials, std::unique_ptr<Engine> engine);
    World(World&&) = default;
    ~World();

    /// The law between two materials; for boundaries, of the materials that they are given
    void set_law(int material_i, int material_j, const PairLaw& law);
    int add(const Boundary& boundary);
    /// Its id. One that is added to a running world must overlap nothing by more than 5 % of a radius, and begins with the
    /// acceleration of gravity.
    std::uint32_t add(const Particle& particle);

    /// n steps. InvalidCase for particles that cannot begin so, also with n = 0; ParticleLost; DeviceError.
    void step(long n = 1);
    double t() const { return time; }
    long steps() const { return number; }

    std::vector<Particle> particles() const;      ///< by id, at t
    std::vector<ContactRecord> contacts() const;  ///< by ids, at t
    /// On a boundary, at t; by the particles of one replica where that is given
    Wrench wrench(int boundary, int replica = -1) const { return wrench(contacts(), boundary, replica); }
    /// Out of contacts() that are at hand
    Wrench wrench(const std::vector<ContactRecord>& contacts, int boundary, int replica = -1) const;
    /// Sums over all contacts at t, in a sixth of the time that contacts() takes
    struct Totals {
        std::size_t contacts = 0;
        std::array<double, 9> stress = {};  ///< Love-Weber, over the domain [Pa]; see stress()
        std::vector<Wrench> on_boundary;    ///< by their numbers
    };
    Totals totals() const;

    /// What f does at the beginning of every step, at t(): it may set velocities of boundaries and forces, and add
    /// particles. Those that were told first are called first; none is told within f. They are no part of a checkpoint.
    void before_each_step(std::function<void(World&)> f);
    /// To be moved through its v and omega; one with a mass moves by what touches it.
    Boundary& boundary(int number) { return boundaries[number]; }
    void set_force(std::uint32_t id, const Vec3& F);  ///< from outside [N], until it is set anew
    void set_velocity(std::uint32_t id, const Vec3& v, const Vec3& omega);
    void set_omega_locked(bool locked) { locked_turning = locked; }

    /// All that the next step depends on; `of_run` tells runs apart. The world looks for its neighbours anew before its
    /// next step, as one does that was loaded, so that both have the same bits from then on.
    std::string to_bytes(const std::string& of_run);
    /// Into a world made as that one was, by the same calls. FileError, naming the file.
    void from_bytes(const std::string& bytes, const std::string& of_run, const std::string& file);

    double kinetic_energy() const;  ///< [J]
    /// Of the domain [m³]
    double volume() const
    {
        const Vec3 wide = options.high - options.low;
        return wide.x * wide.y * wide.z;
    }
    Vec3 momentum() const;  ///< [kg m/s]
    std::size_t count() const { return particles_in + pending.size(); }
    std::size_t candidates() const { return engine->arrays().pairs.count; }
    long rebuilds() const { return found; }
    /// Seconds that went into each part of the steps since the last call
    struct Times {
        double neighbours = 0, loads = 0, advance = 0;
    };
    Times take_times() { return std::exchange(times, {}); }
    /// A GPU is waited for between the parts, so that their times are their own; the whole is then slower.
    void set_timed(bool on) { timed = on; }
    double copy_rate() { return engine->copy_rate(); }  ///< of its memory [B/s], read and written
    std::size_t bytes() const { return engine->bytes(); }
    /// About what so many particles in a dense bed will take, with what it takes to make them
    static std::size_t bytes_needed(std::size_t particles, bool orientation = false);
    bool keeps_orientation() const { return options.orientation; }
    /// Looks for neighbours before the next step, as a world does that was loaded from a file
    void invalidate_neighbours() { moved = std::numeric_limits<double>::infinity(); }

    /// What an explicit step is measured by
    struct StepLimits {
        double rayleigh = std::numeric_limits<double>::infinity();  ///< least Rayleigh time of a particle [s]
        double collision = std::numeric_limits<double>::infinity();  ///< least time of a collision of two [s]
    };
    StepLimits step_limits() const;

private:
    static constexpr std::uint8_t no_law = 255;

    void insert_pending();
    Scene scene_of(const std::vector<Particle>& all) const;
    struct Placed {
        Position position;
        Vec<float> left;  ///< that whole units do not tell [units]
    };
    std::vector<Placed> places(const Scene& in, const std::vector<Particle>& all) const;
    void check_laws(const std::vector<Particle>& all) const;
    void check_overlaps(std::uint32_t first) const;
    struct LoadsNow;
    LoadsNow loads_now() const;
    ContactRecord contact(const LoadsNow& now, std::uint32_t pair) const;
    void keep_neighbours();
    void look_for_neighbours() const;
    void one_step();
    double move_boundaries();
    void push_tools();
    StepOf step_of(Part part) const;
    [[noreturn]] void lose(std::uint32_t k, const std::string& how) const;

    WorldOptions options;
    std::vector<Material> materials;
    std::vector<PairLaw> laws;
    std::vector<std::uint8_t> law_of;
    std::vector<Boundary> boundaries;
    std::vector<Four> forces;       ///< from outside, by id [N]
    std::vector<Particle> pending;  ///< added since the last step
    std::vector<std::function<void(World&)>> callbacks;

    std::unique_ptr<Engine> engine;
    Scene scene;
    std::size_t particles_in = 0;
    double time = 0;
    /// Bounds of the ways of particles and of boundaries since neighbours were looked for [m]. Which pairs are known is no
    /// part of what a world is.
    mutable double moved = std::numeric_limits<double>::infinity(), moved_boundaries = 0;
    mutable long found = 0;
    mutable bool laws_changed = true;
    mutable bool one_is_lost = false;  ///< out of the domain: the pairs of before are the last that there are
    float fastest = 0;                 ///< of the particles after the last step [m/s]
    long number = 0;
    bool locked_turning = false, forces_changed = false, timed = false;
    std::string refused;  ///< why this world cannot be stepped on
    Times times;
};

}  // namespace hilda::granular
