// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/model_run.hpp"

#include "io/archive.hpp"
#include "io/json.hpp"
#include "python/bindings/integrator.hpp"
#include "python/bindings/settings.hpp"
#include "python/bindings/signals.hpp"
#include "run/recording/setting_options.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace hilda::python {

ModelRun::ModelRun(const ModelPointer& of, const RunArguments& arguments, const char* command)
    : model(of), description(model->description)
{
    const bool in_python = !py::isinstance<py::str>(arguments.integrator);
    if (in_python) own = scheme_of(arguments.integrator);
    used = in_python ? &own : &lie::scheme(arguments.integrator.cast<std::string>());
    if (!arguments.step) used = &used->with_adaptive_steps();
    settings =
        settings_of(command, *used, arguments.settings, arguments.step.has_value(), arguments.interval);
    settings.stop = &Signals::raised_in_run;
    const double end = arguments.end.value_or(description.end);
    const dae::Model& system = *description.model;
    simulation = std::make_unique<run::Simulation>(run::SimulationSetup{
        .model = system,
        .start = description.x,
        .scheme = *used,
        .grid = run::time_grid(*used, end, arguments.step, arguments.interval),
        .settings = settings,
        .accept_unstable = arguments.force,
        .end = end,
        .interval = arguments.interval.value_or(0),
        .dropped_rows = model->start.dropped,
        .description = &description,
        .event_table = &event_tables,
        .integrator = in_python ? std::make_unique<PythonIntegrator>(arguments.integrator, system) : nullptr,
        .warn = [&](const run::Finding& found) { arguments.warn(found.text); }});
}

run::RunSettings ModelRun::identity() const
{
    run::RunSettings all = run::given_settings(settings, *used);
    all["model"] = fmt::format("{:016x}", io::checksum(description.text.data(), description.text.size()));
    if (!model->functions.empty())
        all["functions"] = fmt::format("{}", fmt::join(model->names_of_functions, ", "));
    all["--integrator"] = used->name;
    all[used->adaptive ? "--interval" : "--step"] = io::shortest(simulation->grid().h);
    return all;
}

std::vector<run::Finding> ModelRun::findings() const
{
    std::vector<run::Finding> all;
    if (simulation->has_ended() && simulation->events() != nullptr && !simulation->events()->fault().empty())
        all.push_back({"event_not_finite", simulation->events()->fault()});
    for (run::Finding& found : simulation->findings()) all.push_back(std::move(found));
    return all;
}

std::vector<std::string> ModelRun::warnings() const
{
    std::vector<std::string> all;
    for (const run::Finding& found : simulation->warnings()) all.push_back(found.text);
    for (const run::Finding& found : findings()) all.push_back(found.text);
    return all;
}

py::dict counters(const lie::Statistics& of)
{
    py::dict all;
    all["steps"] = of.steps;
    all["iterations"] = of.iterations;
    all["factorizations"] = of.factorizations;
    all["refactorizations"] = of.refactorizations;
    all["friction_relaxed"] = of.friction_relaxed;
    all["restitution_reduced"] = of.restitution_reduced;
    return all;
}

std::vector<std::string> event_names(const dae::Description& of)
{
    std::vector<std::string> all;
    for (const dae::Event& event : of.events) all.push_back(event.value->name);
    return all;
}

}  // namespace hilda::python
