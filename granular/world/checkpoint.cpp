// SPDX-License-Identifier: GPL-3.0-or-later
// Serialisation of a world between two steps.
//
// A checkpoint does not contain the neighbour list, but the positions for which it was built: the search with
// these positions gives the same list in the same order. A restored world therefore continues with the list
// of the saved world, and a checkpoint has no influence on the results, wherever it is taken.
#include "granular/world/value_text.hpp"
#include "granular/world/world_impl.hpp"
#include "io/archive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <tuple>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

using detail::shown;  // with the overloads of this file

constexpr io::Archive::Format format = {.letters = "HILDAGRN", .version = 16};

/// Refuses the first element of the list that was read last which is not finite.
template <class Array>
void check_vectors(const io::Archive& a, const Array& list, const char* what)
{
    a.check_each(
        list, std::string(what) + " must be finite", [](const Float4& x) { return finite(x); },
        [](const Float4& x) { return shown(x); });
}

/// "" if the domain is one that World can have: the neighbour search uses it as an index range. Otherwise the
/// member that it cannot have, and its value.
std::string fault(const Domain& d, const WorldOptions& options)
{
    const double low[] = {options.low.x, options.low.y, options.low.z};
    const auto is = [](const std::string& name, double value) { return name + ", got " + shown(value); };
    const std::int32_t y = d.grid.shift_y, z = d.grid.shift_z;
    if (!(y >= 0 && y < CellGrid::cell_bits)) return is("invalid bits of the cells along x", y);
    if (!(z >= y && z < CellGrid::cell_bits)) return is("invalid bits of the cells along y", z);
    const std::int64_t most[] = {std::int64_t{1} << y, std::int64_t{1} << (z - y),
                                 std::int64_t{1} << (CellGrid::cell_bits - z)};
    double cells = d.replicas;
    for (int k = 0; k < 3; ++k) {
        const std::string along = std::string(" along ") + "xyz"[k];
        cells *= d.grid.cells[k];
        if (d.grid.low[k] != low[k]) return is("another low corner" + along, d.grid.low[k]);
        if (d.grid.cells[k] < 1 || d.grid.cells[k] > most[k])
            return is("invalid number of cells" + along, d.grid.cells[k]);
        if (d.grid.width[k] < 1 || d.grid.width[k] > CellGrid::widest)
            return is("invalid width of the cells" + along, d.grid.width[k]);
        if (d.grid.last[k] < 0 || d.grid.last[k] > d.grid.width[k])
            return is("invalid width of the last cell" + along, d.grid.last[k]);
        if (d.grid.periodic[k] != (options.periodic[k] ? 1 : 0))
            return is("another periodicity" + along, d.grid.periodic[k]);
    }
    if (cells > max_cells) return is("too many cells", cells);
    const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
    if (!positive(d.grid.unit)) return is("the unit of length must be positive", d.grid.unit);
    if (!positive(d.skin)) return is("the skin must be positive", d.skin);
    if (!positive(d.largest)) return is("invalid largest radius", d.largest);
    // what World::domain_of() computes, up to rounding errors
    constexpr double round_up = 1 + 1e-5;
    const double size[] = {options.high.x - options.low.x, options.high.y - options.low.y,
                           options.high.z - options.low.z};
    for (int k = 0; k < 3; ++k) {
        const double units = double(d.grid.width[k]) * (d.grid.cells[k] - 1) + d.grid.last[k];
        // The width of each cell is rounded to a unit.
        if (!(std::abs(units - size[k] / d.grid.unit) <= 1 + 0.5 * d.grid.cells[k]))
            return is(std::string("the cells must be as wide as the domain along ") + "xyz"[k],
                      units * d.grid.unit);
        if (!(2. * d.small + d.skin <= round_up * d.grid.width[k] * d.grid.unit))
            return is("the cells are too narrow for small particles of the radius", d.small);
    }
    if (!(2. * d.largest + d.skin <= round_up * CellGrid::widest * d.grid.unit))
        return is("the unit of length is too small for the largest radius", d.largest);
    if (!(d.radius >= 0 && d.radius <= d.largest)) return is("invalid common radius", d.radius);
    if (!(d.small > 0 && d.small <= round_up * d.largest))
        return is("invalid radius of small particles", d.small);
    if (d.replicas < 1 || d.replicas > 1 << 16) return is("invalid number of replicas", d.replicas);
    return "";
}

