// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/commands.hpp"

#include "granular/backend/instruction_set.hpp"
#include "io/error.hpp"
#include "io/message.hpp"

#include <omp.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

namespace hilda::granular {

namespace {

Meshes read_meshes(Lists& from)
{
    Meshes m;
    m.triangle = from.next<MeshTriangle>(), m.vertex = from.next<Vec3>();
    m.vertex_normal = from.next<Vec3>(), m.fan_start = from.next<std::uint32_t>();
    m.fan = from.next<std::uint32_t>(), m.part = from.next<Meshes::Part>();
    return m;
}

/// Makes a call in a process that is not the first one.
void make_call(RankEngine& e, const Command& c, Lists lists)
{
    switch (c.call) {
        case Call::set_laws: {
            const auto laws = lists.next<PairLaw>();
            return e.set_laws(laws, lists.next<std::uint8_t>(), static_cast<std::uint32_t>(c.flag));
        }
        case Call::set_meshes:
            return e.set_meshes(std::make_shared<Meshes>(read_meshes(lists)));
        case Call::set_boundaries:
            e.set_boundaries(lists.next<Boundary>());
            return;
        case Call::set_forces:
            return e.set_forces(lists.next<Float4>());
        case Call::set_attached:
            return e.set_attached(lists.next<AttachedParticle>());
        case Call::move_attached:
            return e.move_attached(c.domain, lists.next<BoundaryPose>());
        case Call::set_watched:
            return e.set_watched(c.flag != 0);
        case Call::scatter:
            return e.scatter(nullptr, c.domain, c.flag != 0);
        case Call::gather:
            return e.gather(nullptr);
        case Call::sort_into_groups:
            e.sort_into_groups(c.ids);
            return;
        case Call::gather_groups:
            e.gather_groups(nullptr, c.first, c.last, c.flag != 0);
            return;
        case Call::find_neighbours:
            try {
                e.find_neighbours(c.domain);
            } catch (const LeftDomain&) {  // of all processes; the first one reports it
            } catch (const TooManyPairs&) {
                throw io::InvalidInput(
                    "particles: the neighbour list of a process must not have more than 2^31 pairs");
            }
            return;
        case Call::outside:
            e.outside(c.domain);
            return;
        case Call::remove:
            return e.remove(lists.next<std::uint32_t>());
        case Call::pair_count:
            e.pair_count();
            return;
        case Call::is_finite:
            e.is_finite();
            return;
        case Call::restore_list:
            return e.restore_list(c.domain);
        case Call::find_loads:
            return e.find_loads(c.domain, c.times, c.flag != 0, c.path);
        case Call::advance:
            e.advance(c.step);
            return;
        case Call::largest_displacement:
            e.largest_displacement();
            return;
        case Call::free_boundary_wrenches:
            e.free_boundary_wrenches(c.domain);
            return;
        case Call::external_sums: {
            const auto before = lists.next<BoundaryVelocity>();
            e.external_sums(c.domain, before, lists.next<BoundaryVelocity>());
            return;
        }
        case Call::particle_sums:
            e.particle_sums(c.domain, c.flag != 0);
            return;
        case Call::contact_sums:
            e.contact_sums(c.domain, c.h);
            return;
        case Call::kinetic_sums:
            e.kinetic_sums(c.s);
            return;
        case Call::total_bytes:
            e.total_bytes();
            return;
        case Call::make_engine:
        case Call::delete_engine:
        case Call::end:
            break;
    }
    throw std::logic_error("a call for all engines");
}

/// A call with short lists; longer ones follow.
struct Message {
    Command command;
    char lists[640] = {};
};

void send(const Communicator& all, Command command, const Lists& lists)
{
    std::string bytes = lists.bytes();
    command.bytes = bytes.size();
    Message m{.command = command};
    std::memcpy(m.lists, bytes.data(), std::min(bytes.size(), sizeof m.lists));
    all.broadcast(&m, sizeof m);
    if (bytes.size() > sizeof m.lists) all.broadcast(bytes.data(), bytes.size());
}

}  // namespace

int serve_engines(const Communicator& all)
{
    std::map<int, RankEngine> engines;
    for (;;) {
        Message m;
        all.broadcast(&m, sizeof m);
        const Command& c = m.command;
        std::string bytes(m.lists, std::min<std::size_t>(c.bytes, sizeof m.lists));
        bytes.resize(c.bytes);
        if (bytes.size() > sizeof m.lists) all.broadcast(bytes.data(), bytes.size());
        if (c.call == Call::end) return c.flag;
        if (c.call == Call::delete_engine) {
            engines.erase(c.engine);
        } else if (c.call == Call::make_engine) {
            omp_set_num_threads(c.flag);
            if (!bytes.empty()) choose_instruction_set(bytes);
            engines.try_emplace(c.engine, all);
        } else {
            make_call(engines.at(c.engine), c, Lists(std::move(bytes)));
        }
    }
}

void end_processes(const Communicator& all, int code) { send(all, {.call = Call::end, .flag = code}, {}); }

namespace {

/// Makes the engine with this number in the other processes. The first one has to follow.
const Communicator& made_by_others(const Communicator& all, int number)
{
    // A process without a name uses the widest vector instructions of its own processor.
    const InstructionSet* const set = chosen_instruction_set();
    send(all, {.call = Call::make_engine, .engine = number, .flag = omp_get_max_threads()},
         Lists(set != nullptr ? set->name : ""));
    return all;
}

}  // namespace

FirstEngine::FirstEngine(const Communicator& all, int number)
    : all(all), number(number), own(made_by_others(all, number))
{}

FirstEngine::~FirstEngine()
{
    if (!all.in_call) call({.call = Call::delete_engine});
}

void FirstEngine::call(Command command, const Lists& lists) const
{
    command.engine = number;
    send(all, command, lists);
}

template <class F>
auto FirstEngine::both(const Command& command, const Lists& lists, const F& f) const
{
    call(command, lists);
    all.in_call = true;
    if constexpr (std::is_void_v<decltype(f())>) {
        f();
        all.in_call = false;
    } else {
        decltype(auto) result = f();
        all.in_call = false;
        return result;
    }
}

Arrays<par::Cpu>& FirstEngine::arrays()
{
    if (!whole_is_current) {
        both({.call = Call::gather}, {}, [&] { own.gather(&whole); });
        whole_is_current = true;
    }
    return whole;
}

namespace {

/// Most particles that are collected as a whole, and of a piece if its groups are small
std::uint64_t most_of_piece(const Communicator& all)
{
    constexpr std::uint64_t of_process = 1024;
    return of_process * static_cast<std::uint64_t>(all.size());
}

}  // namespace

void FirstEngine::each_piece(std::uint32_t ids, bool with_pairs, const std::function<void(const Piece&)>& f)
{
    if (whole_is_current) return f({whole, whole.particle.count});
    const std::vector<std::uint64_t> particles =
        both({.call = Call::sort_into_groups, .ids = ids}, {}, [&] { return own.sort_into_groups(ids); });
    const std::uint64_t all_particles = std::accumulate(particles.begin(), particles.end(), std::uint64_t{0});
    const std::uint64_t most = most_of_piece(all);
    if (all_particles <= most) {
        Arrays<par::Cpu>& kept = arrays();
        return f({kept, kept.particle.count});
    }
    Arrays<par::Cpu> piece;
    for (std::size_t first = 0, last = 0; last < particles.size(); first = last) {
        std::uint64_t of_piece = 0;
        do of_piece += particles[last++];
        while (last < particles.size() && of_piece + particles[last] <= most);
        if (of_piece == 0) continue;
        const std::uint32_t number =
            both({.call = Call::gather_groups, .flag = with_pairs ? 1 : 0, .first = first, .last = last}, {},
                 [&] { return own.gather_groups(&piece, first, last, with_pairs); });
        f({piece, number});
    }
}

void FirstEngine::each_piece(bool with_pairs, const std::function<void(const Piece&)>& f)
{
    each_piece(0, with_pairs, f);
}

void FirstEngine::each_piece_by_id(std::uint32_t ids,
                                   const std::function<void(const Particles<par::Cpu>&)>& f)
{
    each_piece(std::max(ids, 1u), false, [&](const Piece& piece) { f(piece.arrays.particle); });
}

std::size_t FirstEngine::pair_count()
{
    if (whole_is_current) return whole.pairs.count;
    return both({.call = Call::pair_count}, {}, [&] { return own.pair_count(); });
}

bool FirstEngine::is_finite()
{
    if (whole_is_current) return Engine::is_finite();
    return both({.call = Call::is_finite}, {}, [&] { return own.is_finite(); });
}

/// The copy of all arrays is no longer that of the processes.
void FirstEngine::release_whole()
{
    if (ranks_are_current && whole.particle.count > most_of_piece(all)) whole = {};
    whole_is_current = false;
}

void FirstEngine::arrays_modified() { whole_is_current = true, ranks_are_current = false; }

void FirstEngine::scatter(const Domain& domain, bool keeps_list)
{
    if (domain.small < domain.largest)
        throw io::InvalidInput(io::formatted(
            "mpirun: a run on several processes does not support particles that are larger than the cells of "
            "most others (radius in /particles, /fill and /insert), got radii up to %g m; those up to %g m "
            "are possible",
            domain.largest, domain.small));
    const std::int32_t smallest = Partition::shifts[std::size(Partition::shifts) - 1], edge = 1 << smallest;
    if (const double most = BlockGrid(domain.grid, smallest).count(); most < all.size())
        throw io::InvalidInput(
            io::formatted("mpirun: the domain (/domain) has %.0f blocks of %d x %d x %d cells, so that there "
                          "can be at most as many processes, got %d",
                          most, edge, edge, edge, all.size()));
    both({.call = Call::scatter, .domain = domain, .flag = keeps_list ? 1 : 0}, {},
         [&] { own.scatter(&whole, domain, keeps_list); });
    ranks_are_current = true;
}

void FirstEngine::set_laws(const std::vector<PairLaw>& laws, const std::vector<std::uint8_t>& law_of,
                           std::uint32_t materials)
{
    Lists lists;
    lists.add(laws), lists.add(law_of);
    both({.call = Call::set_laws, .flag = static_cast<std::int32_t>(materials)}, lists,
         [&] { own.set_laws(laws, law_of, materials); });
}

void FirstEngine::set_meshes(std::shared_ptr<const Meshes> meshes)
{
    Lists lists;
    lists.add(meshes->triangle), lists.add(meshes->vertex), lists.add(meshes->vertex_normal);
    lists.add(meshes->fan_start), lists.add(meshes->fan), lists.add(meshes->part);
    both({.call = Call::set_meshes}, lists, [&] { own.set_meshes(std::move(meshes)); });
}

bool FirstEngine::set_boundaries(const std::vector<Boundary>& boundaries)
{
    if (boundaries.size() == last_boundaries.size() &&
        (boundaries.empty() ||
         std::memcmp(static_cast<const void*>(boundaries.data()), last_boundaries.data(),
                     boundaries.size() * sizeof(Boundary)) == 0))
        return false;
    last_boundaries = boundaries;
    Lists lists;
    lists.add(boundaries);
    both({.call = Call::set_boundaries}, lists, [&] { own.set_boundaries(boundaries); });
    return true;
}

void FirstEngine::set_forces(const std::vector<Float4>& forces)
{
    Lists lists;
    lists.add(forces);
    both({.call = Call::set_forces}, lists, [&] { own.set_forces(forces); });
}

void FirstEngine::set_attached(const std::vector<AttachedParticle>& particles)
{
    Lists lists;
    lists.add(particles);
    both({.call = Call::set_attached}, lists, [&] { own.set_attached(particles); });
}

/// Each process moves its particles and its ghosts.
void FirstEngine::move_attached(const Domain& domain, const std::vector<BoundaryPose>& poses)
{
    release_whole();
    Lists lists;
    lists.add(poses);
    both({.call = Call::move_attached, .domain = domain}, lists, [&] { own.move_attached(domain, poses); });
}

void FirstEngine::set_clumps(const Domain&, const ClumpTables& tables)
{
    if (!tables.of.empty())
        throw io::InvalidInput("mpirun: a run on several processes does not support clumps (/clumps)");
}

void FirstEngine::find_neighbours(const Domain& domain)
{
    const bool scatters = !ranks_are_current;
    if (scatters) scatter(domain, false);
    const std::optional<LeftDomain> lost =
        both({.call = Call::find_neighbours, .domain = domain}, {}, [&]() -> std::optional<LeftDomain> {
            try {
                own.find_neighbours(domain);
            } catch (const LeftDomain& e) {
                return e;
            }
            return {};
        });
    if (lost && scatters)  // there is no list yet from which the arrays could be collected
        ranks_are_current = false;
    else
        release_whole();
    if (lost) throw LeftDomain{*lost};
}

std::vector<LeavingParticle> FirstEngine::outside(const Domain& domain)
{
    if (whole_is_current) return Engine::outside(domain);
    return both({.call = Call::outside, .domain = domain}, {}, [&] { return own.outside(domain); });
}

void FirstEngine::remove(const std::vector<std::uint32_t>& ids)
{
    if (whole_is_current) return Engine::remove(ids);
    Lists lists;
    lists.add(ids);
    both({.call = Call::remove}, lists, [&] { own.remove(ids); });
}

void FirstEngine::prepare(const Domain& domain)
{
    if (ranks_are_current) return;
    // After an insertion there is no list, and a search follows.
    const bool has_list = whole.particle.position_at_build.size() == whole.particle.count;
    scatter(domain, has_list);
    if (has_list) both({.call = Call::restore_list, .domain = domain}, {}, [&] { own.restore_list(domain); });
}

void FirstEngine::find_loads(const Domain& domain, const LoadTimes& times, bool store, double path)
{
    release_whole();
    both({.call = Call::find_loads, .domain = domain, .times = times, .flag = store ? 1 : 0, .path = path},
         {}, [&] { own.find_loads(domain, times, store, path); });
}

float FirstEngine::advance(const StepParameters& step)
{
    release_whole();
    return both({.call = Call::advance, .step = step}, {}, [&] { return own.advance(step); });
}

float FirstEngine::largest_displacement()
{
    return both({.call = Call::largest_displacement}, {}, [&] { return own.largest_displacement(); });
}

const std::vector<Wrench>& FirstEngine::free_boundary_wrenches(const Domain& domain)
{
    both({.call = Call::free_boundary_wrenches, .domain = domain}, {},
         [&] { own.free_boundary_wrenches(domain); });
    return own.last_wrenches();
}

void FirstEngine::set_watched(bool on)
{
    both({.call = Call::set_watched, .flag = on ? 1 : 0}, {}, [&] { own.set_watched(on); });
}

float FirstEngine::take_largest_overlap() { return own.take_largest_overlap(); }

ExternalSums FirstEngine::external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                                        const std::vector<BoundaryVelocity>& after)
{
    Lists lists;
    lists.add(before), lists.add(after);
    return both({.call = Call::external_sums, .domain = domain}, lists,
                [&] { return own.external_sums(domain, before, after); });
}

ParticleSums FirstEngine::particle_sums(const Domain& domain, bool only_forces)
{
    return both({.call = Call::particle_sums, .domain = domain, .flag = only_forces ? 1 : 0}, {},
                [&] { return own.particle_sums(domain, only_forces); });
}

ContactSums FirstEngine::contact_sums(const Domain& domain, float h)
{
    return both({.call = Call::contact_sums, .domain = domain, .h = h}, {},
                [&] { return own.contact_sums(domain, h); });
}

KineticSums FirstEngine::kinetic_sums(double s)
{
    return both({.call = Call::kinetic_sums, .s = s}, {}, [&] { return own.kinetic_sums(s); });
}

std::size_t FirstEngine::bytes() const
{
    return static_cast<std::size_t>(both({.call = Call::total_bytes}, {}, [&] { return own.total_bytes(); }));
}

}  // namespace hilda::granular
