// SPDX-License-Identifier: GPL-3.0-or-later
/// Models in Python.

#pragma once

#include "dae/model_file.hpp"

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

namespace hilda::python {

namespace py = pybind11;

class ModelFunctions;

/// A model that has been read and has a consistent start. It is constant from then on, so that several
/// threads may use it at the same time.
struct ModelObject {
    dae::Description description;
    dae::StartReport start;
    std::vector<ModelFunctions*> functions;       ///< of the parts of the model that are written in Python
    std::vector<std::string> names_of_functions;  ///< of forces, constraints and classes of surfaces
};
using ModelPointer = std::shared_ptr<ModelObject>;

/// Adds the class _Model and the lists of models and integrators to the module.
void define_model(py::module_& m);

}  // namespace hilda::python
