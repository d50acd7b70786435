// SPDX-License-Identifier: GPL-3.0-or-later
/// The engine of a world: its arrays and the loops over them, on the CPU or on a GPU.

#pragma once

#include "granular/backend/finite_state.hpp"
#include "granular/core/attached.hpp"
#include "granular/core/clump.hpp"
#include "granular/core/integrator.hpp"
#include "granular/core/neighbours/neighbours.hpp"
#include "granular/core/removal.hpp"
#include "granular/core/watch.hpp"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace hilda::granular {

/// The device does not exist, cannot be used, or has failed; what() gives the reason.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Engine;
/// Makes engines of the CPU that are not those of this process alone
class EngineSource {
public:
    virtual ~EngineSource() = default;
    virtual std::unique_ptr<Engine> make() = 0;
};

/// A device: the CPU, or the GPU with the given number
struct Device {
    enum Kind { cpu, cuda } kind = cpu;
    int number = 0;
    EngineSource* source = nullptr;  ///< of the engine; nullptr: the one of this process
};

/// All arrays of a world in the memory of a back end
template <class Backend>
struct Arrays {
    Particles<Backend> particle;
    Pairs<Backend> pairs;
    par::Array<Backend, ClumpBody> clump;  ///< ordered by the ids of their members
};

/// Particles that are consecutive in the order of the arrays, and their rows of the neighbour list
struct Piece {
    /// The particles of the piece, then copies of the other particles in their pairs
    Arrays<par::Cpu>& arrays;
    std::uint32_t particles;  ///< number without the copies
};

/// Force and torque on a boundary
struct Wrench {
    Vec3 F = {0, 0, 0}, T = {0, 0, 0};  ///< [N], [N m] about Boundary::r
};

/// The operations of a step; each is a loop over all particles or pairs. All devices execute the same
/// functors and give bitwise equal results.
class Engine {
public:
    virtual ~Engine() = default;

    /// The current arrays in host memory; a GPU engine copies them. A change becomes effective with
    /// arrays_modified().
    virtual Arrays<par::Cpu>& arrays() = 0;
    /// Transfers the arrays to the device after the caller has modified arrays().
    virtual void arrays_modified() = 0;
    /// Calls f for all particles in pieces, which it must not change: the particles of several processes need
    /// not fit into the memory of the first one. The order is that of arrays(); without `with_pairs` it is
    /// any one, and there need not be any pairs.
    virtual void each_piece(bool /*with_pairs*/, const std::function<void(const Piece&)>& f)
    {
        Arrays<par::Cpu>& all = arrays();
        f({all, all.particle.count});
    }
    /// The same without pairs, in pieces whose ids are larger than those of the pieces before. `ids`: larger
    /// than all ids
    virtual void each_piece_by_id(std::uint32_t /*ids*/,
                                  const std::function<void(const Particles<par::Cpu>&)>& f)
    {
        f(arrays().particle);
    }
    /// Number of pairs in the neighbour list
    virtual std::size_t pair_count() { return arrays().pairs.count; }
    /// See granular::is_finite.
    virtual bool is_finite()
    {
        Arrays<par::Cpu>& all = arrays();
        return granular::is_finite(all.particle, all.pairs, [](std::uint32_t) { return true; });
    }
    /// Called before the other operations of a step: distributes arrays that were modified, if there are
    /// several processes.
    virtual void prepare(const Domain&) {}

    /// law_of: index of the law of a pair of materials, materials × materials
    virtual void set_laws(const std::vector<PairLaw>& laws, const std::vector<std::uint8_t>& law_of,
                          std::uint32_t materials) = 0;
    /// The triangles of the boundaries with Shape::mesh, which the engine shares with the caller
    virtual void set_meshes(std::shared_ptr<const Meshes> meshes) = 0;
    /// Returns whether they differ from those of the previous call.
    virtual bool set_boundaries(const std::vector<Boundary>& boundaries) = 0;
    /// External forces by particle id [N]; an empty list means none.
    virtual void set_forces(const std::vector<Float4>& forces) = 0;

