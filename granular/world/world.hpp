// SPDX-License-Identifier: GPL-3.0-or-later
/// The discrete element simulation: spheres, boundaries, materials, contact laws and time.
///                                                                           Fang (2022), Chapter 6

#pragma once

#include "granular/backend/engine.hpp"
#include "granular/clumps/clump_template.hpp"
#include "granular/core/boundary.hpp"
#include "granular/core/pair_law.hpp"
#include "granular/world/watch.hpp"
#include "io/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hilda::io {
class Archive;
}

namespace hilda::granular {

inline bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// A checkpoint is of a world in which this boundary had other triangles.
class MeshChanged : public io::IoError {
public:
    /// `file`: the checkpoint; `name`: of the boundary in the message
    MeshChanged(const std::string& file, std::size_t boundary, const std::string& name)
        : io::IoError(file + ": the triangles of the mesh " + name +
                      " have changed since the checkpoint was written"),
          boundary(boundary)
    {}
    std::size_t boundary;
};

/// A particle has left the domain, has moved by more than a cell in one step, or has a velocity that is not
/// finite. Do not continue the run: the step may be computed in part only.
class ParticleLost : public io::NumericalFailure {
public:
    ParticleLost(const std::string& what, std::uint32_t id, double t)
        : NumericalFailure("particle_lost", what), id(id), t(t)
    {}

    std::uint32_t id;  ///< of the particle
    double t;          ///< [s]
};

/// The state of a world or a contact force is not finite. what() has the particle or contact, the time and
/// the value.
class NotFiniteState : public io::NumericalFailure {
public:
    explicit NotFiniteState(const std::string& what) : NumericalFailure("not_finite", what) {}
};

/// A sphere: its properties and its state
struct Particle {
    Vec3 r = {0, 0, 0};                     ///< centre, in the global frame [m]
    double radius = 0;                      ///< [m]
    int material = 0;                       ///< index into the materials of the world
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};  ///< in the global frame [m/s, rad/s]
    bool fixed = false;                     ///< the centre does not move; omega stays constant
    /// [kg]; 0: from radius and density; not used if fixed. World::particles() divides the mass of a clump
    /// among its spheres in proportion to their volumes.
    double mass = 0;
    std::uint16_t replica = 0;  ///< index of the replica it belongs to
    /// Euler parameters e0, e1, e2, e3 of the rotation from the body frame to the global frame; normalised on
    /// insertion. They are integrated only if WorldOptions::orientation is set.
    std::array<double, 4> e = {1, 0, 0, 0};
    std::uint32_t id = 0;  ///< set by World::particles(); World::add() assigns it
    /// Number of the boundary with which the particle moves rigidly from its insertion on; -1: none. The
    /// boundary has no mass. Such a particle is fixed: contacts do not accelerate it.
    int attached_to = -1;
    /// Id of the first particle of its clump, set by World::particles(); -1: none
    std::int64_t clump = -1;
};

/// A clump: its place and its motion
struct Clump {
    int shape = 0;       ///< number of its template
    Vec3 r = {0, 0, 0};  ///< centre of mass, in the global frame [m]
    std::array<double, 4> e = {1, 0, 0,
                               0};  ///< Euler parameters of the rotation from the frame of the template
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};  ///< in the global frame [m/s, rad/s]
    double scale = 1;                       ///< of the lengths of the template, at the same density
    std::uint16_t replica = 0;
    // set by World::clumps()
    std::uint32_t id = 0;  ///< of the first particle; the others have the next ids
    double mass = 0;       ///< [kg]
    Vec3 L = {0, 0, 0};    ///< angular momentum about the centre of mass [kg m²/s]
};

/// Index of the particle with this id in a list that is ordered by ids and contains it
inline std::size_t index_of(std::uint32_t id, const std::vector<Particle>& ordered)
{
    if (id < ordered.size() && ordered[id].id == id) return id;
    const auto at = std::lower_bound(ordered.begin(), ordered.end(), id,
                                     [](const Particle& p, std::uint32_t i) { return p.id < i; });
    return static_cast<std::size_t>(at - ordered.begin());
}

