// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/errors.hpp"

#include "io/error.hpp"
#include "io/expression.hpp"

#include <utility>

namespace hilda::python {

namespace {

/// A class of hilda.errors. The module is imported before any exception of the library can occur.
py::object error_class(const char* name) { return py::module_::import("hilda.errors").attr(name); }

}  // namespace

void translate_exceptions()
{
    py::register_exception_translator([](std::exception_ptr thrown) {
        const auto raise = [](const std::exception& error) {
            const py::object of_python = python_error(error);
            PyErr_SetObject(py::type::of(of_python).ptr(), of_python.ptr());
        };
        try {
            if (thrown) std::rethrow_exception(std::move(thrown));
        } catch (const io::NumericalFailure& error) {
            raise(error);
        } catch (const io::InvalidInput& error) {
            raise(error);
        } catch (const io::ExpressionError& error) {
            raise(error);
        } catch (const io::Failure& error) {
            raise(error);
        }
    });
}

py::object python_error(const std::exception& error)
{
    const auto is = [&](auto* type) { return dynamic_cast<decltype(type)>(&error) != nullptr; };
    if (const auto* failure = dynamic_cast<const io::NumericalFailure*>(&error))
        return numerical_failure(*failure, failure->what());
    const char* name = nullptr;
    if (is(static_cast<const io::InvalidInput*>(nullptr)) ||
        is(static_cast<const io::ExpressionError*>(nullptr)))
        name = "InvalidInput";
    else if (is(static_cast<const io::UsageError*>(nullptr)))
        name = "UsageError";
    else if (is(static_cast<const io::IoError*>(nullptr)))
        name = "FileError";
    else if (is(static_cast<const io::NotAvailable*>(nullptr)))
        name = "NotAvailable";
    if (name != nullptr) return error_class(name)(error.what());
    return py::module_::import("builtins").attr("RuntimeError")(error.what());
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
