// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/simulation.hpp"

#include "dae/start.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "lie/integrator.hpp"
#include "python/bindings/model_function.hpp"
#include "python/bindings/model_run.hpp"
#include "python/bindings/signals.hpp"
#include "python/bindings/state.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hilda::python {

namespace {

constexpr io::Archive::Format format = {.letters = "HILDASIM", .version = 1};

/// Ends a run at the first node where a constraint row that was dropped as redundant is violated.
class DroppedRows final : public lie::Observer {
public:
    explicit DroppedRows(const dae::Model& model) : model(model) {}
    void accepted(const lie::State& x, long /*n*/, int /*iterations*/) override
    {
        dae::check_dropped_rows(model, x);
    }

private:
    const dae::Model& model;
};

/// A simulation that Python advances. A call during another one - of a function of the model, or of another
/// thread - is refused.
class SimulationObject {
public:
    SimulationObject(const py::object& model, RunArguments given)
        : core(model), arguments(std::move(given)), dropped(*core.cast<ModelPointer>()->description.model)
    {
        run = started();
        if (arguments.interval && !run->scheme().adaptive)
            throw io::UsageError("Simulation: interval is for adaptive steps; a fixed step has each node");
        arguments.warn = py::cpp_function([](const std::string&) {});  // a restored run has the same warnings
    }

    bool step()
    {
        return compute([&](Signals& /*signals*/) {
            if (simulation().number() >= simulation().grid().steps && !simulation().has_ended()) finish();
            return simulation().step();
        });
    }

    bool advance(double t)
    {
        return compute([&](Signals& signals) {
            const long target = node_at(t);
            while (simulation().number() < target)
                if (signals.raised() || !simulation().step()) return false;
            if (target >= simulation().grid().steps && !simulation().has_ended()) finish();
            return simulation().outcome().stopped_by.empty();
        });
    }

    StatePointer state() const
    {
        const Use use(*this);
        return std::make_shared<StateObject>(StateObject{simulation().state(), false});
    }
    StatePointer complete_state() const
    {
        const Use use(*this);
        return std::make_shared<StateObject>(StateObject{simulation().complete_node(), false});
    }
    double t() const
    {
        const Use use(*this);
        return simulation().state().t;
    }

    void set_loads(const py::object& F, const py::object& n_bar)
    {
        const Use use(*this);
        lie::Loads loads(bodies());
        for (const auto& [given, name, to] :
             {std::tuple{&F, "F", &loads.F}, std::tuple{&n_bar, "n_bar", &loads.n_bar}})
            if (!given->is_none()) read_array(*given, name, bodies(), 3, to->front().data());
        simulation().set_loads(loads);
    }
    py::tuple loads() const
    {
        const Use use(*this);
        const std::vector<double>& applied = simulation().state().applied_loads;
        const auto part = [&](size_t first) {
            py::array_t<double> array({static_cast<py::ssize_t>(bodies()), py::ssize_t{3}});
            double* to = array.mutable_data();
            std::fill_n(to, array.size(), 0.0);
            for (size_t k = first; k < applied.size(); k += 6) to = std::copy_n(applied.data() + k, 3, to);
            return array;
        };
        return py::make_tuple(part(0), part(3));
    }

    py::bytes checkpoint()
    {
        const Use use(*this);
        refuse_unless_resumes("checkpoint");
        if (!simulation().has_ended()) return bytes();
        if (simulation().outcome().status != "ok")
            throw io::UsageError("Simulation.checkpoint: the run has ended with the status " +
                                 simulation().outcome().status);
        return at_end;
    }
    void restore(const std::string& data)
    {
        const Use use(*this);
        const std::string place = "Simulation.restore";
        refuse_unless_resumes("restore");
        io::Archive a(format, data, place);
        run::RunSettings saved;
        a.map(saved);
        if (const std::string differs = run::difference(saved, run->identity(), "", ""); !differs.empty())
            throw io::UsageError(place + ": the checkpoint belongs to another run: " + differs);
        std::unique_ptr<ModelRun> restored = started();
        run::Simulation& of = *restored->simulation;
        of.transfer(a);
        a.end();
        if (of.number() > of.grid().steps)
            throw io::UsageError(fmt::format("{}: the checkpoint is at t = {} s, after the end {} s", place,
                                             of.state().t, end()));
        run = std::move(restored);
    }