/// A particle that has left the domain and was removed. Its state is that of the neighbour search that found
/// it outside: it had left at most a few steps before. There is no padding, because checkpoints store the
/// bytes.
struct RemovedParticle {
    double t = 0;                                          ///< [s]
    Vec3 r = {0, 0, 0}, v = {0, 0, 0}, omega = {0, 0, 0};  ///< in the global frame [m, m/s, rad/s]
    double radius = 0, mass = 0;                           ///< [m, kg]; mass is 0 for a fixed particle
    std::uint32_t id = 0, side = 0;  ///< side: index into WorldOptions::outflow, or none for World::remove()
    static constexpr std::uint32_t none = 6;
};

/// A contact at t. Vectors are in the global frame.
struct ContactRecord {
    std::uint32_t i = 0, j = 0;  ///< ids; j is the number of a boundary if `boundary` is true
    bool boundary = false;
    /// Point of application of F [m]: on the surface of i, or on the boundary; within the overlap with
    /// Lever::contact
    Vec3 C = {0, 0, 0};
    Vec3 n = {0, 0, 0};  ///< unit normal, directed into i
    double delta = 0;    ///< overlap [m]
    Vec3 F = {0, 0, 0};  ///< force on i [N]
    Vec3 T = {0, 0, 0};  ///< rolling and spin torque on i [N m]
    /// Tangential displacement of i relative to j [m]; with mindlin-incremental the elastic force [N]
    Vec3 u = {0, 0, 0};
    std::uint16_t replica = 0;
};

/// Constant parameters of a world
struct WorldOptions {
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};                ///< lower and upper corner of the domain [m]
    std::array<bool, 3> periodic = {false, false, false};  ///< along x, y, z
    /// Sides -x, +x, -y, +y, -z, +z of the domain through which particles leave: they are removed and
    /// recorded in World::removed(). A side along a periodic axis has no effect.
    std::array<bool, 6> outflow = {};
    bool delete_lost = false;      ///< the same for all other sides; otherwise ParticleLost is thrown
    bool removable = false;        ///< World::remove() is used
    Vec3 gravity = {0, 0, -9.81};  ///< [m/s²]
    double h = 0;                  ///< step [s]
    double skin = 0.1;  ///< skin of the neighbour list, in median diameters of the particles, in (0, 1]
    /// Largest overlap of particles that are added, over the smaller radius, at most largest_overlap
    double start_overlap = 0.05;
    double largest_overlap = 0.5;  ///< over the smaller radius; the run ends above it
    Scheme scheme = Scheme::symplectic_euler;
    bool orientation = false;  ///< integrate the orientations of the particles, at 32 bytes per particle
    Device device = {};
};

/// Particles and boundaries with explicit time integration, on the CPU or on a GPU.
///
/// A run depends only on the arguments of the constructor and of the member functions. The same calls give
/// bitwise identical results for any number of threads and on every device.
///
/// Replicas are independent systems that share one domain and one set of boundaries. Particles of different
/// replicas do not interact.
class World {
public:
    /// Throws io::InvalidInput, and DeviceError if the device of the options is not available.
    World(const WorldOptions& options, std::vector<Material> materials);
    /// A world with an engine supplied by the caller
    World(const WorldOptions& options, std::vector<Material> materials, std::unique_ptr<Engine> engine);
    World(World&&) = default;
    ~World();

