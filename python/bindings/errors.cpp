// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/errors.hpp"

#include "io/error.hpp"
#include "io/expression.hpp"

#include <utility>

namespace hilda::python {

namespace {

const char* module_of_errors = "";

}  // namespace

// The module of Python is imported before any exception of the library can occur.
py::object error_class(const char* name) { return py::module_::import(module_of_errors).attr(name); }

void translate_exceptions(const char* errors)
{
    module_of_errors = errors;
    // The packages hilda and hilda_granular may be in one process: each translates the exceptions of its own.
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        if (thrown == nullptr) return;
        const py::object error = python_error(std::move(thrown));
        PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
    });
}

py::object python_error(std::exception_ptr thrown)
{
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const io::NumericalFailure& error) {
        return numerical_failure(error, error.what());
    } catch (const io::InvalidInput& error) {
        return error_class("InvalidInput")(error.what());
    } catch (const io::ExpressionError& error) {
        return error_class("InvalidInput")(error.what());
    } catch (const io::UsageError& error) {
        return error_class("UsageError")(error.what());
    } catch (const io::IoError& error) {
        return error_class("FileError")(error.what());
    } catch (const io::NotAvailable& error) {
        return error_class("NotAvailable")(error.what());
    }
}

py::object numerical_failure(const io::NumericalFailure& failure, const std::string& text)
{
    return error_class("NumericalFailure")(failure.status, text);
}

void add_note(const py::error_already_set& error, const std::string& note)
{
    error.value().attr("add_note")(note);
}

}  // namespace hilda::python
