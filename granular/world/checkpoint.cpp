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

constexpr io::Archive::Format format = {.letters = "HILDAGRN", .version = 18};

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

}  // namespace

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
    a.value(particle_displacement), a.value(boundary_displacement);
    a.check(particle_displacement >= 0 && boundary_displacement >= 0,
            "invalid displacements, got " + shown(particle_displacement) + " and " +
                shown(boundary_displacement));
    a.list(boundaries_at_build);
    a.check(!std::isfinite(particle_displacement) || boundaries_at_build.size() == boundaries.size(),
            "wrong number of boundaries, got " + std::to_string(boundaries_at_build.size()));
    a.check_each(
        boundaries_at_build, "invalid place of a boundary",
        [](const BoundaryPlace& b) { return valid_place(b); },
        [](const BoundaryPlace& b) { return "r " + shown(b.r) + ", axis " + shown(b.axis); });
    transfer_particles(a);
    if (!a.reads()) return;
    if (posed.empty())
        attached_changed = !attached.empty();
    else
        set_attached();
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
