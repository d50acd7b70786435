// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/model_function.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace hilda::python {

namespace {

std::string type_of(const py::handle& object)
{
    return py::str(py::type::of(object).attr("__name__")).cast<std::string>();
}

std::string text_of(const std::vector<py::ssize_t>& shape)
{
    std::string text = "(";
    for (size_t n = 0; n < shape.size(); ++n) text += fmt::format("{}{}", n > 0 ? ", " : "", shape[n]);
    return text + (shape.size() == 1 ? ",)" : ")");
}

}  // namespace

int ModelFunctions::visit(visitproc visit, void* arg) const
{
    for (const py::object& function : functions) Py_VISIT(function.ptr());
    return 0;
}

void ModelFunctions::clear()
{
    for (py::object& function : functions) function = py::none();
}

void read_array(const py::handle& object, const char* what, py::ssize_t rows, py::ssize_t columns,
                double* out)
{
    // Throws the exception of the conversion, such as one of lists of different lengths.
    const py::array given = py::reinterpret_borrow<py::object>(object);
    if (std::string_view("biuf").find(given.dtype().kind()) == std::string_view::npos)
        throw py::type_error(fmt::format("{} must be an array of numbers, got {}", what,
                                         py::isinstance<py::array>(object)
                                             ? py::str(given.dtype()).cast<std::string>()
                                             : type_of(object)));
    const auto array = py::array_t<double, py::array::forcecast>(given);
    std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim()), expected = {rows};
    if (columns > 0) expected.push_back(columns);
    if (shape != expected)
        throw py::value_error(
            fmt::format("{} must have the shape {}, got {}", what, text_of(expected), text_of(shape)));
    const py::ssize_t width = std::max<py::ssize_t>(columns, 1);
    for (py::ssize_t i = 0; i < rows; ++i)
        for (py::ssize_t k = 0; k < width; ++k) {
            const double value = columns > 0 ? *array.data(i, k) : *array.data(i);
            if (!std::isfinite(value))
                throw py::value_error(
                    columns > 0 ? fmt::format("{} is not finite in row {}: {}", what, i, value)
                                : fmt::format("{} is not finite: component {} is {}", what, i, value));
            *out++ = value;
        }
}

double read_number(const py::handle& object, const char* what)
{
    double value = 0;
    try {
        value = object.cast<double>();
    } catch (const py::cast_error&) {
        throw py::type_error(fmt::format("{} must be a number, got {}", what, type_of(object)));
    }
    if (!std::isfinite(value)) throw py::value_error(fmt::format("{} is not finite: {}", what, value));
    return value;
}

}  // namespace hilda::python