    /// Sets the contact law between two materials. A boundary has the law of its material. At most 255 laws
    /// can be set. Throws io::InvalidInput.
    void set_law(int material_i, int material_j, const PairLaw& law);
    const std::vector<PairLaw>& all_laws() const { return laws; }
    /// Replaces the parameters of all laws, which are those of all_laws() otherwise. The energy balance of
    /// the watch has to begin again: start_balance().
    void set_laws(const std::vector<PairLaw>& all);
    /// Sets the acceleration of gravity from the next step on. See set_laws() for the watch.
    void set_gravity(const Vec3& gravity) { options.gravity = gravity; }
    const Vec3& gravity() const { return options.gravity; }
    /// Begins the balances of the watch again: the run is changed from outside.
    void start_balance() { record.is_balanced = 0; }
    /// Adds a boundary and returns its number. Throws io::InvalidInput.
    int add(const Boundary& boundary);
    /// Adds a boundary with Shape::mesh. Its vertices are relative to Boundary::r in the frame of the mesh,
    /// whose orientation is Boundary::p. The particles are in front of the triangles: the normals point to
    /// them. With `two_sided` they may be on both sides. Throws io::InvalidInput.
    int add(const Boundary& boundary, const TriangleMesh& mesh, bool two_sided = false);
    /// Attaches a boundary rigidly to another one, its body, at their present places: it moves with the body,
    /// and its loads act on the body. The body may have a mass and any shape; it is not a part of another
    /// one. The part has no mass, and its velocities are those of the body. To be called before the first
    /// step. Throws io::InvalidInput.
    void set_part(int part, int body);
    /// Adds a particle and returns its id. Throws io::InvalidInput.
    ///
    /// Ids count from 0 in the order of the calls. The id of a removed particle is not used again.
    ///
    /// The particle is pending until the next call of step(), set_velocity() or to_bytes() inserts it. The
    /// insertion checks its position and its overlaps, which may be at most 5 % of the smaller radius. If
    /// it is inserted during a run, schemes that use the previous acceleration start it with that of
    /// gravity.
    std::uint32_t add(const Particle& particle) { return add(std::span(&particle, 1)); }
    /// The same for several particles, all or none, with consecutive ids
    std::uint32_t add(std::span<const Particle> particles);
    /// Adds a template of clumps and returns its number. Throws io::InvalidInput.
    int add_template(const ClumpTemplate& shape);
    /// Adds the particles of a clump, with consecutive ids, and returns the first one. They are pending like
    /// other particles. The clump moves as one rigid body. Throws io::InvalidInput.
    std::uint32_t add_clump(const Clump& clump);
    /// The clumps at t in the order of their ids, pending ones last
    std::vector<Clump> clumps() const;
    /// Centre of an inserted particle relative to the centre of mass of its clump, in the global frame [m];
    /// zero for a particle that is in no clump
    Vec3 offset_in_clump(std::uint32_t id) const;
    const std::vector<ClumpTemplate>& clump_templates() const { return templates; }
    /// Announces particles that are added during the run, at most this number, with the radii, materials and
    /// replicas of the samples. The cells are made for them, and step_limits(), the check of the laws and the
    /// memory that is reserved by the first insertion include them. Throws io::InvalidInput.
    void expect(const std::vector<Particle>& samples, std::size_t particles);
    /// The same for at most this number of clumps of a template with these scales. Throws io::InvalidInput.
    void expect_clumps(int shape, const std::vector<double>& scales, std::uint16_t replica,
                       std::size_t clumps);
    /// Reserves memory for further particles.
    void reserve(std::size_t particles) { pending.reserve(pending.size() + particles); }

    /// Inserts pending particles and computes n ≥ 0 steps. Throws io::InvalidInput if a pending particle
    /// cannot be inserted (with n = 0 as well), ParticleLost, DeviceError; OverlapTooLarge and EnergyCreated
    /// after a complete step, if the run is watched.
    void step(long n = 1);
    /// Whether the run is watched, with a sample every watch_limit::interval steps and, if `node_interval` is
    /// positive, in the last step before each multiple of it. A sample takes about the time of a step.
    /// The default is a watched run. The watch does not change the results.
    void set_watch(bool on, long node_interval = 0);
    /// What the watch has found so far
    const WatchRecord& watch() const { return record; }
    /// Throws NotFiniteState if a number of the state at t is not finite. Takes much less time than totals().
    void check_finite() const;
    /// Whether the state is that of t(). False after an exception in the middle of a step.
    bool is_complete() const { return !in_step; }
    double t() const { return time; }
    long steps() const { return step_count; }

