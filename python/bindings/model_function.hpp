// SPDX-License-Identifier: GPL-3.0-or-later
/// Python functions that are parts of a model: how they are called, and how their results are read.

#pragma once

#include "python/bindings/errors.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace hilda::python {

namespace py = pybind11;

/// The functions of one force, constraint or surface
class ModelFunctions {
public:
    virtual ~ModelFunctions() = default;

    /// For the garbage collector: a function may refer to the model that contains it.
    int visit(visitproc visitor, void* argument) const;
    void clear();

protected:
    explicit ModelFunctions(std::vector<py::object> functions) : functions(std::move(functions)) {}

    std::vector<py::object> functions;  ///< None for one that is not given
};

/// Calls f() with the GIL. An exception of Python gets a note with the place, which place() returns.
template <class Place, class Function>
auto call_python(const Place& place, const Function& f)
{
    const py::gil_scoped_acquire gil;
    try {
        try {
            return f();
        } catch (const py::builtin_exception& error) {  // of the checks of this file
            error.set_error();
            throw py::error_already_set();
        }
    } catch (const py::error_already_set& error) {
        add_note(error, place());
        throw;
    }
}

/// Copies an array of the shape (rows, columns), or (rows,) for columns = 0, to `out`, by rows. TypeError and
/// ValueError, also for a number that is not finite; `what` is the name of the array in them.
void read_array(const py::handle& object, const char* what, py::ssize_t rows, py::ssize_t columns,
                double* out);

/// Reads a finite number.
double read_number(const py::handle& object, const char* what);

}  // namespace hilda::python
