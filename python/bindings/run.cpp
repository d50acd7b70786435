// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/run.hpp"

#include "io/error.hpp"
#include "lie/integrator.hpp"
#include "python/bindings/errors.hpp"
#include "python/bindings/model_run.hpp"
#include "python/bindings/signals.hpp"
#include "python/bindings/state.hpp"
#include "run/columns/output_columns.hpp"
#include "run/recording/setting_options.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>

namespace hilda::python {

namespace {

using Array = py::array_t<double>;

/// Writes the output rows of a run into arrays that Python owns. The arrays have their final size from the
/// start.
class Rows final : public lie::Observer {
public:
    Rows(const dae::Description& description, const lie::TimeGrid& grid, bool with_reactions,
         const std::vector<std::string>& columns)
        : model(*description.model), grid(grid), bodies(static_cast<size_t>(model.bodies())),
          multipliers(static_cast<size_t>(model.rows())), with_reactions(with_reactions), C(model.pattern()),
          reactions(bodies), columns(columns.size())
    {
        if (!columns.empty()) observed.emplace(model, description.outputs, "run", columns);
        const auto n = grid.steps / grid.interval + 1 + (grid.steps % grid.interval != 0 ? 1 : 0);
        const auto b = static_cast<py::ssize_t>(bodies);
        t = make("t", {n});
        energy = make("energy", {n});
        for (Vectors& v : vectors) v.to = make(v.name, {n, b, 3});
        A = make("A", {n, b, 3, 3});
        lambda = make("lambda_", {n, static_cast<py::ssize_t>(multipliers)});
        if (with_reactions) F = make("reaction_F", {n, b, 3}), T = make("reaction_T", {n, b, 3});
        if (observed) values = make("columns", {n, static_cast<py::ssize_t>(columns.size())});
    }

    void accepted(const lie::State& x, long n, int /*iterations*/) override
    {
        const double residual = model.largest_residual(x).value;
        if (!(residual <= constraint_norm)) constraint_norm = residual;
        if (grid.is_row(n) && n > last) write(x), last = n;
        dae::check_dropped_rows(model, x);
    }

    const py::dict& arrays() const { return all; }
    size_t number() const { return rows; }
    double constraint_norm = 0;  ///< largest scaled residual of all nodes [m or rad]

private:
    void write(const lie::State& x)
    {
        t[rows] = x.t;
        energy[rows] = lie::energy(model, x);
        for (const Vectors& v : vectors) {
            double* to = v.to + 3 * bodies * rows;
            for (const lie::Motion& body : x.body) to = std::copy_n((body.*v.of).data(), 3, to);
        }
        double* to = A + 9 * bodies * rows;
        for (const lie::Motion& body : x.body)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) *to++ = body.A(i, j);
        std::copy_n(x.lambda.data(), multipliers, lambda + multipliers * rows);
        if (with_reactions) {
            dae::reactions(model, x, C, reactions);
            for (size_t b = 0; b < bodies; ++b) {
                std::copy_n(reactions[b].F.data(), 3, F + 3 * (bodies * rows + b));
                std::copy_n(reactions[b].T.data(), 3, T + 3 * (bodies * rows + b));
            }
        }
        if (observed) observed->values(x, values + columns * rows);
        ++rows;
    }

    double* make(const char* name, std::vector<py::ssize_t> shape)
    {
        Array array(std::move(shape));
        all[name] = array;
        return array.mutable_data();
    }

    struct Vectors {
        const char* name;
        lie::Vec3 lie::Motion::*of;
        double* to = nullptr;
    };
    Vectors vectors[5] = {{"r", &lie::Motion::r},
                          {"rdot", &lie::Motion::rdot},
                          {"rddot", &lie::Motion::rddot},
                          {"omega_bar", &lie::Motion::omega_bar},
                          {"omegadot_bar", &lie::Motion::omegadot_bar}};
    const dae::Model& model;
    const lie::TimeGrid& grid;
    const size_t bodies, multipliers;
    const bool with_reactions;
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
    py::dict all;
    const size_t columns;  ///< number of them
    std::optional<run::ObservedColumns> observed;
    double *t, *energy, *A, *lambda, *F = nullptr, *T = nullptr, *values = nullptr;
    size_t rows = 0;
    long last = -1;
};

/// Calls a Python function with each node. The run ends if it returns True.
class PythonObserver final : public lie::Observer {
public:
    explicit PythonObserver(py::object function) : function(std::move(function)) {}

    void accepted(const lie::State& x, long /*n*/, int /*iterations*/) override
    {
        if (stopped) return;  // the node after the last one
        const py::gil_scoped_acquire gil;
        try {
            const StatePool::Lent lent(pool, x);
            const int truth = PyObject_IsTrue(function(lent.object()).ptr());
            if (truth < 0) throw py::error_already_set();
            stopped = truth == 1;
        } catch (const py::error_already_set& error) {
            add_note(error, fmt::format("in the observer at t = {} s", x.t));
            throw;
        }
    }

