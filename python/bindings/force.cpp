// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/force.hpp"

#include "python/bindings/errors.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hilda::python {

namespace {

std::string shape_of(const py::array& array)
{
    std::string text = "(";
    for (py::ssize_t n = 0; n < array.ndim(); ++n)
        text += fmt::format("{}{}", n > 0 ? ", " : "", array.shape(n));
    return text + (array.ndim() == 1 ? ",)" : ")");
}

}  // namespace

PythonForce::PythonForce(const std::string& name, py::object function, py::object potential, int bodies)
    : function(std::move(function)), potential(std::move(potential)), bodies(bodies)
{
    this->name = name;
}

/// Calls function_of(state) with the GIL. An exception of Python gets a note with the force and the time.
template <class Function>
auto PythonForce::call(const lie::State& x, const char* what, const Function& function_of) const
{
    const py::gil_scoped_acquire gil;
    try {
        try {
            const StatePool::Lent lent(pool, x);
            return function_of(lent.object());
        } catch (const py::builtin_exception& error) {  // of this file
            error.set_error();
            throw py::error_already_set();
        }
    } catch (const py::error_already_set& error) {
        add_note(error, fmt::format("{} of {} at t = {} s", what, label(), x.t));
        throw;
    }
}

void PythonForce::add(const lie::State& x, lie::Loads& out) const
{
    call(x, "the function", [&](const py::object& state) {
        const py::object loads = function(state);
        if (py::isinstance<py::tuple>(loads)) {
            const auto both = py::reinterpret_borrow<py::tuple>(loads);
            if (both.size() != 2)
                throw py::value_error(
                    fmt::format("a force must return F or (F, n_bar), got a tuple of {}", both.size()));
            add(both[0], "F", out.F);
            add(both[1], "n_bar", out.n_bar);
        } else {
            add(loads, "F", out.F);
        }
    });
}

double PythonForce::potential_energy(const lie::State& x) const
{
    if (potential.is_none()) return 0;
    return call(x, "the potential energy", [&](const py::object& state) {
        const auto energy = potential(state).cast<double>();
        if (!std::isfinite(energy))
            throw py::value_error(fmt::format("the potential energy is not finite: {}", energy));
        return energy;
    });
}

int PythonForce::visit(visitproc visit, void* arg) const
{
    Py_VISIT(function.ptr());
    Py_VISIT(potential.ptr());
    return 0;
}

/// Adds an array of the shape (bodies, 3) to `out`.
void PythonForce::add(const py::handle& object, const char* what, std::vector<lie::Vec3>& out) const
{
    const auto array = py::array_t<double, py::array::forcecast>::ensure(object);
    if (!array) {
        PyErr_Clear();
        throw py::type_error(fmt::format("{} must be an array of numbers, got {}", what,
                                         py::str(py::type::of(object).attr("__name__")).cast<std::string>()));
    }
    if (array.ndim() != 2 || array.shape(0) != bodies || array.shape(1) != 3)
        throw py::value_error(
            fmt::format("{} must have the shape ({}, 3), got {}", what, bodies, shape_of(array)));
    const auto value = array.unchecked<2>();
    for (int b = 0; b < bodies; ++b) {
        const lie::Vec3 of_body(value(b, 0), value(b, 1), value(b, 2));
        if (!std::isfinite(of_body.sum()))
            throw py::value_error(fmt::format("{} of body {} is not finite: [{}, {}, {}]", what, b,
                                              of_body.x(), of_body.y(), of_body.z()));
        out[static_cast<size_t>(b)] += of_body;
    }
}

}  // namespace hilda::python