    std::vector<Particle> particles() const;  ///< state at t, ordered by id, pending particles last
    /// Calls f for each particle, in the same order, without a list of all.
    void each_particle(const std::function<void(const Particle&)>& f) const;
    /// Contacts at t: those between particles, with i < j, then those with boundaries. Each group is
    /// ordered by i, then by j. Throws ParticleLost if the neighbour list has to be rebuilt and a particle
    /// is outside the domain.
    std::vector<ContactRecord> contacts() const;
    /// Resultant of the contact forces on a boundary, its parts and the particles attached to it at t, about
    /// Boundary::r [N, N m]. With `replica` ≥ 0
    /// only the contacts of that replica are included.
    Wrench wrench(int boundary, int replica = -1) const { return wrench(contacts(), boundary, replica); }
    /// The same, computed from the result of contacts()
    Wrench wrench(const std::vector<ContactRecord>& contacts, int boundary, int replica = -1) const;
    /// Sums over all contacts at t. totals() takes about a sixth of the time of contacts().
    struct Totals {
        std::size_t contacts = 0;
        /// Love-Weber stress over the volume of the domain, 3 × 3 by rows [Pa]; positive in compression. See
        /// stress() in output.hpp.
        std::array<double, 9> stress = {};
        /// Resultants of the contact forces on each boundary, its parts and the particles attached to it,
        /// about its Boundary::r [N, N m]
        std::vector<Wrench> on_boundary;
    };
    Totals totals() const;
    /// Throws NotFiniteState if the contact forces at t, of which these are the totals, are not finite.
    void check_loads(const Totals& totals) const;
    /// The same of one replica, and sums over its particles
    struct ReplicaTotals : Totals {
        std::size_t particles = 0;
        double kinetic_energy = 0;  ///< [J]
        Vec3 momentum = {0, 0, 0};  ///< [kg m/s]
    };
    /// Sums of the replicas 0, 1, ..., also of those without particles
    std::vector<ReplicaTotals> replica_totals() const;

    /// Registers a callback that is called at the beginning of each step, at t(). It may set velocities of
    /// boundaries and applied forces, and add particles. It must not register further callbacks. Callbacks
    /// are called in the order of registration. They are not part of a checkpoint.
    void before_each_step(std::function<void(World&)> f);
    Scheme scheme() const { return options.scheme; }
    double largest_overlap() const { return options.largest_overlap; }
    /// Access to a boundary, to prescribe v, omega, F and T. A boundary with a mass is accelerated by the
    /// contact loads along its free axes. The number is not checked.
    Boundary& boundary(int number) { return boundaries[number]; }
    const std::vector<Boundary>& all_boundaries() const { return boundaries; }
    /// Moves a boundary, which is not a part of another one, to another place between two steps: Boundary::r
    /// and Boundary::p, with which its axis turns. The histories of its contacts continue.
    void set_place(int number, const Vec3& r, const EulerParameters<double>& p);
    /// Contact loads on a boundary with a mass and its parts in the last step, about Boundary::r at the time
    /// of the loads: the beginning of the step, with velocity Verlet its end [N, N m]
    const Wrench& tool_load(int number) const { return tool_loads.at(static_cast<std::size_t>(number)); }
    const Meshes& all_meshes() const { return *meshes; }
    /// Names of the boundaries in messages about tools; without them they have their numbers.
    void set_boundary_names(std::vector<std::string> names) { boundary_names = std::move(names); }
    /// Lower and upper corner of the domain [m]
    const Vec3& low() const { return options.low; }
    const Vec3& high() const { return options.high; }
    const std::array<bool, 3>& periodic() const { return options.periodic; }
    /// Places of particles in the arrays; those of pending ones are not defined. Throws io::InvalidInput.
    std::vector<std::uint32_t> places_of(const std::vector<std::uint32_t>& ids, const char* where) const;
    /// Sets the applied forces on particles, in the global frame [N]. They stay constant until the next call.
    /// Throws io::InvalidInput before any is set.
    void set_forces(const std::vector<std::uint32_t>& ids, const std::vector<Vec3>& F);
    void set_force(std::uint32_t id, const Vec3& F) { set_forces({id}, {F}); }
    /// Sets the velocities of particles that are in no clump, in the global frame [m/s, rad/s]; an empty list
    /// of omega leaves the angular velocities. Throws io::InvalidInput before any is set.
    void set_velocities(const std::vector<std::uint32_t>& ids, const std::vector<Vec3>& v,
                        const std::vector<Vec3>& omega);
    void set_velocity(std::uint32_t id, const Vec3& v, const Vec3& w) { set_velocities({id}, {v}, {w}); }
    /// Sets the velocities of all particles of a replica to zero.
    void stop(std::uint16_t replica);
    /// If true, torques do not accelerate the rotation of particles.
    void set_omega_locked(bool locked) { rotation_locked = locked; }

