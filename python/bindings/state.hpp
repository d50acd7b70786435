// SPDX-License-Identifier: GPL-3.0-or-later
/// States and their arrays in Python.

#pragma once

#include "lie/state.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

namespace hilda::python {

namespace py = pybind11;

/// A state that Python can refer to. The arrays of its properties share its memory and keep it alive.
struct StateObject {
    lie::State x;
    bool writable = false;  ///< whether the arrays may be written to
};
using StatePointer = std::shared_ptr<StateObject>;

/// Adds the class State to the module.
void define_state(py::module_& m);

/// State objects for the calls of a Python function: each call takes one and gives it back, unless Python has
/// kept it. A call of another thread has its own. Needs the GIL.
class StatePool {
public:
    /// Copies x into a free object for the scope of a call.
    class Lent {
    public:
        Lent(StatePool& pool, const lie::State& x);
        ~Lent();
        Lent(const Lent&) = delete;
        Lent& operator=(const Lent&) = delete;

        const py::object& object() const { return state; }

    private:
        StatePool& pool;
        py::object state;
    };

private:
    std::vector<py::object> free;
};

}  // namespace hilda::python
