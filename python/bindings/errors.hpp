// SPDX-License-Identifier: GPL-3.0-or-later
/// The exceptions of the library as those of the module errors of a Python package.

#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <string>

namespace hilda::io {
class NumericalFailure;
}

namespace hilda::python {

namespace py = pybind11;

/// From here on, exceptions of the library that leave a function of the extension module become exceptions of
/// this module of Python, such as "hilda.errors", with the same text.
void translate_exceptions(const char* errors);

/// The exception class with this name in that module of Python
py::object error_class(const char* name);

/// NumericalFailure with the status and the text
py::object numerical_failure(const io::NumericalFailure& failure, const std::string& text);

/// The exception of Python for one of the library. Other exceptions are thrown again.
py::object python_error(std::exception_ptr thrown);

/// Adds a line to an exception of Python: the place where it was raised.
void add_note(const py::error_already_set& error, const std::string& note);

}  // namespace hilda::python
