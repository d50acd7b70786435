// SPDX-License-Identifier: GPL-3.0-or-later
/// Integrators that are classes in Python.

#pragma once

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "python/bindings/state.hpp"

namespace hilda::python {

/// Calls step(x, h) of a Python object, which changes the writable state x from t_n to t_n + h.
class PythonIntegrator final : public lie::Integrator {
public:
    PythonIntegrator(py::object object, const lie::System& model);

    int step(lie::State& x, double h) override;
    const lie::System& system() const override { return model; }
    lie::Statistics statistics() const override { return {.steps = steps, .iterations = iterations}; }

private:
    py::object object;
    const lie::System& model;
    StatePool pool;
    long steps = 0, iterations = 0;
};

/// The properties of such an integrator: the name of its class and its attribute `order`
lie::Scheme scheme_of(const py::object& integrator);

}  // namespace hilda::python
