// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/force.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace hilda::python {

PythonForce::PythonForce(const std::string& name, py::object function, py::object potential, int bodies)
    : ModelFunctions({std::move(function), std::move(potential)}), bodies(bodies)
{
    this->name = name;
}

std::string PythonForce::place(const char* what, const lie::State& x) const
{
    return fmt::format("{} of {} at t = {} s", what, label(), x.t);
}

void PythonForce::add(const lie::State& x, lie::Loads& out) const
{
    call_python([&] { return place("the function", x); },
                [&] {
                    const StatePool::Lent lent(pool, x);
                    const py::object loads = functions[0](lent.object());
                    if (!py::isinstance<py::tuple>(loads)) return add(loads, "F", out.F);
                    const auto both = py::reinterpret_borrow<py::tuple>(loads);
                    if (both.size() != 2)
                        throw py::value_error(fmt::format(
                            "a force must return F or (F, n_bar), got a tuple of {}", both.size()));
                    add(both[0], "F", out.F);
                    add(both[1], "n_bar", out.n_bar);
                });
}

double PythonForce::potential_energy(const lie::State& x) const
{
    if (functions[1].is_none()) return 0;
    return call_python([&] { return place("the potential energy", x); },
                       [&] {
                           const StatePool::Lent lent(pool, x);
                           return read_number(functions[1](lent.object()), "the potential energy");
                       });
}

/// Adds an array of the shape (bodies, 3) to `out`.
void PythonForce::add(const py::handle& object, const char* what, std::vector<lie::Vec3>& out) const
{
    const auto given = py::array::ensure(object);
    if (given && std::string_view("biuf").find(given.dtype().kind()) != std::string_view::npos &&
        given.ndim() == 2 && given.shape(0) == bodies && given.shape(1) == 3) {
        const auto array = py::array_t<double, py::array::forcecast>(given);
        const auto value = array.unchecked<2>();
        for (int b = 0; b < bodies; ++b) {
            const lie::Vec3 of_body(value(b, 0), value(b, 1), value(b, 2));
            if (!std::isfinite(of_body.sum()))
                throw py::value_error(fmt::format("{} of body {} is not finite: [{}, {}, {}]", what, b,
                                                  of_body.x(), of_body.y(), of_body.z()));
            out[static_cast<size_t>(b)] += of_body;
        }
        return;
    }
    PyErr_Clear();
    std::vector<double> refused(static_cast<size_t>(3 * bodies));
    read_array(object, what, bodies, 3, refused.data());  // throws
}

}  // namespace hilda::python