    /// Serialises the state after the insertion of pending particles. from_bytes() accepts the result only
    /// with the same `run_id`. A restored world has the same neighbour list and continues with bitwise
    /// identical results; this world continues as if it had not been serialised. Throws io::InvalidInput if
    /// a pending particle cannot be inserted. `more` adds values to the archive.
    std::string to_bytes(
        const std::string& run_id, const std::function<void(io::Archive&)>& more = [](io::Archive&) {});
    /// The same in pieces of about 1 MiB. `more` is called twice.
    void write(
        const std::string& run_id, const std::function<void(std::string_view)>& append,
        const std::function<void(io::Archive&)>& more = [](io::Archive&) {});
    /// Restores the state into a world that was constructed by the same calls. `file` is the file name in
    /// messages; `more` reads the values that the `more` of to_bytes() has added. Throws io::IoError.
    void from_bytes(
        const std::string& bytes, const std::string& run_id, const std::string& file,
        const std::function<void(io::Archive&)>& more = [](io::Archive&) {});

    /// Sums over the particles at t
    struct Sums {
        double kinetic_energy = 0;     ///< translational and rotational [J]
        double rotational_energy = 0;  ///< the rotational part [J]
        /// In gravity along the axes that are not periodic, of the particles that are not fixed; 0 at the
        /// origin [J]
        double potential_energy = 0;
        Vec3 momentum = {0, 0, 0};  ///< linear [kg m/s]

        void add(const Particle& p, const Vec3& gravity) { add(p, p.omega, gravity); }
        /// The rotational energy is 1/5 m R² omega·w.
        void add(const Particle& p, const Vec3& w, const Vec3& gravity);
    };
    Sums sums() const;
    double kinetic_energy() const { return sums().kinetic_energy; }
    double volume() const;  ///< of the domain [m³]
    Vec3 momentum() const { return sums().momentum; }
    /// The particles that were removed since the last call of clear_removed(), ordered by time, then by id
    const std::vector<RemovedParticle>& removed() const { return removed_particles; }
    /// Removes and records the particles with these ids, which are in ascending order. A clump is removed as
    /// a whole if one of its particles is listed. Ids of particles that are not there have no effect.
    /// WorldOptions::removable must be set.
    void remove(const std::vector<std::uint32_t>& ids);
    void clear_removed() { removed_particles.clear(); }
    /// Number and mass of all removed particles [kg]
    struct Outflow {
        std::int64_t count = 0;
        double mass = 0;
    };
    const Outflow& outflow() const { return total_outflow; }
    /// Whether particles that leave the domain are removed, through one side at least
    bool removes() const
    {
        return options.delete_lost || options.removable ||
               std::find(options.outflow.begin(), options.outflow.end(), true) != options.outflow.end();
    }
    /// Number of particles, pending ones included
    std::size_t count() const { return inserted_count + pending.size(); }
    std::size_t candidates() const { return engine->pair_count(); }  ///< pairs in the neighbour list
    /// Number of times the neighbour list was built
    long rebuilds() const { return rebuild_count; }
    /// Wall time spent in the parts of the steps since the last call [s]
    struct Times {
        double neighbours = 0, loads = 0, advance = 0;
    };
    Times take_times() { return std::exchange(times, {}); }
    /// With `on`, the device is synchronised between the parts of a step. take_times() then attributes the
    /// time of a GPU correctly, but the steps take longer.
    void set_timed(bool on) { timed = on; }
    /// Memory bandwidth of a copy on the device, bytes read plus bytes written [B/s]
    double copy_rate() { return engine->copy_rate(); }
    /// Memory of all arrays on the device [bytes]
    std::size_t bytes() const { return engine->bytes(); }
    /// Estimate of the memory of all arrays on the device for a dense bed [bytes]
    static std::size_t bytes_needed(std::size_t particles, bool rotation_laws, bool orientation,
                                    Device::Kind device);
    bool has_orientation() const { return options.orientation; }
    /// Forces a rebuild of the neighbour list before the next step.
    void invalidate_neighbours() { particle_displacement = std::numeric_limits<double>::infinity(); }

