// SPDX-License-Identifier: GPL-3.0-or-later
/// The calls of an engine that the first process makes in all processes.

#pragma once

#include "granular/distributed/packed_lists.hpp"
#include "granular/distributed/rank_engine.hpp"

#include <map>
#include <memory>
#include <type_traits>

namespace hilda::granular {

/// A function of RankEngine, or one of the last three for the processes
enum class Call : std::int32_t {
    set_laws,
    set_meshes,
    set_boundaries,
    set_forces,
    set_attached,
    move_attached,
    set_watched,
    scatter,
    gather,
    sort_into_groups,
    gather_groups,
    pair_count,
    is_finite,
    find_neighbours,
    outside,
    remove,
    restore_list,
    find_loads,
    advance,
    largest_displacement,
    free_boundary_wrenches,
    external_sums,
    particle_sums,
    contact_sums,
    kinetic_sums,
    total_bytes,
    make_engine,
    delete_engine,
    end
};

/// A call with its arguments, as far as the function has them
struct Command {
    Call call = Call::end;
    std::int32_t engine = 0;
    Domain domain = {};
    StepParameters step = {};
    LoadTimes times = {};
    float h = 0;
    std::int32_t flag = 0;
    double path = 0, s = 0;
    std::uint32_t ids = 0;
    std::uint64_t first = 0, last = 0;  ///< groups
    std::uint64_t bytes = 0;            ///< of further arguments, which follow
};
static_assert(std::is_trivially_copyable_v<Command>);

/// Makes the calls of the first process in this one, until it ends. Returns its exit code.
int serve_engines(const Communicator& all);

/// Of the first process: ends serve_engines() in the others.
void end_processes(const Communicator& all, int code);

/// The engine of all processes, in the first one. As an engine of a GPU it has a copy of all arrays where
/// they are read or changed as a whole, until the next step.
class FirstEngine final : public Engine {
public:
    /// `number`: differs from those of the other engines
    FirstEngine(const Communicator& all, int number);
    ~FirstEngine() override;

    Arrays<par::Cpu>& arrays() override;
    void arrays_modified() override;
    std::size_t pair_count() override;
    bool is_finite() override;
    void each_piece(bool with_pairs, const std::function<void(const Piece&)>& f) override;
    void each_piece_by_id(std::uint32_t ids,
                          const std::function<void(const Particles<par::Cpu>&)>& f) override;
    void prepare(const Domain& domain) override;
    void set_laws(const std::vector<PairLaw>& laws, const std::vector<std::uint8_t>& law_of,
                  std::uint32_t materials) override;
    void set_meshes(std::shared_ptr<const Meshes> meshes) override;
    bool set_boundaries(const std::vector<Boundary>& boundaries) override;
    void set_forces(const std::vector<Float4>& forces) override;
    void set_attached(const std::vector<AttachedParticle>& attached) override;
    void move_attached(const Domain& domain, const std::vector<BoundaryPose>& poses) override;
    void set_clumps(const Domain& domain, const ClumpTables& tables) override;
    void find_neighbours(const Domain& domain) override;
    std::vector<LeavingParticle> outside(const Domain& domain) override;
    void remove(const std::vector<std::uint32_t>& ids) override;
    void find_loads(const Domain& domain, const LoadTimes& times, bool store, double path) override;
    float advance(const StepParameters& step) override;
    float largest_displacement() override;
    const std::vector<Wrench>& free_boundary_wrenches(const Domain& domain) override;
    void set_watched(bool on) override;
    float take_largest_overlap() override;
    ExternalSums external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                               const std::vector<BoundaryVelocity>& after) override;
    ParticleSums particle_sums(const Domain& domain, bool only_forces) override;
    ContactSums contact_sums(const Domain& domain, float h) override;
    KineticSums kinetic_sums(double s) override;
    void wait() override {}
    double copy_rate() override { return own.copy_rate(); }
    std::size_t bytes() const override;

private:
    void call(Command command, const Lists& lists = {}) const;
    /// The call, and f() in this process
    template <class F>
    auto both(const Command& command, const Lists& lists, const F& f) const;
    void scatter(const Domain& domain, bool keeps_list);
    /// `ids`: larger than all ids, for pieces in their order; 0: in the order of the cells
    void each_piece(std::uint32_t ids, bool with_pairs, const std::function<void(const Piece&)>& f);
    void release_whole();

    const Communicator& all;
    const int number;
    mutable RankEngine own;
    Arrays<par::Cpu> whole;
    bool whole_is_current = true, ranks_are_current = false;
    std::vector<Boundary> last_boundaries;
};

}  // namespace hilda::granular
