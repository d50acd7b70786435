// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/rank_engine.hpp"

#include "granular/core/neighbours/cells.hpp"
#include "granular/distributed/lists.hpp"
#include "io/error.hpp"

#include <ctime>

#include <algorithm>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

/// Work of a particle in a step, and of each of its pairs: the numbers of SweepPlan
constexpr float particle_work = 4, pair_work = 1;

/// CPU time of this process [s]
double cpu_time()
{
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Adds the CPU time of its lifetime to a number.
class Busy {
public:
    explicit Busy(double& to) : to(to) {}
    ~Busy() { to += cpu_time() - begin; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

private:
    double& to;
    const double begin = cpu_time();
};

struct Largest {
    float value = 0;
    Largest& operator+=(const Largest& o)
    {
        value = par::nan_max(value, o.value);
        return *this;
    }
};

/// What a step reports
struct StepExtremes {
    Largest speed, overlap;
    StepExtremes& operator+=(const StepExtremes& o)
    {
        speed += o.speed, overlap += o.overlap;
        return *this;
    }
};

/// Sum and maximum of a number of each process
struct Spread {
    double sum = 0, largest = 0;
    explicit Spread(double x) : sum(x), largest(x) {}
    Spread& operator+=(const Spread& o)
    {
        sum += o.sum, largest = std::max(largest, o.largest);
        return *this;
    }
    double imbalance(int processes) const { return sum > 0 ? largest * processes / sum - 1 : 0; }
};

/// The particle outside the domain that is the last one in the order of the last search
struct Outside {
    std::uint64_t key = 0;  ///< of its cell then, plus 1; 0: there is none
    std::uint32_t id = 0;
    Outside& operator+=(const Outside& o)
    {
        if (std::pair(o.key, o.id) > std::pair(key, id)) *this = o;
        return *this;
    }
};

}  // namespace

/// The own particles that are ghosts of other processes
struct RankEngine::Ghosts {
    std::vector<int> to;               ///< process, ascending
    std::vector<std::uint32_t> which;  ///< places in the list of the particles
};

/// Assigns the own particles to their cells. Throws LeftDomain in all processes if one is outside the domain.
void RankEngine::assign_cells(const Domain& domain)
{
    Particles<par::Cpu>& p = own.particle;
    keys.resize(p.count), order.resize(p.count);
    const detail::AssignCell assign{domain.grid, p.position.data(), p.species.data(), keys.data(),
                                    order.data()};
    Outside outside;
    for (std::uint32_t k = 0; k < p.count; ++k) {
        if (is_ghost(k)) continue;
        assign(k);
        if (keys.data()[k] == detail::outside_domain)
            outside += Outside{
                key_of(domain.grid, p.position_at_build.data()[k].cell, p.species.data()[k].replica) + 1,
                p.id.data()[k]};
    }
    outside = all.reduced_for_all(outside);
    if (outside.key > 0) throw LeftDomain{outside.id};
}

/// Divides the domain again if its work is not balanced.
///
/// The weight of a block is the work of its particles now times the CPU time of its process for a unit of
/// work. This time is a mean in which each period of steps counts less than the next one: CPU times of short
/// periods fluctuate, while work moves with the particles.
void RankEngine::divide_again(const Domain& domain)
{
    // The processes decide by the same numbers: a process may be without particles, and without work.
    constexpr long period = 200, report = 1000;  // [steps]
    constexpr double memory = 0.9, most = 0.05;
    if (steps < period) return;
    if (++periods > 1) reported += present.time, steps_reported += steps;  // before, no time is known
    past = {memory * past.time + present.time, memory * past.work + present.work};
    present = {}, steps = 0;
    if (steps_reported >= report) {
        const Spread of_processes = all.reduced_for_all(Spread(reported));
        all.imbalance.busiest += of_processes.largest, all.imbalance.mean += of_processes.sum / all.size();
        reported = 0, steps_reported = 0;
    }
    const double time = past.work > 0 ? past.time / past.work : 0;
    if (all.reduced_for_all(Spread(time * work_of_step)).imbalance(all.size()) <= most) return;

    const CellGrid& g = domain.grid;
    std::vector<float> work(own.particle.count, particle_work);
    for (std::uint32_t n = 0; n < own.pairs.count; ++n) work[own.pairs.i.data()[n]] += pair_work;
    std::vector<BlockWork> blocks;
    for (std::uint32_t k = 0; k < own.particle.count; ++k) {
        if (is_ghost(k)) continue;
        const std::uint32_t cell = own.particle.position.data()[k].cell;
        blocks.push_back({partition.grid().block_of(g.x_of(cell), g.y_of(cell), g.z_of(cell)),
                          static_cast<float>(time) * work[k]});
    }
    // Particles have moved: a block can have some of two processes. It belongs to its owner.
    Addressed<BlockWork> to;
    std::sort(blocks.begin(), blocks.end(),
              [](const BlockWork& a, const BlockWork& b) { return a.block < b.block; });
    const auto merge = [](std::vector<BlockWork>& list) {
        std::vector<BlockWork> merged;
        for (const BlockWork& b : list)
            if (!merged.empty() && merged.back().block == b.block)
                merged.back().weight += b.weight;
            else
                merged.push_back(b);
        list = std::move(merged);
    };
    merge(blocks);
    for (const BlockWork& b : blocks) to.emplace_back(partition.owner(b.block), b);
    blocks = exchanged(all, to);
    std::sort(blocks.begin(), blocks.end(),
              [](const BlockWork& a, const BlockWork& b) { return a.block < b.block; });
    merge(blocks);
    partition.make(g, partition.grid().shift, blocks);
    steps_since_division = 0;
    std::fill(surrounded.begin(), surrounded.end(), static_cast<signed char>(-1));
    // The work that each process has now
    Addressed<BlockWork> next;
    for (const BlockWork& b : blocks) next.emplace_back(partition.owner(b.block), b);
    double own_weight = 0;
    for (const BlockWork& b : exchanged(all, next)) own_weight += b.weight;
    all.imbalance.predicted = all.reduced_for_all(Spread(own_weight)).imbalance(all.size());
    ++all.imbalance.divisions;
}

void RankEngine::find_neighbours(const Domain& domain)
{
    assign_cells(domain);
    divide_again(domain);
    rebuild(domain);
}

std::vector<LeavingParticle> RankEngine::outside(const Domain& domain)
{
    std::vector<LeavingParticle> found = particles_outside(own.particle, domain.grid), of_other;
    if (!all.is_first()) {
        all.send(0, found);
        return {};
    }
    for (int from = 1; from < all.size(); ++from) {
        all.receive(from, of_other);
        found.insert(found.end(), of_other.begin(), of_other.end());
    }
    std::sort(found.begin(), found.end());
    return found;
}

void RankEngine::remove(const std::vector<std::uint32_t>& ids)
{
    remove_particles(own.particle, own.pairs, ids);
    own.pairs.start.resize(0);
    EngineOn::arrays_modified();
    find_attached();
    ghost_plan.reset();
}

void RankEngine::restore_list(const Domain& domain)
{
    Particles<par::Cpu>& p = own.particle;
    for (std::uint32_t k = 0; k < p.count; ++k)
        std::swap(p.position.data()[k], p.position_at_build.data()[k]);
    // position_at_build has the present positions. They are those of the records of rebuild().
    std::vector<std::pair<std::uint32_t, Position>> present;
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (!is_ghost(k)) present.emplace_back(p.id.data()[k], p.position_at_build.data()[k]);
    std::sort(present.begin(), present.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    rebuild(domain);
    for (std::uint32_t k = 0; k < p.count; ++k) {
        if (is_ghost(k)) continue;
        const auto at = std::lower_bound(present.begin(), present.end(), p.id.data()[k],
                                         [](const auto& a, std::uint32_t id) { return a.first < id; });
        p.position.data()[k] = at->second;
    }
    send_ghosts();
}

namespace {

/// Different values out of three, in the order of their first occurrence
struct Few {
    std::int32_t value[3];
    int count = 0;

    void add(std::int32_t x)
    {
        for (int k = 0; k < count; ++k)
            if (value[k] == x) return;
        value[count++] = x;
    }
};

}  // namespace

/// Lists the other processes that have blocks around a cell, or around the block of a cell.
void RankEngine::find_others_around(const CellGrid& g, std::uint32_t cell, bool of_block,
                                    std::vector<int>& others) const
{
    const BlockGrid& b = partition.grid();
    const std::int32_t at[] = {g.x_of(cell), g.y_of(cell), g.z_of(cell)};
    Few along[3];
    for (int a = 0; a < 3; ++a) {
        along[a].add(at[a] >> b.shift);
        for (const int side : {-1, 1}) {
            const std::int32_t end = of_block ? b.blocks[a] : g.cells[a];
            std::int32_t next = (of_block ? at[a] >> b.shift : at[a]) + side;
            if (g.periodic[a] != 0) next = next < 0 ? end - 1 : next >= end ? 0 : next;
            if (next >= 0 && next < end) along[a].add(of_block ? next : next >> b.shift);
        }
    }
    others.clear();
    for (int k = 0; k < along[2].count; ++k)
        for (int j = 0; j < along[1].count; ++j)
            for (int i = 0; i < along[0].count; ++i) {
                const int owner =
                    partition.owner(b.number(along[0].value[i], along[1].value[j], along[2].value[k]));
                if (owner != all.rank() && std::find(others.begin(), others.end(), owner) == others.end())
                    others.push_back(owner);
            }
}

/// The particles in the cells next to those of other processes, which they need as ghosts
RankEngine::Ghosts RankEngine::find_ghosts(const CellGrid& g, const std::vector<std::uint32_t>& cells) const
{
    std::vector<std::pair<int, std::uint32_t>> to;
    std::vector<int> others;
    for (std::uint32_t k = 0; k < cells.size(); ++k) {
        // Particles of a cell mostly follow each other.
        if (k == 0 || cells[k] != cells[k - 1]) {
            const std::uint32_t cell = cells[k];
            signed char& known =
                surrounded[partition.grid().block_of(g.x_of(cell), g.y_of(cell), g.z_of(cell))];
            if (known < 0) {
                find_others_around(g, cell, true, others);
                known = others.empty() ? 1 : 0;
            }
            if (known != 0)
                others.clear();
            else
                find_others_around(g, cell, false, others);
        }
        for (const int process : others) to.emplace_back(process, k);
    }
    std::sort(to.begin(), to.end());
    Ghosts ghosts;
    for (const auto& [process, k] : to) ghosts.to.push_back(process), ghosts.which.push_back(k);
    return ghosts;
}

/// Moves the particles to their processes, finds the ghosts, and builds the list.
void RankEngine::rebuild(const Domain& domain)
{
    Particles<par::Cpu>& p = own.particle;
    Pairs<par::Cpu>& pairs = own.pairs;
    if (domain.has_images())
        throw io::InvalidInput(
            "domain: a periodic axis must be at least three times as long as the largest "
            "diameter and the skin, or three cells, in a run with several processes; use one");
    const CellGrid& g = grid = domain.grid;
    replicas = domain.replicas;
    const std::uint32_t before = p.count, *const id = p.id.data();
    // The particles that stay, and the place of each particle among them
    stay.clear(), place.assign(before, none), owner.assign(before, all.rank());
    Addressed<ParticleRecord> leaving;
    for (std::uint32_t k = 0; k < before; ++k) {
        if (is_ghost(k)) continue;
        owner[k] = owner_of(g, p.position.data()[k].cell);
        if (owner[k] == all.rank())
            place[k] = static_cast<std::uint32_t>(stay.size()), stay.push_back(k);
        else
            leaving.emplace_back(owner[k], record_of(p, k));
    }
    Addressed<ContactHistory> leaving_contacts;
    for (std::uint32_t n = 0; !leaving.empty() && n < pairs.count; ++n) {
        if (pairs.in_contact.data()[n] == 0) continue;
        const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
        const auto send_to = [&](int process) {
            if (process != all.rank()) leaving_contacts.emplace_back(process, contact_of(pairs, id, n));
        };
        send_to(owner[i]);
        if ((j & PairView::boundary_bit) == 0 && owner[j] != owner[i]) send_to(owner[j]);
    }
    std::vector<ParticleRecord> added = exchanged(all, leaving);
    std::vector<ContactHistory> arrived = exchanged(all, leaving_contacts);
    // Two processes send the contact of two particles that both come here.
    const auto pair_of = [](const ContactHistory& c) { return std::pair(c.i, c.j); };
    std::sort(arrived.begin(), arrived.end(),
              [&](const ContactHistory& a, const ContactHistory& b) { return pair_of(a) < pair_of(b); });
    arrived.erase(std::unique(arrived.begin(), arrived.end(),
                              [&](const ContactHistory& a, const ContactHistory& b) {
                                  return pair_of(a) == pair_of(b);
                              }),
                  arrived.end());
    const auto staying = static_cast<std::uint32_t>(stay.size()),
               first_ghost = staying + static_cast<std::uint32_t>(added.size());

    cells.clear();
    for (const std::uint32_t k : stay) cells.push_back(p.position.data()[k].cell);
    for (const ParticleRecord& r : added) cells.push_back(r.position.cell);
    Ghosts ghosts = find_ghosts(g, cells);
    std::vector<GhostRecord> records;
    records.reserve(ghosts.which.size());
    for (const std::uint32_t k : ghosts.which) {
        const ParticleRecord r = k < staying ? record_of(p, stay[k]) : added[k - staying];
        records.push_back({r.position, r.velocity, r.omega, r.species, r.id});
    }
    ghost_plan.emplace(all, std::move(ghosts.to));
    for (const GhostRecord& r : ghost_plan->exchange(records))
        added.push_back({.position = r.position,
                         .position_at_build = r.position,
                         .velocity = r.velocity,
                         .omega = r.omega,
                         .species = r.species,
                         .id = r.id});
    Index others;
    for (std::uint32_t k = 0; k < added.size(); ++k) others.add(added[k].id, staying + k);
    others.sort();

    // The contacts that this process had or has received, between particles that it has now
    const auto place_before = [&](std::uint32_t k) {
        return place[k] != none ? place[k] : others.find(id[k]).value_or(none);
    };
    std::uint32_t contacts = 0;
    const auto move_to = [&](auto& values, std::uint32_t n) {
        if (n < values.size()) values.data()[contacts] = values.data()[n];
    };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        if (pairs.in_contact.data()[n] == 0) continue;
        const std::uint32_t i = place_before(pairs.i.data()[n]), j = pairs.j.data()[n],
                            new_j = (j & PairView::boundary_bit) != 0 ? j : place_before(j);
        if (i == none || new_j == none) continue;
        pairs.i.data()[contacts] = i, pairs.j.data()[contacts] = new_j;
        move_to(pairs.history, n), move_to(pairs.rotation_history, n), move_to(pairs.internal, n);
        ++contacts;
    }
    // The particles of the arrived contacts that were here before
    std::vector<std::uint32_t> wanted;
    for (const ContactHistory& c : arrived) wanted.push_back(c.i), wanted.push_back(c.j);
    std::sort(wanted.begin(), wanted.end());
    Index known_before;
    for (std::uint32_t k = 0; !wanted.empty() && k < staying; ++k)
        if (std::binary_search(wanted.begin(), wanted.end(), id[stay[k]])) known_before.add(id[stay[k]], k);
    known_before.sort();
    const auto place_of = [&](std::uint32_t of) {
        if ((of & PairView::boundary_bit) != 0) return of;
        const auto at = others.find(of);
        return at ? *at : known_before.find(of).value_or(none);
    };
    ContactList list;
    for (const ContactHistory& c : arrived)
        if (place_of(c.i) != none && place_of(c.j) != none) list.add(place_of(c.i), place_of(c.j), c);
    const bool has_rotation = rotation_laws && (contacts == 0 || pairs.rotation_history.size() > 0),
               has_internal = internal && (contacts == 0 || pairs.internal.size() > 0);
    append(pairs.i, contacts, list.i), append(pairs.j, contacts, list.j);
    append(pairs.history, contacts, list.history);
    if (has_rotation) append(pairs.rotation_history, contacts, list.rotation);
    if (has_internal) append(pairs.internal, contacts, list.internal);
    pairs.count = static_cast<std::uint32_t>(contacts + list.i.size());
    pairs.in_contact.resize(pairs.count);
    par::fill(par::Cpu(), pairs.in_contact.data(), pairs.count, std::uint8_t{1});

    replace(p, stay, added, used);
    for (std::uint32_t k = 0; k < p.count; ++k) p.ghost.data()[k] = k < first_ghost ? 0 : 1;

    Busy measures(present.time);
    EngineOn::find_neighbours(domain);
    const std::uint32_t* const now = neighbours.new_indices();
    sent.clear(), received.clear();
    for (const std::uint32_t k : ghosts.which) sent.push_back(now[k]);
    for (std::uint32_t k = first_ghost; k < p.count; ++k) received.push_back(now[k]);
    to_send.resize(sent.size()), to_receive.resize(received.size());

    work_of_step = 0;
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (!is_ghost(k)) work_of_step += particle_work;
    for (std::uint32_t n = 0; n < pairs.count; ++n)
        if (!is_ghost(pairs.i.data()[n])) work_of_step += pair_work;
}

/// Sends the state of the particles that are ghosts of other processes.
void RankEngine::send_ghosts()
{
    if (!ghost_plan) return;  // before the first search
    Particles<par::Cpu>& p = own.particle;
    requests.clear();
    GhostState* to = to_receive.data();
    constexpr int tag = 12;
    for (const Plan::Group& from : ghost_plan->received()) {
        MPI_Irecv(to, from.values * static_cast<int>(sizeof *to), MPI_BYTE, from.process, tag, all.handle(),
                  &requests.emplace_back());
        to += from.values;
    }
    for (std::size_t n = 0; n < sent.size(); ++n) {
        const std::uint32_t k = sent[n];
        const Position& at = p.position.data()[k];
        const Float4 &v = p.velocity.data()[k], &w = p.omega.data()[k];
        to_send[n] = {at.x, at.y, at.z, {v.x, v.y, v.z}, {w.x, w.y, w.z}};
    }
    const GhostState* from = to_send.data();
    for (const Plan::Group& group : ghost_plan->sent()) {
        MPI_Isend(from, group.values * static_cast<int>(sizeof *from), MPI_BYTE, group.process, tag,
                  all.handle(), &requests.emplace_back());
        from += group.values;
    }
    all.wait(requests.data(), static_cast<int>(requests.size()));
    for (std::size_t n = 0; n < received.size(); ++n) {
        const std::uint32_t k = received[n];
        const GhostState& state = to_receive[n];
        Position& at = p.position.data()[k];
        Float4 &v = p.velocity.data()[k], &w = p.omega.data()[k];
        at.x = state.x, at.y = state.y, at.z = state.z;
        v.x = state.v[0], v.y = state.v[1], v.z = state.v[2];
        w.x = state.omega[0], w.y = state.omega[1], w.z = state.omega[2];
    }
}

void RankEngine::find_loads(const Domain& domain, const LoadTimes& times, bool store, double path)
{
    Busy measures(present.time);
    EngineOn::find_loads(domain, times, store, path);
}

float RankEngine::advance(const StepParameters& step)
{
    StepExtremes extremes;
    {
        Busy measures(present.time);
        extremes.speed.value = EngineOn::advance(step);
        extremes.overlap.value = watched ? EngineOn::take_largest_overlap() : 0;
    }
    if (step.part != Part::only_loads) send_ghosts();
    if (step.part != Part::before_loads) ++steps, ++steps_since_division, present.work += work_of_step;
    extremes = all.reduced(extremes);
    largest_overlap = par::nan_max(largest_overlap, extremes.overlap.value);
    return extremes.speed.value;
}

float RankEngine::largest_displacement()
{
    return all.reduced_for_all(Largest{EngineOn::largest_displacement()}).value;
}

const std::vector<Wrench>& RankEngine::free_boundary_wrenches(const Domain& domain)
{
    find_wrench_parts(domain);
    all.reduce(wrench_parts.data(), wrench_parts.size());
    return wrenches_of_parts();
}

float RankEngine::take_largest_overlap() { return std::exchange(largest_overlap, 0.f); }

ExternalSums RankEngine::external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                                       const std::vector<BoundaryVelocity>& after)
{
    return all.reduced(external_part(domain, before, after)).value();
}

ParticleSums RankEngine::particle_sums(const Domain& domain, bool only_forces)
{
    return all.reduced(particle_part(domain, only_forces)).value();
}

ContactSums RankEngine::contact_sums(const Domain& domain, float h)
{
    return all.reduced(contact_part(domain, h)).value();
}

KineticSums RankEngine::kinetic_sums(double s) { return all.reduced(kinetic_part(s)).value(); }

double RankEngine::total_bytes() const
{
    return all.reduced_for_all(Spread(static_cast<double>(bytes()))).sum;
}

}  // namespace hilda::granular
