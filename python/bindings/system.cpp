// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/system.hpp"

#include "dae/model.hpp"
#include "io/error.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"
#include "python/bindings/model.hpp"
#include "python/bindings/state.hpp"

#include <fmt/format.h>

namespace hilda::python {

namespace {

using Array = py::array_t<double>;
using Given = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The model, with its saddle matrix at the state that was factored last
struct SystemObject {
    explicit SystemObject(ModelPointer model)
        : model(std::move(model)), system(*this->model->description.model),
          K(system, lie::Metric::mass, lie::LinearSolver::automatic), loads(system.bodies()), z(K.size())
    {}
    ModelPointer model;
    const dae::Model& system;
    lie::Saddle K;
    lie::Loads loads;
    Eigen::VectorXd z;
    long factored = 0;  ///< number of factorisations
};
using SystemPointer = std::shared_ptr<SystemObject>;

/// K(x) of one state. The matrix of the system is factored again for another state: this one is then refused.
struct SaddleObject {
    SystemPointer of;
    long number;
};

py::ssize_t bodies(const SystemObject& s) { return s.system.bodies(); }

Array rows(const SystemObject& s, const StateObject& at,
           void (dae::Model::*function)(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const)
{
    Eigen::VectorXd value(s.system.rows());
    (s.system.*function)(at.x, value);
    return Array(value.size(), value.data());
}

Array vectors(const std::vector<lie::Vec3>& of)
{
    Array array({static_cast<py::ssize_t>(of.size()), py::ssize_t{3}});
    double* to = array.mutable_data();
    for (const lie::Vec3& v : of) to = std::copy_n(v.data(), 3, to);
    return array;
}

py::tuple loads(SystemObject& s, const StateObject& at)
{
    s.system.loads(at.x, s.loads);
    return py::make_tuple(vectors(s.loads.F), vectors(s.loads.n_bar));
}

Array masses(const SystemObject& s)
{
    const std::vector<double>& m = s.system.mass().m;
    return Array(static_cast<py::ssize_t>(m.size()), m.data());
}

Array inertias(const SystemObject& s)
{
    Array array({bodies(s), py::ssize_t{3}, py::ssize_t{3}});
    double* to = array.mutable_data();
    for (const lie::Mat3& J : s.system.mass().J_bar) to = std::copy_n(J.data(), 9, to);  // symmetric
    return array;
}

Array jacobian(const SystemObject& s, const StateObject& at)
{
    lie::Rows C = s.system.pattern();
    s.system.variation(at.x, C);
    Array array({static_cast<py::ssize_t>(C.rows()), bodies(s), py::ssize_t{6}});
    std::fill_n(array.mutable_data(), array.size(), 0.0);
    auto to = array.mutable_unchecked<3>();
    for (int k = 0; k < C.rows(); ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 3; ++c) {
                to(k, C.entry[n].body, c) += C.entry[n].r[c];
                to(k, C.entry[n].body, c + 3) += C.entry[n].pi[c];
            }
    return array;
}

void require_writable(const StateObject& at)
{
    if (!at.writable) throw py::value_error("the state is read-only: use a copy, x.copy()");
}

void set_accelerations(SystemObject& s, StateObject& at)
{
    require_writable(at);
    s.K.assemble(at.x);
    ++s.factored;
    lie::solve_accelerations(s.system, s.K, at.x, s.loads, s.z);
}

void project(SystemObject& s, StateObject& at)
{
    require_writable(at);
    ++s.factored;
    lie::project_positions(s.system, s.K, at.x, 1e-12);
    lie::project_velocities(s.system, s.K, at.x);
}

SaddleObject saddle(const SystemPointer& s, const StateObject& at)
{
    s->K.assemble(at.x);
    return {s, ++s->factored};
}

/// Copies an array of this size to `to`.
void take(const Given& from, py::ssize_t size, const char* name, double* to)
{
    if (from.size() != size)
        throw py::value_error(fmt::format("{} must have {} numbers, got {}", name, size, from.size()));
    std::copy_n(from.data(), size, to);
}

py::tuple solve(const SaddleObject& K, const Given& f, const Given& g)
{
    SystemObject& s = *K.of;
    if (K.number != s.factored)
        throw py::value_error(
            "the saddle matrix of another state has been factored since; call saddle(x) again");
    const py::ssize_t motion = 6 * bodies(s), rows = s.system.rows();
    take(f, motion, "f", s.z.data());
    take(g, rows, "g", s.z.data() + motion);
    s.K.solve(s.z);
    Array v({bodies(s), py::ssize_t{6}});
    std::copy_n(s.z.data(), motion, v.mutable_data());
    return py::make_tuple(v, Array(rows, s.z.data() + motion));
}

}  // namespace

void define_system(py::module_& m)
{
    py::class_<SaddleObject>(m, "Saddle", "The saddle matrix K of a state, factored.")
        .def("solve", &solve, py::arg("f"), py::arg("g"),
             R"(Solves M v + C^T lambda = f, C v = g.

f has the shape (bodies, 6): forces [N, global frame] and torques [N m, body frame]; g the shape (rows,).
Returns v, shape (bodies, 6), and lambda, shape (rows,).)");
    py::class_<SystemObject, SystemPointer>(m, "System", R"(The equations of motion of a model:

M v' + C^T lambda = (F, n_bar - omega_bar x J omega_bar),   Phi(r, A, t) = 0,   v = (rdot, omega_bar))")
        .def(py::init([](const ModelPointer& model) {
                 const lie::Rows& C = model->description.model->pattern();
                 if (C.algebraic_variables() > 0 || C.velocity_rows > 0 || !C.unilateral.empty() ||
                     model->description.model->keeps_redundant_rows() ||
                     model->description.model->has_cones())
                     throw io::InvalidInput(
                         "integrators in Python take models without contacts as constraints, "
                         "rolling without slip, redundant rows and rigid contacts");
                 return std::make_shared<SystemObject>(model);
             }),
             py::keep_alive<1, 2>())  // the garbage collector must not clear functions that this object calls
        .def_property_readonly("bodies", &bodies, "Number of bodies")
        .def_property_readonly(
            "rows", [](const SystemObject& s) { return s.system.rows(); }, "Number of constraint rows")
        .def_property_readonly("mass", &masses, "Masses [kg]; shape (bodies,)")
        .def_property_readonly("inertia", &inertias, "Inertias [kg m^2], body frames; shape (bodies, 3, 3)")
        .def("loads", &loads, py::arg("x"),
             "F [N, global frame] and n_bar [N m, body frames] in the state x; shapes (bodies, 3)")
        .def(
            "phi", [](const SystemObject& s, const StateObject& x) { return rows(s, x, &dae::Model::phi); },
            py::arg("x"), "Phi(r, A, t); shape (rows,)")
        .def(
            "nu", [](const SystemObject& s, const StateObject& x) { return rows(s, x, &dae::Model::nu); },
            py::arg("x"), "Right side of C v = nu; shape (rows,)")
        .def(
            "gamma",
            [](const SystemObject& s, const StateObject& x) { return rows(s, x, &dae::Model::gamma); },
            py::arg("x"), "Right side of C v' = gamma; shape (rows,)")
        .def("jacobian", &jacobian, py::arg("x"),
             "C = (Phi_r, Pi): derivatives by (r, theta_bar) with A exp(theta_bar~); shape (rows, bodies, 6)")
        .def("saddle", &saddle, py::arg("x"),
             "The saddle matrix of x, factored, until that of another state is")
        .def("set_accelerations", &set_accelerations, py::arg("x"),
             "Sets rddot, omegadot_bar and lambda_ of x from the saddle matrix of x.")
        .def("project", &project, py::arg("x"),
             "Projects positions, then velocities of x onto the constraints, shortest in the metric of the "
             "mass.");
}

}  // namespace hilda::python