    /// The particles that are attached to boundaries; effective from the next call of move_attached() on
    virtual void set_attached(const std::vector<AttachedParticle>& attached) = 0;
    /// See MoveAttached; `poses` by boundary number
    virtual void move_attached(const Domain& domain, const std::vector<BoundaryPose>& poses) = 0;

    /// The shapes of the clumps in arrays(), and the clumps of the particles
    virtual void set_clumps(const Domain& domain, const ClumpTables& tables) = 0;

    /// See Neighbours::find. Throws LeftDomain for a clump whose centre of mass is outside the domain.
    virtual void find_neighbours(const Domain& domain) = 0;
    /// The particles outside the domain, ordered by id
    virtual std::vector<LeavingParticle> outside(const Domain& domain)
    {
        return particles_outside(arrays().particle, domain.grid);
    }
    /// See remove_particles.
    virtual void remove(const std::vector<std::uint32_t>& ids)
    {
        Arrays<par::Cpu>& a = arrays();
        remove_particles(a.particle, a.pairs, ids);
        arrays_modified();
    }
    /// See find_loads. Without `store`, the CPU computes only the loads of the pairs of SweepPlan::list here,
    /// which contain those on boundaries, and with a watch those on fixed particles; it computes the other
    /// ones in advance(). `path`: upper bound of the path of any particle relative to any boundary since
    /// find_neighbours() [m].
    virtual void find_loads(const Domain& domain, const LoadTimes& times, bool store, double path) = 0;
    /// See advance.
    virtual float advance(const StepParameters& step) = 0;
    /// Largest displacement of a particle since the last neighbour search [units]
    virtual float largest_displacement() = 0;
    /// Sums of the current contact loads on boundaries with a mass, by boundary number; zero for the others
    virtual const std::vector<Wrench>& free_boundary_wrenches(const Domain& domain) = 0;

    // The watch over a run. The sums do not depend on the number of threads; see watch.hpp.

    /// Whether the memory for the sums is available after the next neighbour search, and overlaps are
    /// compared.
    virtual void set_watched(bool on) = 0;
    /// Largest overlap over the smaller radius in all find_loads since the last call
    virtual float take_largest_overlap() = 0;
    /// Loads of boundaries and fixed particles, after find_loads. `before` and `after` are the velocities of
    /// the boundaries in the previous and in the next move; empty if no boundary moves.
    virtual ExternalSums external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                                       const std::vector<BoundaryVelocity>& after) = 0;
    /// Sums over the particles. Copies the positions for contact_sums() and the velocities for
    /// kinetic_sums(), unless only the applied forces are summed.
    virtual ParticleSums particle_sums(const Domain& domain, bool only_forces) = 0;
    /// Sums over the contacts at the positions of particle_sums(), with the histories of find_loads();
    /// after particle_sums() and advance().
    virtual ContactSums contact_sums(const Domain& domain, float h) = 0;
    /// See AddKinetic; after particle_sums() and advance().
    virtual KineticSums kinetic_sums(double s) = 0;

    /// Waits until the device has finished all work, for time measurements.
    virtual void wait() = 0;
    /// Bandwidth of a copy within the memory of the device [B/s], reads and writes added
    virtual double copy_rate() = 0;

    /// Memory of all arrays [B]
    virtual std::size_t bytes() const = 0;
};

/// Throws DeviceError if the device does not exist or the program is built without CUDA. A process uses one
/// GPU, from one thread.
std::unique_ptr<Engine> make_engine(Device device);
std::unique_ptr<Engine> make_gpu_engine(int number);
/// Names of the available GPUs. If there are none the result is empty and `why_not` is the reason.
std::vector<std::string> gpus(std::string& why_not);
/// Free memory of a GPU [B]. Throws DeviceError.
std::size_t gpu_memory(int number);

}  // namespace hilda::granular