    bool stopped = false;

private:
    py::object function;
    StatePool pool;
};

/// What a run leaves besides its arrays
struct Ended {
    run::Outcome outcome;
    py::object error = py::none();  ///< exception that ended the run
};

py::object with_traceback(const py::error_already_set& error)
{
    return error.trace() ? error.value().attr("with_traceback")(error.trace()) : error.value();
}

/// Exceptions of Python code - observers, forces, integrators - are not failures of the simulation. They do
/// not replace one: code beyond the failure may have raised them.
Ended march(run::Simulation& simulation, const PythonObserver* observer)
{
    Ended ended;
    Signals signals;
    const auto next = [&] {
        using Next = run::Simulation::Next;
        if (signals.raised()) return Next::interrupt;
        return observer != nullptr && observer->stopped ? Next::stop : Next::step;
    };
    std::string raised;  // status of an exception
    try {
        const py::gil_scoped_release release;
        simulation.run(next);
    } catch (const py::error_already_set& error) {
        raised = error.matches(PyExc_KeyboardInterrupt) ? "interrupted" : "error";
        ended.error = with_traceback(error);
    } catch (const std::exception&) {
        raised = "error";
        ended.error = python_error(std::current_exception());
    }
    run::Outcome& out = ended.outcome = simulation.outcome();
    if (out.failed())
        ended.error = numerical_failure(lie::NumericalFailure(out.status, out.cause), out.text());
    else if (!raised.empty())
        out.status = raised;
    else if (out.status == "ok" && observer != nullptr && observer->stopped)
        out.status = "stopped";
    if (signals.error()) {
        out.status = "interrupted";
        ended.error = with_traceback(*signals.error());
    }
    return ended;
}

/// The names, with those of a group in place of its name
std::vector<std::string> column_names(const dae::Description& of, const std::vector<std::string>& given)
{
    std::vector<std::string> all;
    const auto add = [&](const run::ColumnGroup& group) {
        for (const dae::Quantity& column : group.columns) all.push_back(column.name);
    };
    for (const std::string& name : given)
        if (name == "forces")
            add(*run::force_columns(*of.model));
        else if (name == "contacts")
            add(*run::contact_columns(*of.model));
        else if (name == "outputs")
            add(run::OutputColumns(*of.model, of.outputs));
        else
            all.push_back(name);
    return all;
}

py::dict run(const ModelPointer& model, const RunArguments& arguments, bool reactions,
             const std::vector<std::string>& groups, const py::object& function)
{
    const dae::Description& of = model->description;
    const std::vector<std::string> columns = column_names(of, groups);
    ModelRun of_model(model, arguments, "run");
    run::Simulation& simulation = *of_model.simulation;
    Rows rows(of, simulation.grid(), reactions, columns);
    simulation.observe(rows);
    std::unique_ptr<PythonObserver> observer;
    if (!function.is_none()) {
        observer = std::make_unique<PythonObserver>(function);
        simulation.observe_checked(*observer);
    }
    const Ended ended = march(simulation, observer.get());
    const run::Outcome& out = ended.outcome;
    py::dict result;
    result["arrays"] = rows.arrays();
    result["columns"] = columns;
    result["events"] = of_model.event_tables.arrays(static_cast<size_t>(of.model->bodies()));
    result["event_names"] = event_names(of);
    result["stopped_by"] = out.stopped_by.empty() ? py::object(py::none()) : py::cast(out.stopped_by);
    result["seconds"] = out.step_seconds;
    result["rows"] = rows.number();
    result["status"] = out.status;
    result["error"] = ended.error;
    result["t_end"] = out.t;
    result["integrator"] = of_model.scheme().name;
    result["step"] =
        of_model.scheme().adaptive ? py::object(py::none()) : py::object(py::float_(simulation.grid().h));
    result["statistics"] = counters(out.statistics);
    result["constraint_norm"] = rows.constraint_norm;
    const std::vector<std::string> warnings = of_model.warnings();
    const auto before = static_cast<std::ptrdiff_t>(simulation.warnings().size());
    result["warnings"] = warnings;
    result["findings"] = std::vector<std::string>(warnings.begin() + before, warnings.end());
    return result;
}

}  // namespace

void define_run(py::module_& m)
{
    m.attr("default_integrator") = run::default_integrator;
    m.def("setting_is_switch", [] {
        py::dict all;
        for (const run::SettingOption& option : run::setting_options())
            all[py::str(option.key())] = option.is_switch();
        return all;
    });
    m.def(
        "_run",
        [](const ModelPointer& model, py::object integrator, std::optional<double> end,
           std::optional<double> step, std::optional<double> interval,
           std::map<std::string, std::string> settings, bool force, py::object warn, bool reactions,
           const std::vector<std::string>& columns, const py::object& observer) {
            return run(
                model,
                {std::move(integrator), end, step, interval, std::move(settings), force, std::move(warn)},
                reactions, columns, observer);
        },
        py::arg("model"), py::arg("integrator"), py::arg("end"), py::arg("step"), py::arg("interval"),
        py::arg("settings"), py::arg("force"), py::arg("warn"), py::arg("reactions"), py::arg("columns"),
        py::arg("observer"));
}

}  // namespace hilda::python