    std::vector<std::string> warnings() const
    {
        const Use use(*this);
        return run->warnings();
    }
    /// Those of the steps that have not been returned before. The numbers in the text of a finding change.
    std::vector<std::string> new_warnings()
    {
        const Use use(*this);
        std::vector<std::string> texts;
        for (const run::Finding& found : run->findings())
            if (reported.insert(found.name).second) texts.push_back(found.text);
        return texts;
    }

    /// "running" until the run ends
    std::string status() const
    {
        const Use use(*this);
        return simulation().has_ended() ? simulation().outcome().status : "running";
    }
    py::object stopped_by() const
    {
        const Use use(*this);
        const std::string& name = simulation().outcome().stopped_by;
        return name.empty() ? py::object(py::none()) : py::cast(name);
    }
    py::dict statistics() const
    {
        const Use use(*this);
        return counters(simulation().has_ended() ? simulation().outcome().statistics
                                                 : simulation().statistics());
    }
    py::dict events() const
    {
        const Use use(*this);
        return run->event_tables.arrays(static_cast<size_t>(bodies()));
    }
    std::vector<std::string> names_of_events() const { return event_names(run->description); }
    std::string integrator() const { return run->scheme().name; }
    double interval() const { return simulation().grid().h; }
    double end() const { return last; }

    int visit(visitproc visit, void* arg) const
    {
        Py_VISIT(core.ptr());
        Py_VISIT(arguments.integrator.ptr());
        return 0;
    }

private:
    class Use {
    public:
        explicit Use(const SimulationObject& of) : of(of)
        {
            if (of.in_use)
                throw io::UsageError(
                    "Simulation: cannot be used by a function of its model or another thread during a call");
            of.in_use = true;
        }
        ~Use() { of.in_use = false; }
        Use(const Use&) = delete;

    private:
        const SimulationObject& of;
    };

    run::Simulation& simulation() const { return *run->simulation; }
    int bodies() const { return run->description.model->bodies(); }

    std::unique_ptr<ModelRun> started()
    {
        auto of = std::make_unique<ModelRun>(core.cast<ModelPointer>(), arguments, "Simulation");
        of->simulation->observe(dropped);
        last = static_cast<double>(of->simulation->grid().steps) * of->simulation->grid().h;
        return of;
    }

    /// The number of the node at the time t
    long node_at(double t) const
    {
        const double h = interval(), n = std::round(t / h), steps = std::round(last / h);
        const char* const spacing = run->scheme().adaptive ? "interval" : "step";
        if (!(std::abs(t / h - n) <= 1e-9 + 1e-15 * std::abs(n)))
            throw io::UsageError(
                std::isfinite(t)
                    ? fmt::format("Simulation.advance: t must be a multiple of the {} {} s, such as {} s or "
                                  "{} s, got {}",
                                  spacing, h, std::floor(t / h) * h, std::ceil(t / h) * h, t)
                    : fmt::format("Simulation.advance: t must be finite, got {}", t));
        if (n < static_cast<double>(simulation().number()) || n > steps)
            throw io::UsageError(
                fmt::format("Simulation.advance: t must be from the present time {} s to the "
                            "end {} s, got {}",
                            simulation().state().t, last, t));
        return static_cast<long>(n);
    }

    /// Calls f without the GIL. Ctrl-C ends the call between two steps.
    template <class Function>
    bool compute(const Function& f)
    {
        const Use use(*this);
        Signals signals;
        bool value = false;
        try {
            const py::gil_scoped_release release;
            value = f(signals);
        } catch (const lie::Interrupted&) {  // in a step of an adaptive scheme; the node is unchanged
        }
        if (signals.error()) throw py::error_already_set(*signals.error());
        return value;
    }

