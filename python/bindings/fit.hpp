// SPDX-License-Identifier: GPL-3.0-or-later
/// Fits of models to data.

#pragma once

#include <pybind11/pybind11.h>

namespace hilda::python {

void define_fit(pybind11::module_& m);

}  // namespace hilda::python
