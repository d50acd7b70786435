// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/fit.hpp"

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "python/bindings/settings.hpp"
#include "run/fitting/fit.hpp"
#include "run/named_model.hpp"
#include "run/watch/run_check.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <optional>

namespace hilda::python {

namespace py = pybind11;

namespace {

using Names = std::vector<std::string>;

/// Pointer, start or None for that of the model, low, high, scale
using Parameter = std::tuple<std::string, std::optional<double>, double, double, double>;

struct Source {
    std::string name;    ///< of a built-in model or a file; not used with a text
    std::string text;    ///< of a model file; "": the model has a name
    std::string folder;  ///< of the files that the text names
    Names set;
    bool allow_paths;  ///< of a file
};

dae::Description read(const Source& from, std::span<const std::string> changes)
{
    Names all = from.set;
    all.insert(all.end(), changes.begin(), changes.end());
    return from.text.empty() ? run::named_model(from.name, all, "", from.allow_paths)
                             : dae::read_model(from.text, "model", all, "", from.folder);
}

/// Runs the fit on another thread, and handles the signals of Python meanwhile.
run::FitResult run_fit(run::FitProblem& problem)
{
    std::atomic<bool> is_stopped = false;
    problem.stop = &is_stopped;
    std::optional<py::error_already_set> signal;
    std::future<run::FitResult> result;
    {
        const py::gil_scoped_release release;
        result = std::async(std::launch::async, [&problem] { return run::fit(problem); });
        while (result.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
            if (is_stopped) continue;
            const py::gil_scoped_acquire gil;
            if (PyErr_CheckSignals() == 0) continue;
            signal.emplace();
            is_stopped = true;
        }
    }
    try {
        run::FitResult all = result.get();
        if (!signal) return all;
    } catch (...) {
        if (!signal) throw;
    }
    throw std::move(*signal);
}

py::dict as_dict(const run::FitResult& result)
{
    py::dict all;
    const auto n = static_cast<Eigen::Index>(result.parameters.size());
    Eigen::VectorXd value(n), error(n), bias(n);
    Eigen::MatrixXd interval(n, 2);
    std::vector<bool> at_bound;
    for (Eigen::Index k = 0; k < n; ++k) {
        const run::FittedParameter& of = result.parameters[static_cast<size_t>(k)];
        value[k] = of.value, error[k] = of.error, bias[k] = of.bias;
        interval.row(k) << of.low_95, of.high_95;
        at_bound.push_back(of.at_bound);
    }
    all["value"] = value;
    all["error"] = error;
    all["bias"] = bias;
    all["interval"] = interval;
    all["at_bound"] = at_bound;
    all["covariance"] = result.covariance;
    all["chi_squared"] = result.chi_squared;
    all["sigma"] = result.sigma;
    all["degrees_of_freedom"] = result.degrees_of_freedom;
    all["singular_values"] = result.singular_values;
    all["directions"] = result.directions;
    all["fitted"] = result.samples.values;
    all["units"] = result.units;
    all["name"] = result.model.name;
    all["text"] = result.model.text;
    all["iterations"] = result.iterations;
    all["runs"] = result.runs;
    all["converged"] = result.has_converged;
    all["reason"] = result.reason;
    all["warnings"] = result.warnings;
    return all;
}

py::dict fit(const Source& source, const std::vector<Parameter>& parameters, run::FitData data,
             std::vector<double> sigma, const std::string& integrator, std::optional<double> step,
             const std::map<std::string, std::string>& settings, bool fix_initial, int max_iterations,
             int jobs)
{
    run::FitProblem problem;
    problem.read = [&source](std::span<const std::string> changes) { return read(source, changes); };
    problem.data = std::move(data);
    problem.sigma = std::move(sigma);
    problem.max_iterations = max_iterations;
    problem.jobs = jobs;
    run::SampledRunOptions& options = problem.run;
    options.scheme = &lie::scheme(integrator);
    if (!step) options.scheme = &options.scheme->with_adaptive_steps();
    options.step = step.value_or(run::default_step);
    options.fix_initial = fix_initial;
    options.settings = settings_of("fit", *options.scheme, settings, step.has_value(), {});
    std::optional<dae::Description> model;  // read if a start is not stated
    for (const auto& [pointer, start, low, high, scale] : parameters) {
        if (!start && !model) model = problem.read({});
        problem.parameters.push_back({.pointer = pointer,
                                      .start = start ? *start : run::number_at(*model, pointer),
                                      .low = low,
                                      .high = high,
                                      .scale = scale});
    }
    return as_dict(run_fit(problem));
}

}  // namespace

void define_fit(py::module_& m)
{
    m.def(
        "_fit_data",
        [](const std::string& path, const Names& columns) {
            const run::FitData data = run::read_fit_data(path, columns);
            return py::make_tuple(py::cast(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                      data.t.data(), static_cast<Eigen::Index>(data.t.size())))),
                                  data.columns, data.values);
        },
        py::arg("path"), py::arg("columns"));
    m.def(
        "_fit",
        [](const std::string& name, const std::string& text, const std::string& folder, const Names& set,
           const std::vector<Parameter>& parameters, const std::string& of_data, std::vector<double> t,
           Names columns, const Eigen::MatrixXd& values, std::vector<double> sigma,
           const std::string& integrator, std::optional<double> step,
           const std::map<std::string, std::string>& settings, bool fix_initial, bool allow_paths,
           int max_iterations, int jobs) {
            return fit(
                {name, text, folder, set, allow_paths}, parameters,
                {.source = of_data, .t = std::move(t), .columns = std::move(columns), .values = values},
                std::move(sigma), integrator, step, settings, fix_initial, max_iterations, jobs);
        },
        py::arg("name"), py::arg("text"), py::arg("folder"), py::arg("set"), py::arg("parameters"),
        py::arg("source"), py::arg("t"), py::arg("columns"), py::arg("values"), py::arg("sigma"),
        py::arg("integrator"), py::arg("step"), py::arg("settings"), py::arg("fix_initial"),
        py::arg("allow_paths"), py::arg("max_iterations"), py::arg("jobs"));
}

}  // namespace hilda::python
