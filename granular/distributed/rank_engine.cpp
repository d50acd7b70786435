// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/rank_engine.hpp"

#include "granular/core/neighbours/cells.hpp"

#include <ctime>

#include <algorithm>
#include <utility>

namespace hilda::granular {

namespace {

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

/// Number of a cell in the order of replicas, z, y, x
std::uint64_t key_of(const CellGrid& g, std::uint32_t cell, std::uint16_t replica)
{
    const auto n = [&](int k) { return static_cast<std::uint64_t>(g.cells[k]); };
    return ((replica * n(2) + static_cast<std::uint64_t>(g.z_of(cell))) * n(1) +
            static_cast<std::uint64_t>(g.y_of(cell))) *
               n(0) +
           static_cast<std::uint64_t>(g.x_of(cell));
}

/// A value and the process to which it goes
template <class T>
using Addressed = std::vector<std::pair<int, T>>;

/// Sends the values and returns those of the other processes.
template <class T>
std::vector<T> exchanged(const Communicator& all, Addressed<T> values)
{
    std::stable_sort(values.begin(), values.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<int> to;
    std::vector<T> of;
    for (const auto& [process, value] : values) to.push_back(process), of.push_back(value);
    return Plan(all, std::move(to)).exchange(of);
}

template <class T>
void assign(par::Array<par::Cpu, T>& to, const std::vector<T>& from)
{
    to.resize(from.size());
    std::copy(from.begin(), from.end(), to.data());
}

/// Contacts with the indices of their particles
struct ContactList {
    std::vector<std::uint32_t> i, j;
    std::vector<Float4> history, rotation, internal;

    void add(std::uint32_t of_i, std::uint32_t of_j, const ContactHistory& c)
    {
        i.push_back(of_i), j.push_back(of_j);
        history.push_back(c.history), rotation.push_back(c.rotation), internal.push_back(c.internal);
    }
    /// As the contacts of a list before a neighbour search
    void put(Pairs<par::Cpu>& pairs, bool has_rotation, bool has_internal) const
    {
        pairs.count = static_cast<std::uint32_t>(i.size());
        assign(pairs.i, i), assign(pairs.j, j), assign(pairs.history, history);
        if (has_rotation)
            assign(pairs.rotation_history, rotation);
        else
            pairs.rotation_history.resize(0);
        if (has_internal)
            assign(pairs.internal, internal);
        else
            pairs.internal.resize(0);
        pairs.in_contact.resize(i.size());
        par::fill(par::Cpu(), pairs.in_contact.data(), i.size(), std::uint8_t{1});
    }
};

ContactHistory contact_of(const Pairs<par::Cpu>& pairs, const std::uint32_t* id, std::uint32_t n)
{
    const std::uint32_t j = pairs.j.data()[n];
    return {.i = id[pairs.i.data()[n]],
            .j = (j & PairView::boundary_bit) != 0 ? j : id[j],
            .history = pairs.history.data()[n],
            .rotation = value_of(pairs.rotation_history, n),
            .internal = value_of(pairs.internal, n)};
}

/// Indices of particles by id
class Index {
public:
    void add(std::uint32_t id, std::uint32_t index) { entries.emplace_back(id, index); }
    void sort() { std::sort(entries.begin(), entries.end()); }
    std::optional<std::uint32_t> find(std::uint32_t id) const
    {
        const auto at = std::lower_bound(entries.begin(), entries.end(), std::pair(id, std::uint32_t{0}));
        if (at == entries.end() || at->first != id) return {};
        return at->second;
    }

private:
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;
};

constexpr std::uint32_t none = ~std::uint32_t{0};

}  // namespace

/// The ghosts of this process, and the places of its own particles that are ghosts of others
struct RankEngine::Ghosts {
    std::vector<int> to;               ///< process, ascending
    std::vector<std::uint32_t> which;  ///< places in the list of the particles
    std::vector<GhostRecord> records;
};

/// Work of a particle with its row of pairs; the numbers are those of SweepPlan.
double RankEngine::work_of(std::uint32_t k) const
{
    return 4 + static_cast<double>(own.pairs.start.data()[k + 1] - own.pairs.start.data()[k]);
}

void RankEngine::scatter(Arrays<par::Cpu>* whole, const Domain& domain, bool keeps_list)
{
    const CellGrid& g = domain.grid;
    struct Sizes {
        std::uint32_t edge, particles;
        UsedArrays used;
    } sizes{};
    std::vector<BlockWork> loaded;
    const auto cell = [&](std::uint32_t k) {
        const Particles<par::Cpu>& p = whole->particle;
        return keeps_list ? p.position_at_build.data()[k].cell : p.position.data()[k].cell;
    };
    if (whole != nullptr) {
        Particles<par::Cpu>& p = whole->particle;
        if (!keeps_list) {
            p.position_at_build.resize(p.count);
            std::copy_n(p.position.data(), p.count, p.position_at_build.data());
        }
        sizes.particles = p.count;
        sizes.used = {p.acc.size() > 0, p.orientation.size() > 0};
        for (const std::int32_t edge : Partition::edges) {
            const BlockGrid blocks(g, edge);
            sizes.edge = static_cast<std::uint32_t>(edge);
            std::vector<float> weight(static_cast<std::size_t>(blocks.count()));
            for (std::uint32_t k = 0; k < p.count; ++k)
                ++weight[blocks.block_of(g.x_of(cell(k)), g.y_of(cell(k)), g.z_of(cell(k)))];
            loaded.clear();
            for (std::uint32_t b = 0; b < weight.size(); ++b)
                if (weight[b] > 0) loaded.push_back({b, weight[b]});
            constexpr std::size_t each = 64;  // blocks of a process
            if (loaded.size() >= each * static_cast<std::size_t>(all.size())) break;
        }
    }
    all.broadcast(&sizes, sizeof sizes);
    used = sizes.used;
    partition.make(BlockGrid(g, static_cast<std::int32_t>(sizes.edge)), loaded);
    surrounded.assign(static_cast<std::size_t>(partition.grid().count()), -1);

    Addressed<ParticleRecord> particles;
    Addressed<ContactHistory> contacts;
    if (whole != nullptr) {
        const Particles<par::Cpu>& p = whole->particle;
        const Pairs<par::Cpu>& pairs = whole->pairs;
        std::vector<int> owner(p.count);
        particles.reserve(p.count);
        for (std::uint32_t k = 0; k < p.count; ++k) {
            owner[k] = owner_of(g, cell(k));
            particles.emplace_back(owner[k], record_of(p, k));
        }
        for (std::uint32_t n = 0; n < pairs.count; ++n) {
            if (pairs.in_contact.data()[n] == 0) continue;
            const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
            const ContactHistory c = contact_of(pairs, p.id.data(), n);
            contacts.emplace_back(owner[i], c);
            if ((j & PairView::boundary_bit) == 0 && owner[j] != owner[i]) contacts.emplace_back(owner[j], c);
        }
    }
    const std::vector<ParticleRecord> mine = exchanged(all, std::move(particles));
    const std::vector<ContactHistory> with_mine = exchanged(all, std::move(contacts));

    // All particles of the contacts; the partners of other processes are placeholders until rebuild() finds
    // them as ghosts.
    Index index;
    for (std::uint32_t k = 0; k < mine.size(); ++k) index.add(mine[k].id, k);
    index.sort();
    std::vector<std::uint32_t> partners;
    for (const ContactHistory& c : with_mine)
        for (const std::uint32_t id : {c.i, c.j})
            if ((id & PairView::boundary_bit) == 0 && !index.find(id)) partners.push_back(id);
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    const auto count = static_cast<std::uint32_t>(mine.size() + partners.size());
    resize(own.particle, count, used);
    own.particle.ghost.resize(count);
    for (std::uint32_t k = 0; k < mine.size(); ++k)
        set_record(own.particle, k, mine[k]), own.particle.ghost.data()[k] = 0;
    for (std::uint32_t k = 0; k < partners.size(); ++k) {
        const auto at = static_cast<std::uint32_t>(mine.size()) + k;
        ParticleRecord placeholder;
        placeholder.id = partners[k];
        set_record(own.particle, at, placeholder), own.particle.ghost.data()[at] = 1;
        index.add(partners[k], at);
    }
    index.sort();
    ContactList list;
    for (const ContactHistory& c : with_mine)
        list.add(*index.find(c.i), (c.j & PairView::boundary_bit) != 0 ? c.j : *index.find(c.j), c);
    list.put(own.pairs, rotation_laws, internal);
    own.pairs.start.resize(0);
    grid = g;
    ghost_plan.reset();
    busy = work = 0, steps = 0;
}

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

/// Divides the domain again if the work since the last time is not balanced.
///
/// The weight of a block is the work of its particles and pairs, times the measured CPU time of its process
/// per work.
void RankEngine::divide_again(const Domain& domain)
{
    constexpr long least_steps = 200;
    constexpr double most = 0.05;
    if (steps < least_steps || own.pairs.start.size() == 0) return;
    all.imbalance.measured = all.reduced_for_all(Spread(busy)).imbalance(all.size());
    const double rate = work > 0 ? busy / work : 0;
    const double imbalance = all.imbalance.measured;
    busy = work = 0, steps = 0;
    if (imbalance <= most) return;

    const CellGrid& g = domain.grid;
    std::vector<BlockWork> blocks;
    for (std::uint32_t k = 0; k < own.particle.count; ++k) {
        if (is_ghost(k)) continue;
        const std::uint32_t cell = own.particle.position.data()[k].cell;
        blocks.push_back({partition.grid().block_of(g.x_of(cell), g.y_of(cell), g.z_of(cell)),
                          static_cast<float>(rate * work_of(k))});
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
    blocks = exchanged(all, std::move(to));
    std::sort(blocks.begin(), blocks.end(),
              [](const BlockWork& a, const BlockWork& b) { return a.block < b.block; });
    merge(blocks);
    const BlockGrid grid = partition.grid();
    partition.make(grid, blocks);
    std::fill(surrounded.begin(), surrounded.end(), static_cast<signed char>(-1));
    // The work that each process has now
    Addressed<BlockWork> next;
    for (const BlockWork& b : blocks) next.emplace_back(partition.owner(b.block), b);
    double own_weight = 0;
    for (const BlockWork& b : exchanged(all, std::move(next))) own_weight += b.weight;
    all.imbalance.predicted = all.reduced_for_all(Spread(own_weight)).imbalance(all.size());
    ++all.imbalance.divisions;
}

void RankEngine::find_neighbours(const Domain& domain)
{
    assign_cells(domain);
    divide_again(domain);
    rebuild(domain);
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

/// Whether all blocks around this one and itself belong to this process
bool RankEngine::is_surrounded(const CellGrid& grid, std::uint32_t block) const
{
    signed char& known = surrounded[block];
    if (known >= 0) return known != 0;
    const BlockGrid& b = partition.grid();
    const auto at = [&](int axis) {
        return static_cast<std::int32_t>(axis == 0   ? block % b.blocks[0]
                                         : axis == 1 ? block / b.blocks[0] % b.blocks[1]
                                                     : block / b.blocks[0] / b.blocks[1]);
    };
    bool all_own = true;
    for (int c = -1; c <= 1; ++c)
        for (int d = -1; d <= 1; ++d)
            for (int e = -1; e <= 1; ++e) {
                std::int32_t i[] = {at(0) + e, at(1) + d, at(2) + c};
                bool exists = true;
                for (int k = 0; k < 3; ++k) {
                    if (grid.periodic[k] != 0) i[k] = (i[k] + b.blocks[k]) % b.blocks[k];
                    exists = exists && i[k] >= 0 && i[k] < b.blocks[k];
                }
                if (exists)
                    all_own = all_own && partition.owner(static_cast<std::uint32_t>(
                                             (i[2] * b.blocks[1] + i[1]) * b.blocks[0] + i[0])) == all.rank();
            }
    known = all_own ? 1 : 0;
    return all_own;
}

/// Exchanges the particles in the cells next to those of other processes.
RankEngine::Ghosts RankEngine::find_ghosts(const CellGrid& g,
                                           const std::vector<ParticleRecord>& particles) const
{
    std::vector<std::pair<int, std::uint32_t>> to;
    std::vector<int> processes;
    for (std::uint32_t k = 0; k < particles.size(); ++k) {
        const std::uint32_t cell = particles[k].position.cell;
        const std::int32_t at[] = {g.x_of(cell), g.y_of(cell), g.z_of(cell)};
        if (is_surrounded(g, partition.grid().block_of(at[0], at[1], at[2]))) continue;
        processes.clear();
        for (int c = -1; c <= 1; ++c)
            for (int d = -1; d <= 1; ++d)
                for (int e = -1; e <= 1; ++e) {
                    std::int32_t i[] = {at[0] + e, at[1] + d, at[2] + c};
                    bool exists = true;
                    for (int a = 0; a < 3; ++a) {
                        if (g.periodic[a] != 0) i[a] = (i[a] + g.cells[a]) % g.cells[a];
                        exists = exists && i[a] >= 0 && i[a] < g.cells[a];
                    }
                    if (!exists) continue;
                    const int owner = partition.owner(partition.grid().block_of(i[0], i[1], i[2]));
                    if (owner != all.rank() &&
                        std::find(processes.begin(), processes.end(), owner) == processes.end())
                        processes.push_back(owner);
                }
        for (const int process : processes) to.emplace_back(process, k);
    }
    std::sort(to.begin(), to.end());
    Ghosts ghosts;
    std::vector<GhostRecord> records;
    for (const auto& [process, k] : to) {
        const ParticleRecord& p = particles[k];
        ghosts.to.push_back(process), ghosts.which.push_back(k);
        records.push_back({p.position, p.velocity, p.omega, p.species, p.id});
    }
    ghosts.records = std::move(records);
    return ghosts;
}

/// Moves the particles to their processes, finds the ghosts, and builds the list.
void RankEngine::rebuild(const Domain& domain)
{
    Particles<par::Cpu>& p = own.particle;
    const CellGrid& g = grid = domain.grid;
    const std::uint32_t before = p.count, *const id = p.id.data();
    // stays[k]: place of particle k in the new list
    std::vector<std::uint32_t> stays(before, none);
    std::vector<ParticleRecord> mine;
    std::vector<int> owner(before, all.rank());
    Addressed<ParticleRecord> leaving;
    mine.reserve(before);
    for (std::uint32_t k = 0; k < before; ++k) {
        if (is_ghost(k)) continue;
        owner[k] = owner_of(g, p.position.data()[k].cell);
        if (owner[k] == all.rank())
            stays[k] = static_cast<std::uint32_t>(mine.size()), mine.push_back(record_of(p, k));
        else
            leaving.emplace_back(owner[k], record_of(p, k));
    }
    Addressed<ContactHistory> leaving_contacts;
    const Pairs<par::Cpu>& pairs = own.pairs;
    for (std::uint32_t n = 0; !leaving.empty() && n < pairs.count; ++n) {
        if (pairs.in_contact.data()[n] == 0) continue;
        const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
        const auto send_to = [&](int process) {
            if (process != all.rank()) leaving_contacts.emplace_back(process, contact_of(pairs, id, n));
        };
        send_to(owner[i]);
        if ((j & PairView::boundary_bit) == 0 && owner[j] != owner[i]) send_to(owner[j]);
    }
    const std::vector<ParticleRecord> arrived = exchanged(all, std::move(leaving));
    const std::vector<ContactHistory> arrived_contacts = exchanged(all, std::move(leaving_contacts));
    Index others;
    for (const ParticleRecord& r : arrived)
        others.add(r.id, static_cast<std::uint32_t>(mine.size())), mine.push_back(r);

    Ghosts ghosts = find_ghosts(g, mine);
    ghost_plan.emplace(all, std::move(ghosts.to));
    const std::vector<GhostRecord> of_others = ghost_plan->exchange(ghosts.records);
    const auto first_ghost = static_cast<std::uint32_t>(mine.size());
    for (const GhostRecord& r : of_others) {
        others.add(r.id, static_cast<std::uint32_t>(mine.size()));
        mine.push_back({.position = r.position,
                        .position_at_build = r.position,
                        .velocity = r.velocity,
                        .omega = r.omega,
                        .species = r.species,
                        .id = r.id});
    }
    others.sort();

    // The contacts that this process had or has received, between particles that it has now
    ContactList list;
    Index all_ids;
    bool has_all = false;
    const auto place_of = [&](std::uint32_t of_id) -> std::uint32_t {
        if (const auto at = others.find(of_id)) return *at;
        if (!has_all) {
            for (std::uint32_t k = 0; k < first_ghost; ++k) all_ids.add(mine[k].id, k);
            all_ids.sort(), has_all = true;
        }
        return all_ids.find(of_id).value_or(none);
    };
    const auto place_before = [&](std::uint32_t k) {
        return stays[k] != none ? stays[k] : others.find(id[k]).value_or(none);
    };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        if (pairs.in_contact.data()[n] == 0) continue;
        const std::uint32_t i = place_before(pairs.i.data()[n]), j = pairs.j.data()[n],
                            new_j = (j & PairView::boundary_bit) != 0 ? j : place_before(j);
        if (i != none && new_j != none) list.add(i, new_j, contact_of(pairs, id, n));
    }
    for (const ContactHistory& c : arrived_contacts) {
        const std::uint32_t i = place_of(c.i), j = (c.j & PairView::boundary_bit) != 0 ? c.j : place_of(c.j);
        if (i != none && j != none) list.add(i, j, c);
    }
    list.put(own.pairs, rotation_laws, internal);

    const auto count = static_cast<std::uint32_t>(mine.size());
    resize(p, count, used);
    p.ghost.resize(count);
    for (std::uint32_t k = 0; k < count; ++k)
        set_record(p, k, mine[k]), p.ghost.data()[k] = k < first_ghost ? 0 : 1;
    mine = {};

    Busy measures(busy);
    EngineOn::find_neighbours(domain);
    const std::uint32_t* const now = neighbours.new_indices();
    sent.clear(), received.clear();
    for (const std::uint32_t k : ghosts.which) sent.push_back(now[k]);
    for (std::uint32_t k = first_ghost; k < count; ++k) received.push_back(now[k]);
    to_send.resize(sent.size()), to_receive.resize(received.size());
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

void RankEngine::find_loads(const Domain& domain, float h, bool store, double path)
{
    Busy measures(busy);
    EngineOn::find_loads(domain, h, store, path);
}

float RankEngine::advance(const StepParameters& step)
{
    StepExtremes extremes;
    {
        Busy measures(busy);
        extremes.speed.value = EngineOn::advance(step);
        extremes.overlap.value = watched ? EngineOn::take_largest_overlap() : 0;
    }
    if (step.part != Part::only_loads) send_ghosts();
    if (step.part != Part::before_loads) {
        work += own.pairs.count + 4. * own.particle.count;
        ++steps;
    }
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

namespace {

/// The particles of a process with their rows of the neighbour list
struct Rows {
    std::vector<ParticleRecord> particles;
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint32_t> j;  ///< id, or surface with PairView::boundary_bit
    std::vector<std::uint8_t> law, in_contact;
    std::vector<Float4> history, rotation, internal;
};

/// Sorts contacts by their particles i.
void sort_by_i(Pairs<par::Cpu>& pairs)
{
    std::vector<std::uint32_t> order(pairs.count);
    for (std::uint32_t n = 0; n < pairs.count; ++n) order[n] = n;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return pairs.i.data()[a] < pairs.i.data()[b]; });
    const auto permute = [&](auto& array) {
        std::remove_reference_t<decltype(array)> sorted(array.size());
        for (std::uint32_t n = 0; n < array.size(); ++n) sorted.data()[n] = array.data()[order[n]];
        array = std::move(sorted);
    };
    permute(pairs.i), permute(pairs.j), permute(pairs.history), permute(pairs.rotation_history);
    permute(pairs.internal);
}

}  // namespace

void RankEngine::gather(Arrays<par::Cpu>* whole)
{
    Rows rows;
    const Pairs<par::Cpu>& q = own.pairs;
    const std::uint32_t *const id = own.particle.id.data(), *start = q.start.data();
    std::vector<std::uint32_t> of_contacts;
    if (q.start.size() == 0) {  // before the first search: the contacts, in the order of their particles i
        sort_by_i(own.pairs);
        for (std::uint32_t k = 0, n = 0; k <= own.particle.count; ++k) {
            while (n < q.count && q.i.data()[n] < k) ++n;
            of_contacts.push_back(n);
        }
        start = of_contacts.data();
    }
    for (std::uint32_t k = 0; k < own.particle.count; ++k) {
        if (is_ghost(k)) continue;
        rows.particles.push_back(record_of(own.particle, k));
        const std::uint32_t begin = start[k], end = start[k + 1];
        rows.lengths.push_back(end - begin);
        for (std::uint32_t n = begin; n < end; ++n) {
            const std::uint32_t j = q.j.data()[n];
            rows.j.push_back((j & PairView::boundary_bit) != 0 ? j : id[j]);
        }
        const auto append = [&](auto& to, const auto& from, bool has) {
            if (has) to.insert(to.end(), from.data() + begin, from.data() + end);
        };
        append(rows.law, q.law, !one_law && q.start.size() > 0), append(rows.in_contact, q.in_contact, true);
        append(rows.history, q.history, true), append(rows.rotation, q.rotation_history, rotation_laws);
        append(rows.internal, q.internal, internal);
    }
    if (!all.is_first()) {
        all.send_to_first(rows.particles), all.send_to_first(rows.lengths), all.send_to_first(rows.j);
        all.send_to_first(rows.law), all.send_to_first(rows.in_contact), all.send_to_first(rows.history);
        all.send_to_first(rows.rotation), all.send_to_first(rows.internal);
        return;
    }

    std::vector<Rows> of(static_cast<std::size_t>(all.size()));
    of[0] = std::move(rows);
    for (int from = 1; from < all.size(); ++from) {
        Rows& r = of[static_cast<std::size_t>(from)];
        r.particles = all.received<ParticleRecord>(from), r.lengths = all.received<std::uint32_t>(from);
        r.j = all.received<std::uint32_t>(from), r.law = all.received<std::uint8_t>(from);
        r.in_contact = all.received<std::uint8_t>(from), r.history = all.received<Float4>(from);
        r.rotation = all.received<Float4>(from), r.internal = all.received<Float4>(from);
    }
    // The order of a single process: that of the cells of the last search, then of the ids
    struct Place {
        std::uint64_t key;
        std::uint32_t id, process, number, begin;  ///< begin: first pair of its row in the lists
        bool operator<(const Place& o) const { return std::pair(key, id) < std::pair(o.key, o.id); }
    };
    std::vector<Place> places;
    std::uint32_t largest_id = 0;
    std::size_t pairs = 0;
    for (std::uint32_t from = 0; from < of.size(); ++from) {
        const auto begin = static_cast<std::ptrdiff_t>(places.size());
        std::uint32_t first_pair = 0;
        for (std::uint32_t k = 0; k < of[from].particles.size(); ++k) {
            const ParticleRecord& r = of[from].particles[k];
            places.push_back(
                {key_of(grid, r.position_at_build.cell, r.species.replica), r.id, from, k, first_pair});
            first_pair += of[from].lengths[k];
            largest_id = std::max(largest_id, r.id);
        }
        pairs += first_pair;
        std::inplace_merge(places.begin(), places.begin() + begin, places.end());
    }
    std::vector<std::uint32_t> index(places.empty() ? 0 : std::size_t{largest_id} + 1, none);
    Particles<par::Cpu>& p = whole->particle;
    Pairs<par::Cpu>& to = whole->pairs;
    const auto n = static_cast<std::uint32_t>(places.size());
    resize(p, n, used);
    to.count = static_cast<std::uint32_t>(pairs);
    to.start.resize(n + std::size_t{1}), to.i.resize(pairs), to.j.resize(pairs);
    to.law.resize(one_law ? 0 : pairs), to.in_contact.resize(pairs), to.history.resize(pairs);
    to.rotation_history.resize(rotation_laws ? pairs : 0), to.internal.resize(internal ? pairs : 0);
    for (std::uint32_t k = 0; k < n; ++k) {
        index[places[k].id] = k;
        set_record(p, k, of[places[k].process].particles[places[k].number]);
    }
    std::uint32_t pair = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
        const Rows& r = of[places[k].process];
        to.start.data()[k] = pair;
        const std::uint32_t begin = places[k].begin, end = begin + r.lengths[places[k].number];
        for (std::uint32_t from = begin; from < end; ++from, ++pair) {
            const std::uint32_t j = r.j[from];
            to.i.data()[pair] = k;
            to.j.data()[pair] = (j & PairView::boundary_bit) != 0 ? j : index[j];
            if (!one_law) to.law.data()[pair] = from < r.law.size() ? r.law[from] : std::uint8_t{0};
            to.in_contact.data()[pair] = r.in_contact[from], to.history.data()[pair] = r.history[from];
            if (rotation_laws) to.rotation_history.data()[pair] = r.rotation[from];
            if (internal) to.internal.data()[pair] = r.internal[from];
        }
    }
    to.start.data()[n] = pair;
}

}  // namespace hilda::granular