    /// Time scales that limit the step of an explicit scheme. Infinite if no particle can move; the collision
    /// time is also infinite if there is no law.
    ///
    ///     rayleigh:   π R √(ρ/G) / (0.1631 ν + 0.8766)
    ///     collision:  the smaller of π √(m*/k_n) and π/γ_n for a law with constants k_n and γ_n
    ///                 2.87 (m*²/(R* E*² v))^(1/5) for the Hertz law    Johnson (1985), Sec. 11.4
    ///
    /// R, ρ, G, ν: radius, density, shear modulus and Poisson's ratio of a particle. The collision is that
    /// of two equal particles, m* = m/2 and R* = R/2. v is the largest speed of all particles, at least
    /// 0.1 m/s. Each law is applied to each particle, whatever its material.
    struct StepLimits {
        double rayleigh = std::numeric_limits<double>::infinity();   ///< smallest Rayleigh time [s]
        double collision = std::numeric_limits<double>::infinity();  ///< shortest duration of a collision [s]
    };
    /// `least_speed` replaces the 0.1 m/s.
    StepLimits step_limits(double least_speed = 0.1) const;
    /// Sums of the stiffness of the normal law over the contacts of each boundary and of its parts at t
    /// [N/m]
    void boundary_stiffness(std::vector<double>& to) const;
    /// The largest stiffness of one contact of a boundary, as if it were flat, with a particle of the world,
    /// if the overlap is this part of the radius of the particle [N/m]; 0 without particles
    double contact_stiffness(int boundary, double overlap) const;

private:
    static constexpr std::uint8_t no_law = 255;
    struct PlaceAtBuild;
    void transfer(io::Archive& a);
    void transfer_particles(io::Archive& a);
    void transfer_block(io::Archive& a, Particles<par::Cpu>& p, std::size_t n);
    void restore_neighbours(const std::string& file, std::vector<PlaceAtBuild> at_build);
    struct CellPosition {
        Position position;
        Vec<float> remainder;  ///< position minus its whole units [units]
    };
    Particle checked(const Particle& p, const std::string& where) const;
    bool fits(const std::vector<Particle>& all) const;
    void insert_pending();
    void insert(const std::vector<Particle>& all);
    void append_pending();
    void write_particle(std::uint32_t k, const Particle& particle, const CellPosition& at);
    void end_insertion(const std::vector<Particle>& all);
    Particle particle_at(const Particles<par::Cpu>& in, std::uint32_t k) const;
    Domain domain_of(const std::vector<Particle>& all) const;
    bool set_cells(CellGrid& grid, double edge, std::uint32_t replicas) const;
    [[noreturn]] void refuse_domain(double edge, std::uint32_t replicas) const;
    std::vector<CellPosition> cell_positions(const Domain& in, const std::vector<Particle>& all,
                                             std::size_t first_new) const;
    void check_laws(const std::vector<Particle>& added) const;
    void check_overlaps(std::uint32_t first) const;
    struct CurrentLoads;
    struct ExactTotals;
    template <class F>
    void for_current_loads(const Arrays<par::Cpu>& of, const F& f) const;
    void update_for_query() const;
    ContactRecord contact(const CurrentLoads& now, std::uint32_t pair) const;
    template <class To>
    void add_totals(const To& to) const;
    void update_neighbours();
    void find_neighbours() const;
    void rebuild_neighbours();
    void remove_outside();
    void record_removal(const LeavingParticle& p, std::uint32_t side);
    void remove_recorded(std::size_t first);
    // clumps; see world_clumps.cpp
    std::uint32_t clump_of(std::uint32_t id) const
    {
        return id < clump_tables.of.size() ? clump_tables.of[id] : no_clump;
    }
    double fraction_of(std::uint32_t id, std::uint32_t clump) const;
    struct ClumpState {
        Particle body;  ///< with the mass of the clump, and R of ClumpBody
        Vec3 w;         ///< see clump.hpp [rad/s]
    };
    ClumpState clump_state(std::uint32_t number) const;
    ClumpState clump_state(const Clump& pending) const;
    double reach_of_clumps() const;
    void check_size(int shape, double scale, const std::string& where) const;
    void insert_clumps(const std::vector<Particle>& moved);
    std::vector<Particle> clump_places() const;
    void update_clump_tables();
    void send_clumps() const;
    void transfer_clumps(io::Archive& a);
    void check_clumps() const;
    [[noreturn]] void throw_turns_too_far() const;
    void attach(const Particle& p);
    int boundary_of(std::uint32_t id) const;
    void rotate_frames();
    void set_attached();
    void move_attached();
    bool is_posed() const;
    template <class To>
    void add_wrench(To& to, const ContactRecord& c) const;
    [[noreturn]] void throw_left(std::uint32_t id) const;
    void one_step();
    double move_boundaries();
    double rotating_reach(std::size_t boundary) const;
    struct BodyPart;
    void place(const BodyPart& part);
    void place_parts();
    bool has_parts(std::size_t boundary) const { return boundary < is_body.size() && is_body[boundary]; }
    void add_part_loads(std::vector<Wrench>& loads) const;
    void set_velocities_of_move(std::vector<BoundaryVelocity>& to) const;
    void find_tool_loads();
    void accelerate_tools(double part);
    Vec3 mean_omega_of(std::size_t boundary) const;
    StepParameters step_parameters(Part part) const;
    bool laws_have_energy() const;
    bool boundaries_move();
    int add_boundary(const Boundary& boundary);
    void send_boundaries() const;
    Surfaces surfaces() const { return {boundaries.data(), meshes->view()}; }
    bool is_sample() const;
    void watch_loads();
    void watch_advance();
    double gain_tolerance() const;
    void check_watch();
    void check_tools();
    [[noreturn]] void throw_overlap() const;
    void check_particles(const Piece& piece) const;
    void check_histories(const Arrays<par::Cpu>& of) const;
    [[noreturn]] void throw_lost(std::uint32_t k, const std::string& how) const;

