// SPDX-License-Identifier: GPL-3.0-or-later
/// Steps of a world in Python.

#pragma once

#include "python/granular_bindings/world_object.hpp"

namespace hilda::python {

/// Computes n steps without the GIL and returns their number, which is less than n if the last stage ends or
/// `before` returns true: a function without arguments that is called before each step, or None. The signal
/// handlers of Python run between the steps.
long advance(WorldObject& o, long n, const py::object& before);

}  // namespace hilda::python
