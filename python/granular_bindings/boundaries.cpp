// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/granular_bindings/boundaries.hpp"

#include "io/error.hpp"
#include "io/nearest.hpp"
#include "python/granular_bindings/arrays.hpp"

#include <pybind11/stl.h>

#include <algorithm>

namespace hilda::python {

namespace {

using granular::Boundary;
using granular::BoundaryMotion;
using granular::Vec3;

int number_of(WorldObject& o, const std::string& name)
{
    const std::vector<std::string>& names = o.of().boundaries;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw io::InvalidInput("World.boundary: the case has no boundary" + io::with_nearest(name, names));
    return static_cast<int>(found - names.begin());
}

/// A vector of a boundary, and the formulas that prescribe it
struct Entry {
    const char* name;
    Vec3 Boundary::*value;
    bool (*is_prescribed)(const BoundaryMotion&);
    bool is_load;
};
constexpr Entry entries[] = {
    {"r", &Boundary::r, nullptr, false},
    {"axis", &Boundary::axis, nullptr, false},
    {"v", &Boundary::v, [](const BoundaryMotion& m) { return m.r || m.v; }, false},
    {"omega", &Boundary::omega, [](const BoundaryMotion& m) { return m.omega.has_value(); }, false},
    {"F", &Boundary::F, [](const BoundaryMotion& m) { return m.F.has_value(); }, true},
    {"T", &Boundary::T, [](const BoundaryMotion& m) { return m.T.has_value(); }, true},
};

const Entry& entry(const std::string& name)
{
    return *std::find_if(std::begin(entries), std::end(entries),
                         [&](const Entry& e) { return e.name == name; });
}

py::array_t<double> value(WorldObject& o, int number, const std::string& name)
{
    const Use use(o, "Boundary." + name);
    return array_of(o.world().boundary(number).*entry(name).value);
}

/// Sets a vector of a boundary for the next steps, unless the case prescribes it by a formula.
void set(WorldObject& o, int number, const std::string& name, const Numbers& given)
{
    const Use use(o, "Boundary." + name);
    const Entry& e = entry(name);
    Boundary& b = o.world().boundary(number);
    const auto fail = [&](const std::string& what) {
        throw io::InvalidInput("Boundary." + name + ": boundary '" +
                               o.of().boundaries[static_cast<std::size_t>(number)] + "' " + what);
    };
    if (b.body >= 0)
        fail("is a part of boundary '" + o.of().boundaries[static_cast<std::size_t>(b.body)] +
             "', which has the velocities and loads");
    if (e.is_load && !(b.mass > 0)) fail("has no mass: a load does not move it");
    for (const BoundaryMotion& m : *o.of().motions)
        if (m.boundary == number && e.is_prescribed(m)) fail("has a formula in the case that prescribes it");
    b.*e.value = vector_at(given.data(), 0);
    if (b.mass > 0 && !e.is_load) o.world().start_balance();
}

py::tuple pair_of(const granular::Wrench& w) { return py::make_tuple(array_of(w.F), array_of(w.T)); }

py::tuple wrench(WorldObject& o, int number)
{
    const Use use(o, "Boundary.wrench");
    granular::World::Totals totals;
    {
        const py::gil_scoped_release release;
        totals = o.world().totals();
    }
    return pair_of(totals.on_boundary[static_cast<std::size_t>(number)]);
}

py::tuple load(WorldObject& o, int number)
{
    const Use use(o, "Boundary.load");
    const auto fail = [&](const char* what) {
        throw io::InvalidInput("Boundary.load: boundary '" +
                               o.of().boundaries[static_cast<std::size_t>(number)] + "' " + what);
    };
    if (!(o.world().boundary(number).mass > 0)) fail("has no mass; use wrench()");
    if (o.world().steps() == 0) fail("has no load before the first step; use wrench()");
    return pair_of(o.world().tool_load(number));
}

py::dict contacts(WorldObject& o)
{
    const Use use(o, "World.contacts");
    std::vector<granular::ContactRecord> from;
    {
        const py::gil_scoped_release release;
        from = o.world().contacts();
    }
    py::dict all;
    const std::size_t n = from.size();
    Column<std::uint32_t> i(all, "i", n), j(all, "j", n);
    Column<bool> boundary(all, "boundary", n);
    Column<double> C(all, "C", n, 3), normal(all, "n", n, 3), delta(all, "delta", n), F(all, "F", n, 3),
        T(all, "T", n, 3), u(all, "u", n, 3);
    Column<std::int32_t> replica(all, "replica", n);
    for (const granular::ContactRecord& c : from) {
        i.add(c.i), j.add(c.j), boundary.add(c.boundary), C.add(c.C), normal.add(c.n), delta.add(c.delta);
        F.add(c.F), T.add(c.T), u.add(c.u), replica.add(c.replica);
    }
    return all;
}

py::dict totals(WorldObject& o)
{
    const Use use(o, "World.totals");
    granular::World::Totals of_contacts;
    granular::World::Sums sums;
    {
        const py::gil_scoped_release release;
        of_contacts = o.world().totals();
        sums = o.world().sums();
    }
    py::dict all;
    all["kinetic_energy"] = sums.kinetic_energy;
    all["rotational_energy"] = sums.rotational_energy;
    all["potential_energy"] = sums.potential_energy;
    all["momentum"] = array_of(sums.momentum);
    all["contacts"] = of_contacts.contacts;
    py::array_t<double> stress({3, 3});
    std::copy(of_contacts.stress.begin(), of_contacts.stress.end(), stress.mutable_data());
    all["stress"] = stress;
    const std::size_t n = of_contacts.on_boundary.size();
    Column<double> F(all, "F", n, 3), T(all, "T", n, 3);
    for (const granular::Wrench& w : of_contacts.on_boundary) F.add(w.F), T.add(w.T);
    return all;
}

}  // namespace

void define_boundaries(py::class_<WorldObject, WorldPointer>& world)
{
    world.def("number_of", &number_of)
        .def("boundary", &value)
        .def("set_boundary", &set)
        .def("mass_of", [](WorldObject& o, int number) { return o.world().boundary(number).mass; })
        .def("wrench", &wrench)
        .def("load", &load)
        .def("contacts", &contacts)
        .def("totals", &totals);
}

}  // namespace hilda::python
