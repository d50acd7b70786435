// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of a model in Python.

#pragma once

#include <pybind11/pybind11.h>

namespace hilda::python {

namespace py = pybind11;

/// Adds the function _run to the module.
void define_run(py::module_& m);

}  // namespace hilda::python
