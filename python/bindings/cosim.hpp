// SPDX-License-Identifier: GPL-3.0-or-later
/// Co-simulations of mechanisms and grains.

#pragma once

#include <pybind11/pybind11.h>

namespace hilda::python {

void define_cosim(pybind11::module_& m);

}  // namespace hilda::python
