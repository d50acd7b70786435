// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/integrator.hpp"

#include "python/bindings/errors.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace hilda::python {

namespace {

/// Throws if a step has set the time to another value than that of its end. A step need not set it.
void refuse_other_time(double after, double before, double h)
{
    if (after == before || std::abs(after - (before + h)) <= 1e-9 * h) return;
    PyErr_SetString(PyExc_ValueError,
                    fmt::format("step() of an integrator must leave x.t at {} s or set it to {} s, got {}",
                                before, before + h, after)
                        .c_str());
    throw py::error_already_set();
}

}  // namespace

PythonIntegrator::PythonIntegrator(py::object object, const lie::System& model)
    : object(std::move(object)), model(model)
{}

int PythonIntegrator::step(lie::State& x, double h)
{
    const py::gil_scoped_acquire gil;
    try {
        const StatePool::Lent lent(pool, x);
        auto& state = lent.object().cast<StateObject&>();
        state.writable = true;
        const py::object count = object.attr("step")(lent.object(), h);
        const int k = count.is_none() ? 0 : count.cast<int>();
        refuse_other_time(state.x.t, x.t, h);
        x.body = state.x.body;
        x.lambda = state.x.lambda;
        ++steps;
        iterations += k;
        return k;
    } catch (const py::cast_error&) {
        py::type_error("step() of an integrator must return the number of its iterations, or None")
            .set_error();
        throw py::error_already_set();
    } catch (const py::error_already_set& error) {
        add_note(error, fmt::format("in the step from t = {} s", x.t));
        throw;
    }
}

lie::Scheme scheme_of(const py::object& integrator)
{
    const py::handle type = py::type::of(integrator);
    lie::Scheme scheme;
    scheme.name = py::str(type.attr("__name__")).cast<std::string>();
    scheme.order = scheme.order_lambda = type.attr("order").cast<int>();
    scheme.formulation = "rA";
    scheme.resumes = false;
    scheme.energy_drifts = true;
    return scheme;
}

}  // namespace hilda::python
