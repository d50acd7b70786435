// SPDX-License-Identifier: GPL-3.0-or-later
/// The equations of motion of a model in Python, for integrators that are written there.

#pragma once

#include <pybind11/pybind11.h>

namespace hilda::python {

namespace py = pybind11;

/// Adds the classes System and Saddle to the module.
void define_system(py::module_& m);

}  // namespace hilda::python