/// The numbers of a removed particle that are used; one that is not finite, or its side, makes it invalid.
bool valid_removed(const RemovedParticle& p)
{
    return finite(p.r) && finite(p.v) && finite(p.omega) && std::isfinite(p.t) && std::isfinite(p.radius) &&
           std::isfinite(p.mass) && p.side <= RemovedParticle::none;
}
std::string shown(const RemovedParticle& p)
{
    return "t " + shown(p.t) + ", r " + shown(p.r) + ", v " + shown(p.v) + ", omega " + shown(p.omega) +
           ", side " + std::to_string(p.side);
}

/// The numbers of a place are finite, and its axis and Euler parameters have the length 1.
template <class Place>
bool valid_place(const Place& b)
{
    return finite(b.r) && std::abs(b.axis.norm() - 1) < 1e-6 &&
           std::abs(b.p.e0 * b.p.e0 + b.p.e.dot(b.p.e) - 1) < 1e-6;
}

bool valid_compensation(const Compensation& c)
{
    return finite(to_double(load_bfloat16(c.v))) && finite(to_double(load_bfloat16(c.omega)));
}
std::string shown(const Compensation& c)
{
    return shown(to_double(load_bfloat16(c.v))) + ", " + shown(to_double(load_bfloat16(c.omega)));
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

/// All members are equal except those that change during a run: r, axis, p, v, omega, F and T, which are
/// finite.
bool same_boundary(const Boundary& now, Boundary saved)
{
    for (const Vec3& v : {saved.r, saved.axis, saved.v, saved.omega, saved.F, saved.T})
        if (!finite(v)) return false;
    saved.r = now.r, saved.axis = now.axis, saved.p = now.p, saved.v = now.v, saved.omega = now.omega,
    saved.F = now.F, saved.T = now.T;
    // There is no padding, and -0 or NaN in place of a number is another boundary.
    return std::memcmp(&now, &saved, sizeof saved) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

/// Of the triangles of a mesh and their vertices
std::uint64_t checksum(const Meshes& meshes, const Meshes::Part& part)
{
    std::uint64_t sum = 0;
    const auto add = [&](const auto& list, std::uint32_t first, std::uint32_t end) {
        sum = io::checksum(sum, reinterpret_cast<const char*>(list.data() + first),
                           (end - first) * sizeof list[0]);
    };
    add(meshes.vertex, part.first_vertex, part.end_vertex), add(meshes.triangle, part.first, part.end);
    return sum;
}

/// The members of a boundary that are invalid or differ from those of the case
std::string changes(const Boundary& now, const Boundary& saved)
{
    std::string all;
    const auto add = [&](const char* name, const std::string& value) {
        all += (all.empty() ? "" : ", ") + std::string(name) + ' ' + value;
    };
    for (const auto& [name, v] :
         {std::pair{"r", saved.r}, {"v", saved.v}, {"omega", saved.omega}, {"F", saved.F}, {"T", saved.T}})
        if (!finite(v)) add(name, shown(v));
    if (!(std::abs(saved.axis.norm() - 1) < 1e-6)) add("axis", shown(saved.axis));
    const double p2 = saved.p.e0 * saved.p.e0 + saved.p.e.dot(saved.p.e);
    if (!(std::abs(p2 - 1) < 1e-6)) add("square of the Euler parameters", shown(p2));
    for (const auto& [name, before, after] :
         {std::tuple{"radius", now.radius, saved.radius},
          {"mass", now.mass, saved.mass},
          {"moment of inertia xx", now.inertia.xx, saved.inertia.xx},
          {"moment of inertia yy", now.inertia.yy, saved.inertia.yy},
          {"moment of inertia zz", now.inertia.zz, saved.inertia.zz},
          {"second radius", now.second_radius, saved.second_radius},
          {"lower end", now.from, saved.from},
          {"upper end", now.to, saved.to},
          {"flags", double(now.flags), double(saved.flags)},
          {"body", double(now.body), double(saved.body)},
          {"cosine", now.cosine, saved.cosine},
          {"sine", now.sine, saved.sine},
          {"material", double(now.material), double(saved.material)},
          {"shape", double(static_cast<int>(now.shape)), double(static_cast<int>(saved.shape))},
          {"inside", double(now.inside), double(saved.inside)}})
        if (!(before == after)) add(name, shown(after));
    return all.empty() ? "other bytes" : all;
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

void read_pairs(io::Archive& a, Pairs<par::Cpu>& pairs, std::size_t particles, std::size_t boundaries,
                std::size_t triangles)
{
    const auto valid_surface = [&](std::uint32_t k) {
        return Surfaces::is_triangle(k) ? k - Surfaces::first_triangle < triangles : k < boundaries;
    };
    const std::size_t n = a.list(pairs.i);
    const auto list = [&](auto& values, bool optional) {
        const std::size_t got = a.list(values);
        a.check(got == n || (optional && got == 0), "wrong number of pairs, got " + std::to_string(got));
    };
    list(pairs.j, false), list(pairs.history, false);
    check_vectors(a, pairs.history, "a history");
    list(pairs.rotation_history, true);
    check_vectors(a, pairs.rotation_history, "a history");
    list(pairs.internal, true);
    check_vectors(a, pairs.internal, "a history");
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t j = pairs.j.data()[k];
        const bool valid_j =
            (j & PairView::boundary_bit) != 0 ? valid_surface(j & ~PairView::boundary_bit) : j < particles;
        if (!(pairs.i.data()[k] < particles && valid_j))
            a.check(false, "unknown particle of a pair, got " + std::to_string(pairs.i.data()[k]) + " and " +
                               std::to_string(j));
    }
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
    constexpr long most_steps = 9'000'000'000'000'000;
    a.value(step_count);
    a.check(step_count >= 0 && step_count <= most_steps,
            "invalid number of steps, got " + std::to_string(step_count));
    a.value(rebuild_count), a.value(max_speed);
    a.check(std::isfinite(max_speed) && max_speed >= 0, "invalid largest speed, got " + shown(max_speed));
    a.value(domain);
    if (a.reads()) has_domain = domain.largest > 0;
    if (const std::string found = a.reads() ? fault(domain, options) : ""; !found.empty())
        a.check(false, found);
    a.value(record);
    a.check(
        record.samples >= 0 && not_finite(record) == 0,
        "a number of the watch must be finite, got " +
            (record.samples < 0 ? std::to_string(record.samples) + " samples" : shown(not_finite(record))));
    a.value(unsampled_overlap);
    a.check(std::isfinite(unsampled_overlap), "an overlap must be finite, got " + shown(unsampled_overlap));
    a.list(moved);
    a.check_each(
        moved, "velocities of a boundary must be finite",
        [](const BoundaryVelocity& b) { return finite(b.v) && finite(b.omega); },
        [](const BoundaryVelocity& b) { return shown(b.v) + ", " + shown(b.omega); });
    a.check(moved.empty() || moved.size() == boundaries.size(),
            "wrong number of boundaries, got " + std::to_string(moved.size()));
    a.value(next_id), a.value(total_outflow);
    a.check(total_outflow.count >= 0 && std::isfinite(total_outflow.mass),
            "invalid outflow, got " + std::to_string(total_outflow.count) + " particles of " +
                shown(total_outflow.mass) + " kg");
    a.list(removed_particles);
    a.check_each(removed_particles, "invalid record of a removed particle", valid_removed,
                 [](const RemovedParticle& p) { return shown(p); });
    std::vector<std::uint64_t> sums;  // of the meshes
    for (const Meshes::Part& part : meshes->part) sums.push_back(checksum(*meshes, part));
    const std::vector<std::uint64_t> sums_now = sums;
    a.list(sums);
    a.check(sums.size() == sums_now.size(), "wrong number of meshes, it must be " +
                                                std::to_string(sums_now.size()) + ", got " +
                                                std::to_string(sums.size()));
    for (std::size_t k = 0; k < sums.size(); ++k)
        if (const std::uint32_t b = meshes->part[k].boundary; sums[k] != sums_now[k])
            throw MeshChanged(a.name(), b, "of boundary " + std::to_string(b));
    std::vector<Boundary> now = boundaries;
    a.list(boundaries);
    a.check(now.size() == boundaries.size(),
            "other boundaries than in this world, got " + std::to_string(boundaries.size()));
    const auto counterpart = [&](const Boundary& b) {
        return now[static_cast<std::size_t>(&b - boundaries.data())];
    };
    a.check_each(
        boundaries, "a boundary must be that of the case, with a finite place, velocity and load",
        [&](const Boundary& b) { return same_boundary(counterpart(b), b) && valid_place(b); },
        [&](const Boundary& b) { return changes(counterpart(b), b); });
    a.list(tool_loads);
    a.check(tool_loads.empty() || tool_loads.size() == boundaries.size(),
            "wrong number of loads of boundaries, got " + std::to_string(tool_loads.size()));
    a.check_each(
        tool_loads, "invalid load of a boundary", [](const Wrench& w) { return finite(w.F) && finite(w.T); },
        [](const Wrench& w) { return shown(w.F) + ", " + shown(w.T); });
    a.list(forces);
    check_vectors(a, forces, "a force");
    a.check(forces.empty() || forces.size() == next_id,
            "wrong number of forces, got " + std::to_string(forces.size()));
    if (a.reads()) {
        moved_to.clear();
        if (!moved.empty())
            for (const Boundary& b : boundaries) moved_to.emplace_back(b);
    }
    transfer_particles(a);
    Particles<par::Cpu>& p = engine->arrays().particle;
    std::size_t n = p.count;
    a.value(particle_displacement), a.value(boundary_displacement);
    a.check(particle_displacement >= 0 && boundary_displacement >= 0,
            "invalid displacements, got " + shown(particle_displacement) + " and " +
                shown(boundary_displacement));
    a.list(boundaries_at_build);
    const bool has_list = std::isfinite(particle_displacement);
    a.check(!has_list || boundaries_at_build.size() == boundaries.size(),
            "wrong number of boundaries, got " + std::to_string(boundaries_at_build.size()));
    a.check_each(
        boundaries_at_build, "invalid place of a boundary",
        [](const BoundaryPlace& b) { return valid_place(b); },
        [](const BoundaryPlace& b) { return "r " + shown(b.r) + ", axis " + shown(b.axis); });
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
    a.check(n == (has_list ? p.count : 0), "wrong number of particles, got " + std::to_string(n));
    std::vector<PlaceAtBuild> at_build(n);
    for (std::size_t k = 0; k < n; ++k) {
        PlaceAtBuild& place = at_build[k];
        a.value(place);
        if (!is_near_domain(domain.grid, {p.position.data()[k].cell, place.x, place.y, place.z}))
            a.check(false, "invalid position of " + name_of(p.id.data()[k]) + ", got " +
                               shown(Vec3{double(place.x), double(place.y), double(place.z)}));
    }
    read_pairs(a, engine->arrays().pairs, p.count, boundaries.size(), meshes->triangle.size());
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
    const auto list = [&](auto& values) {
        const std::size_t got = a.list(values, n);
        a.check(got == n, "wrong number of particles, got " + std::to_string(got));
    };
    /// An array that only some schemes use
    const auto list_if = [&](bool used, auto& values, const char* what) {
        const std::size_t got = a.list(values);
        a.check(got == (used ? n : 0),
                "an array of another integrator, got " + std::to_string(got) + " elements");
        check_vectors(a, values, what);
    };
    n = a.list(p.position, n);
    a.check_each(
        p.position, "invalid position of a particle",
        [&](const Position& at) { return is_near_domain(domain.grid, at); },
        [&](const Position& at) {
            return "cell " + std::to_string(at.cell) + ", " +
                   shown(Vec3{double(at.x), double(at.y), double(at.z)});
        });
    list(p.velocity);
    check_vectors(a, p.velocity, "a velocity");
    a.check_each(
        p.velocity, "a radius must be positive and that of the domain",
        [&](const Float4& v) {
            return v.w > 0 && v.w <= domain.largest && (domain.radius == 0 || v.w == domain.radius);
        },
        [](const Float4& v) { return shown(v.w); });
    list(p.omega);
    check_vectors(a, p.omega, "an angular velocity");
    a.check_each(
        p.omega, "an inverse mass must not be negative", [](const Float4& w) { return w.w >= 0; },
        [](const Float4& w) { return shown(w.w); });
    list(p.compensation);
    a.check_each(p.compensation, "a rounding error of a velocity must be finite", valid_compensation,
                 [](const Compensation& c) { return shown(c); });
    list(p.species);
    a.check_each(
        p.species, "invalid material or replica of a particle",
        [&](const Species& s) { return s.material < materials.size() && s.replica < domain.replicas; },
        [](const Species& s) { return std::to_string(s.material) + ", " + std::to_string(s.replica); });
    list(p.id);
    a.check(!a.reads() || (next_id >= n && next_id - n == static_cast<std::uint64_t>(total_outflow.count) &&
                           valid_ids(p.id.data(), n, next_id)),
            "the ids of the particles must be below the next one, " + std::to_string(next_id) +
                ", and differ, got " + std::to_string(n) + " particles, the largest id " +
                std::to_string(n > 0 ? *std::max_element(p.id.data(), p.id.data() + n) : 0));
    if (attached_changed) posed.clear();
    a.list(attached);
    a.check(valid_attached(attached, next_id, boundaries.size()),
            "invalid list of attached particles, got " + std::to_string(attached.size()));
    const auto is_rotation = [](const EulerParameters<double>& e) {
        return std::abs(e.e0 * e.e0 + e.e.dot(e.e) - 1) < 1e-6;
    };
    const auto shown_rotation = [](const EulerParameters<double>& e) {
        return "(" + shown(e.e0) + ", " + shown(e.e.x) + ", " + shown(e.e.y) + ", " + shown(e.e.z) + ')';
    };
    a.list(rotations);
    a.check(rotations.empty() ? attached.empty() : rotations.size() == boundaries.size(),
            "wrong number of boundaries, got " + std::to_string(rotations.size()));
    a.check_each(rotations, "invalid rotation of a boundary", is_rotation, shown_rotation);
    a.list(posed);
    a.check(posed.empty() || (!attached.empty() && posed.size() == boundaries.size()),
            "wrong number of boundaries, got " + std::to_string(posed.size()));
    a.check_each(
        posed, "invalid pose of a boundary",
        [&](const BoundaryPose& b) {
            return finite(b.r) && finite(b.v) && finite(b.omega) && is_rotation(b.p);
        },
        [&](const BoundaryPose& b) {
            return "r " + shown(b.r) + ", v " + shown(b.v) + ", omega " + shown(b.omega) + ", " +
                   shown_rotation(b.p);
        });
    const bool previous = detail::uses_previous_acceleration(options.scheme);
    list_if(previous, p.acc, "an acceleration"), list_if(previous, p.alpha, "an angular acceleration");
    const std::size_t oriented = a.list(p.orientation);
    const auto is_unit = [](const Float4& e) { return std::abs(length({e.x, e.y, e.z, e.w}) - 1) < 1e-3; };
    const auto is_error = [](const Float4& e) { return length({e.x, e.y, e.z, e.w}) < 1e-3; };
    const auto shown_four = [](const Float4& e) { return shown(e); };
    a.check_each(p.orientation, "Euler parameters must have the length 1", is_unit, shown_four);
    const std::size_t compensated = a.list(p.orientation_compensation);
    a.check_each(p.orientation_compensation, "invalid rounding error of Euler parameters", is_error,
                 shown_four);
    if (compensated != oriented || oriented != (options.orientation ? n : 0))
        throw io::IoError(a.name() + ": the checkpoint " + (options.orientation ? "has no" : "has") +
                          " orientations, but /orientation of this case is " +
                          (options.orientation ? "true" : "false"));
    if (a.reads()) {
        p.count = static_cast<std::uint32_t>(n);
        inserted_count = n;
    }
    transfer_clumps(a);
}

/// Builds the neighbour list of the saved world, with the positions for which it was built. Throws
/// io::IoError.
void World::restore_neighbours(const std::string& file, std::vector<PlaceAtBuild> at_build)
{
    const std::vector<Boundary> now = boundaries;
    for (std::size_t k = 0; k < boundaries.size(); ++k)
        boundaries[k].r = boundaries_at_build[k].r, boundaries[k].axis = boundaries_at_build[k].axis,
        boundaries[k].p = boundaries_at_build[k].p;
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
    // The search would assign the clumps to the cells of their present places.
    par::Array<par::Cpu, ClumpBody>& clumps_now = engine->arrays().clump;
    const std::vector<ClumpBody> clumps_saved(clumps_now.data(), clumps_now.data() + clumps_now.size());
    clumps_now.resize(0);
    exchange();
    try {
        find_neighbours();
    } catch (const LeftDomain& lost) {
        throw io::IoError(file + ": the checkpoint is damaged: " + name_of(lost.id) +
                          " was outside the domain when the neighbour list was built");
    } catch (const io::InvalidInput& e) {
        throw io::IoError(file + ": the checkpoint is damaged: " + e.what());
    }
    const std::uint64_t found = order();
    if (found != saved)
        throw io::IoError(file +
                          ": the checkpoint is damaged: the checksum of the order of the particles must be " +
                          std::to_string(found) + ", got " + std::to_string(saved));
    clumps_now.resize(clumps_saved.size());
    std::copy(clumps_saved.begin(), clumps_saved.end(), clumps_now.data());
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
    in_step = false;
    time = static_cast<double>(step_count) * options.h;
}

}  // namespace hilda::granular
