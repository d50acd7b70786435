// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces that are functions in Python.

#pragma once

#include "dae/force.hpp"
#include "python/bindings/model_function.hpp"
#include "python/bindings/state.hpp"

namespace hilda::python {

/// A load on the bodies of a model, computed by a Python function of the state.
///
/// The function returns F, or (F, n_bar): arrays of the shape (bodies, 3) with the forces [N, global frame,
/// at the centres of mass] and the torques [N m, body frames]. An exception of the function ends the run. An
/// array of another shape, or with a number that is not finite, is a ValueError.
class PythonForce final : public dae::Force, public ModelFunctions {
public:
    /// `potential`: function of the state that returns the potential energy [J], or None
    PythonForce(const std::string& name, py::object function, py::object potential, int bodies);

    void add(const lie::State& x, lie::Loads& out) const override;
    double potential_energy(const lie::State& x) const override;
    int last_body() const override { return bodies - 1; }

private:
    std::string place(const char* what, const lie::State& x) const;
    void add(const py::handle& array, const char* what, std::vector<lie::Vec3>& out) const;

    int bodies;
    mutable StatePool pool;
};

}  // namespace hilda::python