    /// Passes the last node to the events and the watch. An integrator may compute a further step for that.
    void finish()
    {
        if (run->scheme().resumes) at_end = bytes();
        const run::Outcome& outcome = simulation().run();
        if (outcome.status == "interrupted") throw lie::Interrupted();
        if (outcome.failed()) throw io::NumericalFailure(outcome.status, outcome.text());
    }

    std::string bytes()
    {
        io::Archive a(format);
        run::RunSettings settings = run->identity();
        a.map(settings);
        simulation().transfer(a);
        return a.bytes();
    }

    void refuse_unless_resumes(const char* function) const
    {
        if (!run->scheme().resumes)
            throw io::UsageError(
                fmt::format("Simulation.{}: {} stores past steps outside the state; checkpoints "
                            "need another integrator",
                            function, run->scheme().name));
    }

    const py::object core;  ///< the model, which the garbage collector follows
    RunArguments arguments;
    DroppedRows dropped;
    std::unique_ptr<ModelRun> run;
    double last = 0;                 ///< end of the grid [s]
    std::string at_end;              ///< checkpoint of the last node
    std::set<std::string> reported;  ///< names of findings
    mutable bool in_use = false;     ///< guarded by the GIL
};

/// Makes the model and the integrator visible to the garbage collector: their functions may refer to the
/// simulation. The model breaks such a cycle.
void collect(PyHeapTypeObject* heap_type)
{
    PyTypeObject& type = heap_type->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
        Py_VISIT(Py_TYPE(self));
        // No object yet while the constructor runs
        auto* instance = reinterpret_cast<py::detail::instance*>(self);
        if (!instance->get_value_and_holder().holder_constructed()) return 0;
        return py::cast<SimulationObject&>(py::handle(self)).visit(visit, arg);
    };
}

}  // namespace

void define_simulation(py::module_& m)
{
    py::class_<SimulationObject>(m, "_Simulation", py::custom_type_setup(&collect))
        .def(py::init([](const py::object& model, py::object integrator, std::optional<double> end,
                         std::optional<double> step, std::optional<double> interval,
                         std::map<std::string, std::string> settings, bool force, py::object warn) {
                 return std::make_unique<SimulationObject>(
                     model, RunArguments{std::move(integrator), end, step, interval, std::move(settings),
                                         force, std::move(warn)});
             }),
             py::arg("model"), py::arg("integrator"), py::arg("end"), py::arg("step"), py::arg("interval"),
             py::arg("settings"), py::arg("force"), py::arg("warn"))
        .def("step", &SimulationObject::step)
        .def("advance", &SimulationObject::advance, py::arg("t"))
        .def("complete_state", &SimulationObject::complete_state)
        .def("set_loads", &SimulationObject::set_loads, py::arg("F"), py::arg("n_bar"))
        .def("checkpoint", &SimulationObject::checkpoint)
        .def("restore", &SimulationObject::restore, py::arg("data"))
        .def("new_warnings", &SimulationObject::new_warnings)
        .def("events", &SimulationObject::events)
        .def_property_readonly("event_names", &SimulationObject::names_of_events)
        .def_property_readonly("state", &SimulationObject::state)
        .def_property_readonly("t", &SimulationObject::t)
        .def_property_readonly("loads", &SimulationObject::loads)
        .def_property_readonly("warnings", &SimulationObject::warnings)
        .def_property_readonly("status", &SimulationObject::status)
        .def_property_readonly("stopped_by", &SimulationObject::stopped_by)
        .def_property_readonly("statistics", &SimulationObject::statistics)
        .def_property_readonly("integrator", &SimulationObject::integrator)
        .def_property_readonly("interval", &SimulationObject::interval)
        .def_property_readonly("end", &SimulationObject::end);
}

}  // namespace hilda::python
