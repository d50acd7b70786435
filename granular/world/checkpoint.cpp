// SPDX-License-Identifier: GPL-3.0-or-later
// Serialisation of a world between two steps.
//
// A checkpoint does not contain the neighbour list, but the positions for which it was built: the search with
// these positions gives the same list in the same order. A restored world therefore continues with the list
// of the saved world, and a checkpoint has no influence on the results, wherever it is taken.
#include "granular/world/world_impl.hpp"
#include "io/archive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <tuple>
#include <utility>

namespace hilda::granular {

namespace {

constexpr io::Archive::Format format = {.letters = "HILDAGRN", .version = 11};

bool finite(const Float4& a) { return std::isfinite(a.x + a.y + a.z + a.w); }
template <class Array>
bool all_finite(const Array& list)
{
    return std::all_of(list.data(), list.data() + list.size(), [](const auto& a) { return finite(a); });
}

/// The domain is one that World can have: the neighbour search uses it as an index range.
bool valid(const Domain& d, const WorldOptions& options)
{
    const double low[] = {options.low.x, options.low.y, options.low.z};
    const std::int32_t y = d.grid.shift_y, z = d.grid.shift_z;
    if (!(y >= 0 && y <= z && z < CellGrid::cell_bits)) return false;
    const std::int64_t most[] = {std::int64_t{1} << y, std::int64_t{1} << (z - y),
                                 std::int64_t{1} << (CellGrid::cell_bits - z)};
    double cells = d.replicas;
    for (int k = 0; k < 3; ++k) {
        cells *= d.grid.cells[k];
        if (d.grid.low[k] != low[k] || d.grid.cells[k] < 1 || d.grid.cells[k] > most[k] ||
            d.grid.width[k] < 1 || d.grid.width[k] > CellGrid::widest || d.grid.last[k] < 0 ||
            d.grid.last[k] > d.grid.width[k] || d.grid.periodic[k] != (options.periodic[k] ? 1 : 0))
            return false;
    }
    if (cells > max_cells) return false;
    const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
    return positive(d.grid.unit) && positive(d.skin) && std::isfinite(d.radius) && d.radius >= 0 &&
           positive(d.small) && positive(d.largest) && d.replicas >= 1 && d.replicas <= 1 << 16;
}

bool valid(const WatchRecord& w)
{
    static_assert(sizeof w % sizeof(double) == 0);
    constexpr std::size_t integers = 4, numbers = sizeof w / sizeof(double) - integers;
    static_assert(offsetof(WatchRecord, kinetic) == integers * sizeof(double));
    double all[numbers];
    std::memcpy(all, reinterpret_cast<const char*>(&w) + integers * sizeof(double), sizeof all);
    return w.samples >= 0 &&
           std::all_of(std::begin(all), std::end(all), [](double x) { return std::isfinite(x); });
}

bool valid_removed(const RemovedParticle& p)
{
    return finite(p.r) && finite(p.v) && finite(p.omega) && std::isfinite(p.t + p.radius + p.mass) &&
           p.side < 6;
}

/// Ordered by ids below `ids`, with finite places and known boundaries
bool valid_attached(const std::vector<AttachedParticle>& all, std::uint32_t ids, std::size_t boundaries)
{
    const auto not_before = [](const AttachedParticle& a, const AttachedParticle& b) { return a.id >= b.id; };
    return std::adjacent_find(all.begin(), all.end(), not_before) == all.end() &&
           std::all_of(all.begin(), all.end(), [&](const AttachedParticle& a) {
               return a.id < ids && a.boundary < boundaries && finite(a.X);
           });
}

/// All members are equal except those that change during a run: r, axis, v, omega and F, which are finite.
bool same_boundary(const Boundary& now, Boundary saved)
{
    for (const Vec3& v : {saved.r, saved.axis, saved.v, saved.omega, saved.F})
        if (!finite(v)) return false;
    saved.r = now.r, saved.axis = now.axis, saved.v = now.v, saved.omega = now.omega, saved.F = now.F;
    // There is no padding, and -0 or NaN in place of a number is another boundary.
    return std::memcmp(&now, &saved, sizeof saved) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

/// The cell exists, and the particle is less than two cell widths away from its low corner: it was inside
/// when the neighbour list was built, and has moved by less than a cell since then.
bool inside(const CellGrid& g, const Position& p)
{
    const std::int32_t x = g.x_of(p.cell), y = g.y_of(p.cell), z = g.z_of(p.cell);
    const auto near = [](std::int32_t at) { return at >= -CellGrid::widest && at < 2 * CellGrid::widest; };
    return x < g.cells[0] && y < g.cells[1] && z < g.cells[2] && near(g.local(p.x, x, 0)) &&
           near(g.local(p.y, y, 1)) && near(g.local(p.z, z, 2));
}

/// The n ids are below `limit`, and all differ.
bool valid_ids(const std::uint32_t* id, std::size_t n, std::uint32_t limit)
{
    std::vector<std::uint32_t> sorted(id, id + n);
    std::sort(sorted.begin(), sorted.end());
    return (n == 0 || sorted.back() < limit) &&
           std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

/// Writes the elements of a pair array that belong to contacts, as Archive::list. Only they have a history.
template <class T>
void write_contacts(io::Archive& a, const Pairs<par::Cpu>& pairs, std::size_t contacts,
                    par::Array<par::Cpu, T>& values)
{
    a.count(contacts, sizeof(T));
    for (std::uint32_t k = 0; contacts > 0 && k < pairs.count; ++k)
        if (pairs.in_contact.data()[k] != 0) a.value(values.data()[k]);
}

void write_pairs(io::Archive& a, Pairs<par::Cpu>& pairs)
{
    const std::size_t n =
        pairs.count - std::count(pairs.in_contact.data(), pairs.in_contact.data() + pairs.count, 0);
    write_contacts(a, pairs, n, pairs.i), write_contacts(a, pairs, n, pairs.j);
    write_contacts(a, pairs, n, pairs.history);
    write_contacts(a, pairs, pairs.rotation_history.size() > 0 ? n : 0, pairs.rotation_history);
    write_contacts(a, pairs, pairs.internal.size() > 0 ? n : 0, pairs.internal);
}

void read_pairs(io::Archive& a, Pairs<par::Cpu>& pairs, std::size_t particles, std::size_t boundaries)
{
    const std::size_t n = a.list(pairs.i);
    a.check(a.list(pairs.j) == n && a.list(pairs.history) == n, "wrong number of pairs");
    const std::size_t rotation = a.list(pairs.rotation_history), internal = a.list(pairs.internal);
    a.check((rotation == 0 || rotation == n) && (internal == 0 || internal == n), "wrong number of pairs");
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t j = pairs.j.data()[k];
        const bool valid_j =
            (j & PairView::boundary_bit) != 0 ? (j & ~PairView::boundary_bit) < boundaries : j < particles;
        a.check(pairs.i.data()[k] < particles && valid_j, "unknown particle of a pair");
    }
    a.check(all_finite(pairs.history) && all_finite(pairs.rotation_history) && all_finite(pairs.internal),
            "a history that is not finite");
    // the pairs of a list before a neighbour search
    pairs.count = static_cast<std::uint32_t>(n);
    pairs.in_contact.resize(n);
    par::fill(par::Cpu(), pairs.in_contact.data(), n, std::uint8_t{1});
}

}  // namespace

/// Position of a particle when the neighbour list was built, see Position. Its owner cell is still the same.
struct World::PlaceAtBuild {
    std::int32_t x, y, z;
};

void World::transfer(io::Archive& a)
{
    a.value(step_count), a.value(rebuild_count), a.value(max_speed), a.value(domain);
    a.check(step_count >= 0 && std::isfinite(max_speed) && valid(domain, options), "invalid domain or time");
    a.value(record), a.value(unsampled_overlap), a.list(moved);
    a.check(valid(record) && std::isfinite(unsampled_overlap), "a number of the watch that is not finite");
    a.value(next_id), a.value(total_outflow), a.list(removed_particles);
    a.check(total_outflow.count >= 0 && std::isfinite(total_outflow.mass) &&
                std::all_of(removed_particles.begin(), removed_particles.end(), valid_removed),
            "an invalid record of a removed particle");
    std::vector<Boundary> now = boundaries;
    a.list(boundaries), a.list(forces);
    a.check(std::equal(now.begin(), now.end(), boundaries.begin(), boundaries.end(), same_boundary),
            "other boundaries than in this world");
    a.check(moved.empty() || moved.size() == boundaries.size(), "wrong number of boundaries");
    if (a.reads()) {
        moved_to.clear();
        if (!moved.empty())
            for (const Boundary& b : boundaries) moved_to.push_back({b.r, b.axis});
    }
    transfer_particles(a);
    Particles<par::Cpu>& p = engine->arrays().particle;
    std::size_t n = p.count;
    a.value(particle_displacement), a.value(boundary_displacement), a.list(boundaries_at_build);
    a.check(particle_displacement >= 0 && boundary_displacement >= 0, "an invalid displacement");
    const bool has_list = std::isfinite(particle_displacement);
    a.check(!has_list || boundaries_at_build.size() == boundaries.size(), "wrong number of boundaries");
    for (const BoundaryPlace& b : boundaries_at_build)
        a.check(finite(b.r) && finite(b.axis), "a boundary that is not finite");
    n = has_list ? n : 0;
    a.count(n, sizeof(PlaceAtBuild));
    if (!a.reads()) {
        for (std::size_t k = 0; k < n; ++k) {
            const Position& at = p.position_at_build.data()[k];
            PlaceAtBuild place{at.x, at.y, at.z};
            a.value(place);
        }
        return write_pairs(a, engine->arrays().pairs);
    }
    a.check(n == (has_list ? p.count : 0), "wrong number of particles");
    std::vector<PlaceAtBuild> at_build(n);
    for (std::size_t k = 0; k < n; ++k) {
        PlaceAtBuild& place = at_build[k];
        a.value(place);
        a.check(inside(domain.grid, {p.position.data()[k].cell, place.x, place.y, place.z}),
                "invalid position of a particle");
    }
    read_pairs(a, engine->arrays().pairs, p.count, boundaries.size());
    if (has_list)
        restore_neighbours(a.name(), std::move(at_build));
    else
        engine->arrays_modified();
    if (posed.empty())
        attached_changed = !attached.empty();
    else
        set_attached();
}

void World::transfer_particles(io::Archive& a)
{
    Particles<par::Cpu>& p = engine->arrays().particle;
    std::size_t n = p.count;
    const auto list = [&](auto& values) { a.check(a.list(values, n) == n, "wrong number of particles"); };
    /// An array that only some schemes use
    const auto list_if = [&](bool used, auto& values) {
        a.check(a.list(values) == (used ? n : 0) && all_finite(values), "an array of another integrator");
    };
    n = a.list(p.position, n);
    list(p.velocity), list(p.omega), list(p.compensation), list(p.species), list(p.id);
    if (attached_changed) posed.clear();
    a.list(attached), a.list(rotations), a.list(posed);
    a.check(valid_attached(attached, next_id, boundaries.size()) &&
                (rotations.empty() ? attached.empty() : rotations.size() == boundaries.size()),
            "an invalid attached particle");
    const auto is_rotation = [](const EulerParameters<double>& e) {
        return std::abs(e.e0 * e.e0 + e.e.dot(e.e) - 1) < 1e-6;
    };
    a.check(std::all_of(rotations.begin(), rotations.end(), is_rotation) &&
                (posed.empty() || (!attached.empty() && posed.size() == boundaries.size())) &&
                std::all_of(posed.begin(), posed.end(),
                            [&](const BoundaryPose& b) {
                                return finite(b.r) && finite(b.v) && finite(b.omega) && is_rotation(b.p);
                            }),
            "an invalid pose of a boundary");
    const bool previous = detail::uses_previous_acceleration(options.scheme);
    list_if(previous, p.acc), list_if(previous, p.alpha);
    const std::size_t oriented = a.list(p.orientation);
    if (a.list(p.orientation_compensation) != oriented || oriented != (options.orientation ? n : 0))
        throw io::IoError(a.name() + ": the checkpoint " + (options.orientation ? "has no" : "has") +
                          " orientations, but /orientation of this case is " +
                          (options.orientation ? "true" : "false"));
    if (!a.reads()) return;
    for (std::size_t k = 0; k < n; ++k)
        a.check(inside(domain.grid, p.position.data()[k]) &&
                    p.species.data()[k].material < materials.size() &&
                    p.species.data()[k].replica < domain.replicas && p.velocity.data()[k].w > 0,
                "invalid position, material or radius of a particle");
    a.check(next_id >= n && next_id - n == static_cast<std::uint64_t>(total_outflow.count) &&
                valid_ids(p.id.data(), n, next_id),
            "invalid ids of the particles");
    a.check(forces.empty() || forces.size() == next_id, "wrong number of forces");
    a.check(all_finite(p.velocity) && all_finite(p.omega) && all_finite(p.orientation) && all_finite(forces),
            "a velocity or force that is not finite");
    p.count = static_cast<std::uint32_t>(n);
    inserted_count = n;
}

/// Builds the neighbour list of the saved world, with the positions for which it was built. Throws
/// io::IoError.
void World::restore_neighbours(const std::string& file, std::vector<PlaceAtBuild> at_build)
{
    const std::vector<Boundary> now = boundaries;
    for (std::size_t k = 0; k < boundaries.size(); ++k)
        boundaries[k].r = boundaries_at_build[k].r, boundaries[k].axis = boundaries_at_build[k].axis;
    const auto exchange = [&] {
        Position* const position = engine->arrays().particle.position.data();
        for (std::size_t k = 0; k < at_build.size(); ++k) {
            Position& p = position[k];
            const PlaceAtBuild place = std::exchange(at_build[k], {p.x, p.y, p.z});
            p.x = place.x, p.y = place.y, p.z = place.z;
        }
        engine->arrays_modified();
    };
    // The search must not change the order of the particles.
    const auto order = [&] {
        const Particles<par::Cpu>& p = engine->arrays().particle;
        std::uint64_t sum = 0;
        for (std::size_t k = 0; k < at_build.size(); ++k) {
            const std::uint32_t words[] = {p.id.data()[k], p.position.data()[k].cell};
            sum = io::checksum(sum, reinterpret_cast<const char*>(words), sizeof words);
        }
        return sum;
    };
    const std::uint64_t saved = order();
    const auto displacements = std::pair(particle_displacement, boundary_displacement);
    const long rebuilds = rebuild_count;
    exchange();
    try {
        find_neighbours();
    } catch (const LeftDomain&) {
        throw io::IoError(file + ": the checkpoint is damaged: a particle outside the domain");
    } catch (const io::InvalidInput& e) {
        throw io::IoError(file + ": the checkpoint is damaged: " + e.what());
    }
    if (order() != saved) throw io::IoError(file + ": the checkpoint is damaged: the order of the particles");
    exchange();
    boundaries = now;
    std::tie(particle_displacement, boundary_displacement) = displacements;
    rebuild_count = rebuilds;
}

std::string World::to_bytes(const std::string& run_id, const std::function<void(io::Archive&)>& more)
{
    std::string bytes;
    write(
        run_id, [&](std::string_view piece) { bytes += piece; }, more);
    return bytes;
}

void World::write(const std::string& run_id, const std::function<void(std::string_view)>& append,
                  const std::function<void(io::Archive&)>& more)
{
    insert_pending();
    unsampled_overlap = larger(unsampled_overlap, engine->take_largest_overlap());
    io::Archive::write(
        format,
        [&](io::Archive& a) {
            std::string run = run_id;
            a.list(run);
            transfer(a);
            more(a);
        },
        append);
}

void World::from_bytes(const std::string& bytes, const std::string& run_id, const std::string& file,
                       const std::function<void(io::Archive&)>& more)
{
    io::Archive a(format, bytes, file);
    std::string run;
    a.list(run);
    if (run != run_id) throw io::IoError(file + ": the checkpoint belongs to another run");
    insert_pending();
    transfer(a);
    more(a);
    a.end();
    forces_changed = boundaries_changed = true;
    time = static_cast<double>(step_count) * options.h;
}

}  // namespace hilda::granular
