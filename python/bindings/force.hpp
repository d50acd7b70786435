// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces that are functions in Python.

#pragma once

#include "dae/force.hpp"
#include "python/bindings/state.hpp"

namespace hilda::python {

/// A load on the bodies of a model, computed by a Python function of the state.
///
/// The function returns F, or (F, n_bar): arrays of the shape (bodies, 3) with the forces [N, global frame,
/// at the centres of mass] and the torques [N m, body frames]. An exception of the function ends the run. An
/// array of another shape, or with a number that is not finite, is a ValueError.
class PythonForce final : public dae::Force {
public:
    /// `potential`: function of the state that returns the potential energy [J], or None
    PythonForce(const std::string& name, py::object function, py::object potential, int bodies);

    void add(const lie::State& x, lie::Loads& out) const override;
    double potential_energy(const lie::State& x) const override;
    int last_body() const override { return bodies - 1; }

    /// For the garbage collector: a function may refer to the model that contains it.
    int visit(visitproc visitor, void* argument) const;
    void clear() { function = potential = py::none(); }

private:
    template <class Function>
    auto call(const lie::State& x, const char* what, const Function& function_of) const;
    void add(const py::handle& array, const char* what, std::vector<lie::Vec3>& out) const;

    py::object function, potential;
    int bodies;
    mutable StatePool pool;
};

}  // namespace hilda::python
