// SPDX-License-Identifier: GPL-3.0-or-later
/// Simulations in Python whose loop is in Python.

#pragma once

#include <pybind11/pybind11.h>

namespace hilda::python {

namespace py = pybind11;

/// Adds the class _Simulation to the module.
void define_simulation(py::module_& m);

}  // namespace hilda::python