    WorldOptions options;
    std::vector<Material> materials;
    std::vector<PairLaw> laws;
    std::vector<std::uint8_t> law_of;  ///< index into laws, or no_law: materials × materials
    std::vector<Boundary> boundaries;
    std::shared_ptr<Meshes> meshes = std::make_shared<Meshes>();  ///< of the boundaries with Shape::mesh
    std::vector<Wrench> tool_loads;  ///< contact loads on the boundaries with a mass, at t_n
    /// A boundary that moves with another one, and its place in the body frame of that one; see set_part()
    struct BodyPart {
        std::uint32_t number, body;
        Vec3 X, axis;               ///< Boundary::r relative to that of the body [m], Boundary::axis
        EulerParameters<double> p;  ///< rotation from the frame of the part to that of the body
    };
    std::vector<BodyPart> parts;
    std::vector<bool> is_body;  ///< whether a boundary has parts; empty if none has
    std::vector<std::string> boundary_names;
    std::vector<Float4> forces;     ///< applied forces, by id [N]; empty if none is set
    std::vector<Particle> pending;  ///< particles added since the last insertion
    std::vector<ClumpTemplate> templates;
    std::vector<EulerParameters<double>> clump_axes;  ///< of the templates, see PrincipalInertia
    std::vector<double> clump_R;                      ///< of the templates, see ClumpBody::velocity [m]
    std::vector<Clump> pending_clumps;                ///< of the pending particles
    ClumpTables clump_tables;
    mutable bool clumps_changed = false;
    struct Expected {
        std::vector<Particle> samples;
        std::size_t particles;
        double reach = 0;  ///< of clumps, see reach_of_clumps() [m]
    };
    std::vector<Expected> expected;  ///< see expect()
    std::size_t reserved = 0;        ///< number of particles for which the first insertion reserves memory
    std::vector<std::function<void(World&)>> callbacks;

