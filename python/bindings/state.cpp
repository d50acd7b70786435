// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/state.hpp"

#include "lie/steps/state_numbers.hpp"

namespace hilda::python {

namespace {

/// An array of the memory at `first`, with these sizes and strides. `owner` is the Python object of the
/// state.
py::array view(const py::object& owner, bool writable, double* first, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides)
{
    py::array_t<double> array(std::move(shape), std::move(strides), first, owner);
    if (!writable) array.attr("setflags")(py::arg("write") = false);
    return array;
}

template <lie::Vec3 lie::Motion::*vector>
py::array motion_vectors(const py::object& self)
{
    auto& state = self.cast<StateObject&>();
    std::vector<lie::Motion>& body = state.x.body;
    double* const first = body.empty() ? nullptr : (body[0].*vector).data();
    return view(self, state.writable, first, {static_cast<py::ssize_t>(body.size()), 3},
                {sizeof(lie::Motion), sizeof(double)});
}

py::array orientations(const py::object& self)
{
    auto& state = self.cast<StateObject&>();
    std::vector<lie::Motion>& body = state.x.body;
    double* const first = body.empty() ? nullptr : body[0].A.data();
    return view(self, state.writable, first, {static_cast<py::ssize_t>(body.size()), 3, 3},
                {sizeof(lie::Motion), sizeof(double), 3 * sizeof(double)});  // stored by columns
}

py::array multipliers(const py::object& self)
{
    auto& state = self.cast<StateObject&>();
    return view(self, state.writable, state.x.lambda.data(), {state.x.lambda.size()}, {sizeof(double)});
}

}  // namespace

void define_state(py::module_& m)
{
    py::class_<StateObject, StatePointer>(m, "State", R"(The state of a mechanical system.

The arrays share the memory of the state. Those of an observer or a force are read-only.)")
        .def_property(
            "t", [](const StateObject& s) { return s.x.t; },
            [](StateObject& s, double t) {
                if (!s.writable) throw py::value_error("the state is read-only: use a copy, x.copy()");
                s.x.t = t;
            },
            "Time [s]")
        .def_property_readonly("r", &motion_vectors<&lie::Motion::r>,
                               "Positions of the centres of mass [m], global frame; shape (bodies, 3)")
        .def_property_readonly("rdot", &motion_vectors<&lie::Motion::rdot>,
                               "Velocities of the centres of mass [m/s], global frame; shape (bodies, 3)")
        .def_property_readonly("rddot", &motion_vectors<&lie::Motion::rddot>,
                               "Accelerations [m/s^2], global frame; shape (bodies, 3)")
        .def_property_readonly(
            "A", &orientations,
            "Rotation matrices from the body frames to the global frame; shape (bodies, 3, 3)")
        .def_property_readonly("omega_bar", &motion_vectors<&lie::Motion::omega_bar>,
                               "Angular velocities [rad/s], body frames; shape (bodies, 3)")
        .def_property_readonly("omegadot_bar", &motion_vectors<&lie::Motion::omegadot_bar>,
                               "Angular accelerations [rad/s^2], body frames; shape (bodies, 3)")
        .def_property_readonly("lambda_", &multipliers, "Multipliers of the constraint rows; shape (rows,)")
        .def(
            "copy",
            [](const StateObject& s) {
                return std::make_shared<StateObject>(StateObject{s.x, true});
            },
            "An independent copy, whose arrays may be written to.");
}

StatePool::Lent::Lent(StatePool& pool, const lie::State& x) : pool(pool)
{
    if (pool.free.empty()) {
        state = py::cast(std::make_shared<StateObject>());
    } else {
        state = std::move(pool.free.back());
        pool.free.pop_back();
    }
    auto& to = state.cast<StateObject&>();
    to.writable = false;
    lie::copy(x, to.x);
}

StatePool::Lent::~Lent()
{
    // A state of which Python has kept a reference, or an array, remains that of this call.
    if (state.ref_count() == 1) pool.free.push_back(std::move(state));
}

}  // namespace hilda::python
