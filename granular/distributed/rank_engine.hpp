// SPDX-License-Identifier: GPL-3.0-or-later
/// The engine of one process of several. It has the particles in its part of the domain and copies (ghosts)
/// of those in the cells around it.
///
/// Each process evaluates all pairs with a particle of its own, in the order of cells and ids, which is that
/// of a single process. The sums of the loads and the contact histories have therefore the same bits. Two
/// processes evaluate a pair of their particles from the same numbers and have the same history of it.
///
/// All functions are called by all processes in the same order. Sums and maxima are those over all processes,
/// in the first one; the largest displacement and exceptions are those of all in each process.

#pragma once

#include "granular/backend/engine_impl.hpp"
#include "granular/distributed/partition.hpp"
#include "granular/distributed/plan.hpp"
#include "granular/distributed/records.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace hilda::granular {

class RankEngine final : public EngineOn<par::Cpu> {
public:
    explicit RankEngine(const Communicator& all) : all(all), partition(all) {}

    /// Distributes the arrays of the first process, which are nullptr in the others. A neighbour search has
    /// to follow; with `keeps_list` it is restore_list().
    void scatter(Arrays<par::Cpu>* whole, const Domain& domain, bool keeps_list);
    /// Collects the arrays in the first process, in the order of a single process; nullptr in the others
    void gather(Arrays<par::Cpu>* whole);

    /// Sorts the own particles into groups: by the cells of the last search, or by their ids, which are below
    /// `ids`, if that is positive. Returns the numbers of particles of all processes, in the first one.
    std::vector<std::uint64_t> sort_into_groups(std::uint32_t ids);
    /// Collects the particles of the groups first to last - 1, as long as the particles have not changed
    /// since sort_into_groups(): see Piece. Without `with_pairs` there are no pairs. Returns the number of
    /// particles of the piece, in the first process; `piece` is nullptr in the others.
    std::uint32_t gather_groups(Arrays<par::Cpu>* piece, std::size_t first, std::size_t last,
                                bool with_pairs);

    /// Also moves particles to the processes in whose part they are.
    void find_neighbours(const Domain& domain) override;
    /// Of all processes, in the first one
    std::vector<LeavingParticle> outside(const Domain& domain) override;
    /// A neighbour search has to follow before the next step.
    void remove(const std::vector<std::uint32_t>& ids) override;
    /// Builds the list for the positions of the last search.
    void restore_list(const Domain& domain);

    void find_loads(const Domain& domain, const LoadTimes& times, bool store, double path) override;
    float advance(const StepParameters& step) override;
    float largest_displacement() override;
    const std::vector<Wrench>& free_boundary_wrenches(const Domain& domain) override;
    const std::vector<Wrench>& last_wrenches() const { return wrenches; }
    float take_largest_overlap() override;
    ExternalSums external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                               const std::vector<BoundaryVelocity>& after) override;
    ParticleSums particle_sums(const Domain& domain, bool only_forces) override;
    ContactSums contact_sums(const Domain& domain, float h) override;
    KineticSums kinetic_sums(double s) override;
    std::size_t pair_count() override;
    bool is_finite() override;
    /// Of all processes
    double total_bytes() const;

private:
    bool is_ghost(std::uint32_t k) const { return own.particle.ghost.data()[k] != 0; }
    int owner_of(const CellGrid& g, std::uint32_t cell) const
    {
        return partition.owner(partition.grid().block_of(g.x_of(cell), g.y_of(cell), g.z_of(cell)));
    }
    template <class Cell>
    std::vector<BlockWork> loaded_blocks(const Particles<par::Cpu>& p, const CellGrid& g, const Cell& cell,
                                         std::int32_t& size) const;
    void assign_cells(const Domain& domain);
    void divide_again(const Domain& domain);
    void rebuild(const Domain& domain);
    struct Ghosts;
    Ghosts find_ghosts(const CellGrid& grid, const std::vector<std::uint32_t>& cells) const;
    void find_others_around(const CellGrid& grid, std::uint32_t cell, bool of_block,
                            std::vector<int>& others) const;
    void send_ghosts();
    template <class IsHere>
    std::uint32_t collect(Arrays<par::Cpu>* to, const std::vector<std::uint32_t>& which,
                          const IsHere& is_here);
    std::uint32_t collect_particles(Arrays<par::Cpu>* to, const std::vector<std::uint32_t>& which);
    std::size_t group_of(std::uint32_t k) const;

    const Communicator& all;
    Partition partition;
    UsedArrays used;
    CellGrid grid;  ///< of the last search
    std::uint64_t replicas = 1;
    // of sort_into_groups()
    bool groups_are_of_ids = false;
    std::uint64_t numbers_of_group = 1;  ///< cells or ids of a group
    std::vector<std::uint32_t> grouped;  ///< indices of the own particles
    std::vector<std::uint32_t> group_start;
    std::optional<Plan> ghost_plan;
    std::vector<std::uint32_t> sent;      ///< indices of the particles that are ghosts of others, in order
    std::vector<std::uint32_t> received;  ///< indices of the ghosts, in the order of the messages
    std::vector<GhostState> to_send, to_receive;
    std::vector<MPI_Request> requests;
    /// By block: whether all blocks around it and itself belong to this process; -1: not known
    mutable std::vector<signed char> surrounded;
    // of rebuild(), kept for their memory
    std::vector<std::uint32_t> stay, place, cells;
    std::vector<int> owner;
    par::Array<par::Cpu, std::uint32_t> keys, order;

    float largest_overlap = 0;  ///< of all processes since take_largest_overlap(), in the first one
    struct Work {
        double time = 0;  ///< CPU time [s]
        double work = 0;  ///< of particles and pairs, see particle_work
    };
    Work present;                   ///< of the steps since the last period
    Work past;                      ///< weighted sums over the periods before
    double work_of_step = 0;        ///< of the own particles and their pairs, at the last search
    long steps = 0;                 ///< since the last period
    long periods = 0;               ///< number of them
    double reported = 0;            ///< CPU time since the last measurement of the imbalance [s]
    long steps_reported = 0;        ///< since then
    long steps_since_division = 0;  ///< of the domain
};

}  // namespace hilda::granular
