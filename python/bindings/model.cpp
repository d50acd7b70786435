// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/model.hpp"

#include "io/files.hpp"
#include "io/json_source.hpp"
#include "lie/schemes.hpp"
#include "python/bindings/constraint.hpp"
#include "python/bindings/force.hpp"
#include "python/bindings/state.hpp"
#include "python/bindings/surface.hpp"
#include "run/named_model.hpp"
#include "run/watch/run_check.hpp"
#include "studies/framework/problem.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace hilda::python {

namespace {

using Names = std::vector<std::string>;
/// Name, function, potential energy or None
using Forces = std::vector<std::tuple<std::string, py::object, py::object>>;
/// Name, bodies i and j, number of rows, phi, variation, nu, gamma
using Constraints = std::vector<
    std::tuple<std::string, std::string, std::string, int, py::object, py::object, py::object, py::object>>;

/// What a model has besides its text
struct Parts {
    Forces forces;
    Constraints constraints;
    std::vector<py::object> surfaces;
};

int number_of(const dae::Model& of, const std::string& constraint, const std::string& body)
{
    try {
        return of.find(body);
    } catch (const lie::InvalidInput& error) {
        throw lie::InvalidInput("constraint '" + constraint + "': " + error.what());
    }
}

void add_constraints(ModelObject& model, const Constraints& constraints)
{
    dae::Description& of = model.description;
    for (const auto& [name, i, j, rows, phi, variation, nu, gamma] : constraints) {
        const std::string label = "constraint '" + name + "'";
        if (rows < 1 || rows > dae::Constraint::max_position_rows)
            throw lie::InvalidInput(fmt::format("{}: rows must be from 1 to {}, got {}", label,
                                                dae::Constraint::max_position_rows, rows));
        if (i == j) throw lie::InvalidInput(label + ": the bodies must be different, got '" + i + "' twice");
        auto constraint =
            std::make_unique<PythonConstraint>(number_of(*of.model, name, i), number_of(*of.model, name, j),
                                               rows, PythonConstraint::Functions{phi, variation, nu, gamma});
        model.functions.push_back(constraint.get());
        model.names_of_functions.push_back(name);
        of.model->constrain(name, std::move(constraint));
    }
}

/// `read` reads the model.
template <class Read>
ModelPointer started(const Read& read, const Parts& parts, bool fix_initial)
{
    auto model = std::make_shared<ModelObject>();
    {
        const SurfacesOfModel surfaces(parts.surfaces);
        model->description = read();
        for (const auto& surface : surfaces.made) model->functions.push_back(surface.get());
        for (const py::object& surface : parts.surfaces)
            model->names_of_functions.push_back(
                py::str(py::type::of(surface).attr("__name__")).cast<std::string>());
    }
    dae::Model& of = *model->description.model;
    add_constraints(*model, parts.constraints);
    const Forces& forces = parts.forces;
    for (const auto& [name, function, potential] : forces) {
        auto force = std::make_unique<PythonForce>(name, function, potential, of.bodies());
        model->functions.push_back(force.get());
        model->names_of_functions.push_back(name);
        of.load(std::move(force));
    }
    model->start = dae::start(model->description, {.fix_initial = fix_initial});
    return model;
}

/// Makes the functions of a model visible to the garbage collector.
void collect_functions(PyHeapTypeObject* heap_type)
{
    PyTypeObject& type = heap_type->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
        Py_VISIT(Py_TYPE(self));
        for (const ModelFunctions* force : py::cast<ModelObject&>(py::handle(self)).functions)
            if (const int result = force->visit(visit, arg); result != 0) return result;
        return 0;
    };
    type.tp_clear = [](PyObject* self) {
        for (ModelFunctions* force : py::cast<ModelObject&>(py::handle(self)).functions) force->clear();
        return 0;
    };
}

py::dict report(const ModelObject& model)
{
    const dae::StartReport& start = model.start;
    py::dict all;
    all["rows"] = model.description.model->rows();
    all["rank"] = start.rank;
    all["degrees_of_freedom"] = start.degrees_of_freedom;
    all["dropped"] = start.dropped;
    all["position_residual"] = start.position_residual;
    all["velocity_residual"] = start.velocity_residual;
    all["projected"] = start.projected;
    return all;
}

Names names_of_bodies(const ModelObject& m)
{
    Names names;
    for (const dae::Body& body : m.description.model->all_bodies()) names.push_back(body.name);
    return names;
}

py::dict properties(const lie::Scheme& scheme)
{
    py::dict all;
    all["name"] = scheme.name;
    all["description"] = scheme.description;
    all["order"] = scheme.order;
    all["order_lambda"] = scheme.order_lambda;
    all["formulation"] = scheme.formulation;
    all["source"] = scheme.source;
    all["adaptive"] = scheme.adaptive || scheme.adaptive_form != nullptr;
    all["supports"] = lie::keys_of(scheme.supports);
    all["options"] = scheme.with_adaptive_steps().option_names();
    return all;
}

}  // namespace

void define_model(py::module_& m)
{
    py::class_<ModelObject, ModelPointer>(m, "_Model", py::custom_type_setup(&collect_functions))
        .def_property_readonly("name", [](const ModelObject& model) { return model.description.name; })
        .def_property_readonly("end", [](const ModelObject& model) { return model.description.end; })
        .def_property_readonly("text", [](const ModelObject& model) { return model.description.text; })
        .def_property_readonly("warnings",
                               [](const ModelObject& model) { return model.description.warnings; })
        .def_property_readonly("bodies", &names_of_bodies)
        .def_property_readonly(
            "default_integrator",
            [](const ModelObject& model) { return run::default_integrator_of(*model.description.model); })
        .def_property_readonly("report", [](const ModelObject& model) { return report(model); })
        .def("state", [](const ModelObject& model) {
            return std::make_shared<StateObject>(StateObject{model.description.x, false});
        });
    m.def(
        "_read_named",
        [](const std::string& name, const Names& set, const Forces& forces, const Constraints& constraints,
           bool fix_initial, bool allow_paths) {
            return started([&] { return run::named_model(name, set, "", allow_paths); },
                           {forces, constraints, {}}, fix_initial);
        },
        py::arg("name"), py::arg("set"), py::arg("forces"), py::arg("constraints"), py::arg("fix_initial"),
        py::arg("allow_paths"));
    m.def(
        "_read_text",
        [](const std::string& text, const std::string& file, const Names& set, const std::string& folder,
           const std::string& within, const Forces& forces, const Constraints& constraints,
           const std::vector<py::object>& surfaces, bool fix_initial) {
            return started([&] { return dae::read_model(text, file, set, "", folder, within); },
                           {forces, constraints, surfaces}, fix_initial);
        },
        py::arg("text"), py::arg("file"), py::arg("set"), py::arg("folder"), py::arg("within"),
        py::arg("forces"), py::arg("constraints"), py::arg("surfaces"), py::arg("fix_initial"));
    m.def("_integrators", [] {
        py::list all;
        for (const lie::Scheme& scheme : lie::schemes()) all.append(properties(scheme));
        return all;
    });
    m.def("_problems", [] {
        std::vector<std::pair<std::string, std::string>> all;
        for (const studies::Problem& problem : studies::problems())
            all.emplace_back(problem.name, problem.what);
        return all;
    });
    m.def("_is_path", &run::is_model_path);
    m.def("_text_of", [](const std::string& name) {
        return run::is_model_path(name) ? io::read_file(name, io::JsonSource::max_bytes)
                                        : studies::problem(name).model;
    });
}

}  // namespace hilda::python
