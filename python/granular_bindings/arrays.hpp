// SPDX-License-Identifier: GPL-3.0-or-later
/// Arrays of NumPy.

#pragma once

#include "granular/core/boundary.hpp"

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hilda::python {

namespace py = pybind11;

/// Contiguous arrays of Python; the package has checked their shapes and values.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ids = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

/// A new array with these names in a dict, which is filled by rows
template <class T>
class Column {
public:
    /// Shape (rows,), or (rows, width) with width > 1
    Column(const py::dict& all, const char* name, std::size_t rows, std::size_t width = 1)
        : array(shape(rows, width)), next(array.mutable_data())
    {
        all[name] = array;
    }
    void add(T value) { *next++ = value; }
    void add(const granular::Vec3& v) { add(v.x), add(v.y), add(v.z); }

private:
    static std::vector<py::ssize_t> shape(std::size_t rows, std::size_t width)
    {
        std::vector<py::ssize_t> all{static_cast<py::ssize_t>(rows)};
        if (width > 1) all.push_back(static_cast<py::ssize_t>(width));
        return all;
    }

    py::array_t<T> array;
    T* next;
};

inline granular::Vec3 vector_at(const double* first, std::size_t row)
{
    return {first[3 * row], first[3 * row + 1], first[3 * row + 2]};
}

/// The rows of an array of the shape (n, 3)
inline std::vector<granular::Vec3> vectors(const Numbers& array)
{
    std::vector<granular::Vec3> all(static_cast<std::size_t>(array.size()) / 3);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = vector_at(array.data(), k);
    return all;
}

/// A new array of the shape (3,)
inline py::array_t<double> array_of(const granular::Vec3& v)
{
    py::array_t<double> array(3);
    double* const to = array.mutable_data();
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
    return array;
}

}  // namespace hilda::python
