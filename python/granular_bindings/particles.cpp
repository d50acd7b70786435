// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/granular_bindings/particles.hpp"

#include "granular/insertion/obstacles.hpp"
#include "granular/stages/step_check.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "python/granular_bindings/arrays.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <sstream>

namespace hilda::python {

namespace {

using granular::Particle;

/// Calls fill(particle) for all particles, without the GIL. Arrays that Python receives are read-only: they
/// are kept for the next call.
template <class Fill>
void fill_all(WorldObject& o, const py::dict& arrays, const Fill& fill)
{
    {
        const py::gil_scoped_release release;
        o.world().each_particle(fill);
    }
    for (const auto& [name, array] : arrays) array.attr("setflags")(py::arg("write") = false);
}

/// The arrays of the present state: those of the last call if the world has not changed.
template <class Make>
py::object kept(WorldObject& o, WorldObject::Columns& columns, const Make& make)
{
    if (!columns.arrays || columns.at != o.changes) {
        columns.arrays = {};  // releases the memory, unless Python has references
        columns.arrays = make();
        columns.at = o.changes;
    }
    return columns.arrays;
}

py::object motion(WorldObject& o)
{
    const Use use(o, "World");
    return kept(o, o.motion, [&] {
        py::dict all;
        const std::size_t n = o.world().count();
        Column<double> r(all, "r", n, 3), v(all, "v", n, 3), omega(all, "omega", n, 3);
        std::optional<Column<double>> e;
        if (o.world().has_orientation()) e.emplace(all, "e", n, 4);
        fill_all(o, all, [&](const Particle& p) {
            r.add(p.r), v.add(p.v), omega.add(p.omega);
            if (e)
                for (const double x : p.e) e->add(x);
        });
        return all;
    });
}

py::object properties(WorldObject& o)
{
    const Use use(o, "World");
    return kept(o, o.properties, [&] {
        py::dict all;
        const std::size_t n = o.world().count();
        const granular::Groups* const groups = o.of().groups.get();
        Column<std::uint32_t> id(all, "id", n);
        Column<double> radius(all, "radius", n), mass(all, "mass", n);
        Column<std::int32_t> material(all, "material", n), replica(all, "replica", n), group(all, "group", n);
        Column<bool> fixed(all, "fixed", n);
        Column<std::int64_t> clump(all, "clump", n);
        fill_all(o, all, [&](const Particle& p) {
            id.add(p.id), radius.add(p.radius), mass.add(p.mass), material.add(p.material);
            replica.add(p.replica), fixed.add(p.fixed), clump.add(p.clump);
            group.add(groups != nullptr ? groups->of(p.id) : granular::Groups::none);
        });
        return all;
    });
}

std::vector<std::uint32_t> list_of(const Ids& ids) { return {ids.data(), ids.data() + ids.size()}; }

void set_force(WorldObject& o, const Ids& ids, const Numbers& F)
{
    const Use use(o, "World.set_force");
    o.world().set_forces(list_of(ids), vectors(F));
}

void set_velocity(WorldObject& o, const Ids& ids, const Numbers& v, const std::optional<Numbers>& omega)
{
    const Use use(o, "World.set_velocity");
    ++o.changes;
    o.world().set_velocities(list_of(ids), vectors(v),
                             omega ? vectors(*omega) : std::vector<granular::Vec3>{});
}

/// Properties of new particles: arrays with a row for each of them
struct NewParticles {
    Numbers r, radius, v, omega, mass, e;
    int material;
    bool fixed;
    std::uint16_t replica;
    std::string group;  ///< empty: none
};

/// Number of the group with this name, which the case has to have
int group_of(const granular::Groups* groups, const std::string& name)
{
    if (name.empty()) return granular::Groups::none;
    const std::vector<std::string> names = groups != nullptr ? groups->names : std::vector<std::string>{};
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw io::InvalidInput("World.add: the case has no group" + io::with_nearest(name, names));
    return static_cast<int>(found - names.begin());
}

[[noreturn]] void refuse_place(std::size_t k, const Particle& p, const std::string& what)
{
    std::ostringstream text;
    text << "World.add: r[" << k << "] must " << what << ", got (" << p.r.x << ", " << p.r.y << ", " << p.r.z
         << ") m";
    throw io::InvalidInput(text.str());
}

/// Throws io::InvalidInput for a centre outside of the domain: the world would fail at the insertion.
void check_inside(const granular::World& world, const std::vector<Particle>& all)
{
    const granular::Vec3 low = world.low(), high = world.high();
    const auto is_outside = [&](double x, double from, double to, int axis) {
        return !world.periodic()[static_cast<std::size_t>(axis)] && !(x >= from && x < to);
    };
    for (std::size_t k = 0; k < all.size(); ++k) {
        const granular::Vec3& r = all[k].r;
        if (is_outside(r.x, low.x, high.x, 0) || is_outside(r.y, low.y, high.y, 1) ||
            is_outside(r.z, low.z, high.z, 2))
            refuse_place(k, all[k], "be inside the domain");
    }
}

/// The same for overlaps that World::add() does not allow
void check_overlaps(const granular::World& world, const std::vector<Particle>& all)
{
    constexpr double allowed = 0.05;  // of the smaller radius; see World::add()
    const auto is_valid = [](const Particle& p) { return p.radius > 0; };
    if (all.empty() || !std::all_of(all.begin(), all.end(), is_valid)) return;  // World::add() refuses them
    granular::Vec3 low = all[0].r, high = low;
    double largest = 0;
    for (const Particle& p : all) {
        low = {std::min(low.x, p.r.x), std::min(low.y, p.r.y), std::min(low.z, p.r.z)};
        high = {std::max(high.x, p.r.x), std::max(high.y, p.r.y), std::max(high.z, p.r.z)};
        largest = std::max(largest, p.radius);
    }
    granular::Obstacles obstacles(world, low, high, largest, all[0].replica);
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (obstacles.touches(all[k].r, all[k].radius, allowed))
            refuse_place(
                k, all[k],
                "not be that of a particle which overlaps another one or a boundary by more than 5 % "
                "of a radius");
        obstacles.add(all[k].r, all[k].radius);
    }
}

std::uint32_t add(WorldObject& o, const NewParticles& given)
{
    const Use use(o, "World.add");
    granular::Groups* const groups = o.of().groups.get();
    const int group = group_of(groups, given.group);
    std::vector<Particle> all(static_cast<std::size_t>(given.radius.size()));
    for (std::size_t k = 0; k < all.size(); ++k) {
        Particle& p = all[k];
        p.r = vector_at(given.r.data(), k), p.radius = given.radius.data()[k];
        p.v = vector_at(given.v.data(), k), p.omega = vector_at(given.omega.data(), k);
        p.material = given.material, p.fixed = given.fixed, p.replica = given.replica;
        p.mass = given.mass.data()[k];
        std::copy_n(given.e.data() + 4 * k, 4, p.e.begin());
    }
    check_inside(o.world(), all);
    check_overlaps(o.world(), all);
    const std::uint32_t first = o.world().add(all);
    if (groups != nullptr && !all.empty()) groups->add(first, group);
    o.insert();
    if (const double limit = stability_limit(o.world().step_limits()); o.of().h > limit)
        o.warnings.push_back(io::formatted(
            "World.add: the step %g s is above the stability limit %.3g s with the particles that were added",
            o.of().h, limit));
    return first;
}

void remove(WorldObject& o, const Ids& given)
{
    const Use use(o, "World.remove");
    std::vector<std::uint32_t> ids = list_of(given);
    o.world().places_of(ids, "World.remove");
    std::sort(ids.begin(), ids.end());
    ++o.changes;
    o.world().remove(ids);
}

py::dict take_removed(WorldObject& o)
{
    const Use use(o, "World.take_removed");
    const std::vector<granular::RemovedParticle>& from = o.world().removed();
    py::dict all;
    const std::size_t n = from.size();
    Column<double> t(all, "t", n);
    Column<std::uint32_t> id(all, "id", n);
    Column<double> r(all, "r", n, 3), v(all, "v", n, 3), omega(all, "omega", n, 3), radius(all, "radius", n),
        mass(all, "mass", n);
    Column<std::int32_t> side(all, "side", n);
    for (const granular::RemovedParticle& p : from) {
        t.add(p.t), id.add(p.id), r.add(p.r), v.add(p.v), omega.add(p.omega), radius.add(p.radius);
        mass.add(p.mass);
        side.add(p.side == granular::RemovedParticle::none ? -1 : static_cast<std::int32_t>(p.side));
    }
    o.world().clear_removed();
    return all;
}

}  // namespace

void define_particles(py::class_<WorldObject, WorldPointer>& world)
{
    world.def("motion", &motion)
        .def("properties", &properties)
        .def("set_force", &set_force)
        .def("set_velocity", &set_velocity)
        .def("add",
             [](WorldObject& o, Numbers r, Numbers radius, Numbers v, Numbers omega, Numbers mass, Numbers e,
                int material, bool fixed, std::uint16_t replica, std::string group) {
                 return add(o, {std::move(r), std::move(radius), std::move(v), std::move(omega),
                                std::move(mass), std::move(e), material, fixed, replica, std::move(group)});
             })
        .def("remove", &remove)
        .def("take_removed", &take_removed);
}

}  // namespace hilda::python