    std::unique_ptr<Engine> engine;
    Domain domain;
    bool has_domain = false;  ///< whether the cells have been made
    std::size_t inserted_count = 0;
    std::uint32_t next_id = 0;  ///< of the next particle that is inserted
    std::vector<RemovedParticle> removed_particles;
    std::vector<AttachedParticle> attached;          ///< ordered by id
    std::vector<EulerParameters<double>> rotations;  ///< of the boundaries; empty if no particle is attached
    std::vector<BoundaryPose> poses, posed;          ///< posed: of the last move_attached()
    std::vector<double> reach;  ///< largest |X| of the attached particles, by boundary [m]; 0: there are none
    bool attached_changed = false;
    Outflow total_outflow;
    double time = 0;
    /// Upper bounds of the displacements of particles and of boundaries since the neighbour list was built
    /// [m]; infinite if the list must be rebuilt. The list is a cache, therefore these members are mutable.
    mutable double particle_displacement = std::numeric_limits<double>::infinity(), boundary_displacement = 0;
    /// Upper bound of the path of any particle relative to any boundary since the list was built [m]
    mutable double path = 0;
    struct BoundaryPlace {
        Vec3 r, axis;
        EulerParameters<double> p;
        explicit BoundaryPlace(const Boundary& b = {}) : r(b.r), axis(b.axis), p(b.p) {}
        bool operator==(const BoundaryPlace& o) const
        {
            return r == o.r && axis == o.axis && p.e0 == o.p.e0 && p.e == o.p.e;
        }
    };
    mutable std::vector<BoundaryPlace> boundaries_at_build;  ///< places when the neighbour list was built
    mutable long rebuild_count = 0;
    mutable bool laws_changed = true, meshes_changed = false;
    mutable bool particle_lost = false;  ///< a particle is outside the domain, so the list cannot be rebuilt
    float max_speed = 0;                 ///< largest speed of the particles after the last step [m/s]
    long step_count = 0;
    bool in_step = false;  ///< the arrays are between those of two instants
    bool rotation_locked = false, forces_changed = false, timed = false;

    bool watched = true, sampling = false;  ///< sampling: the present step is a sample of the watch
    long node_interval = 0;
    double next_work = 0;  ///< work from t_n on in the present step [J]
    /// Largest overlap before a checkpoint that no sample has included yet; only of a GPU
    float unsampled_overlap = 0;
    WatchRecord record;
    /// Of the boundaries: velocities of the last move and place after it; velocities of the next move
    std::vector<BoundaryVelocity> moved, next_move;
    std::vector<BoundaryPlace> moved_to;
    /// Whether no boundary moved in the last step, and whether one was changed since then
    bool boundaries_rest = false;
    mutable bool boundaries_changed = true;

    std::string insertion_error;  ///< message of a failed overlap check; further steps throw it again
    Times times;
};

}  // namespace hilda::granular
