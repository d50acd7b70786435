// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/fit_command.hpp"

#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/option_values.hpp"
#include "io/program.hpp"
#include "io/provenance.hpp"
#include "lie/schemes.hpp"
#include "run/figures.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/setting_options.hpp"
#include "run/watch/run_check.hpp"
#include "studies/framework/table.hpp"
#include "studies/program/plot.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <optional>
#include <thread>

namespace hilda::studies {

namespace {

constexpr const char* fit_option = "--parameter";

/// The standard deviations of the columns
std::vector<double> sigma_of(const FitOptions& options, const std::vector<std::string>& columns)
{
    if (options.sigma.empty()) return {};
    std::vector<double> all(columns.size(), 0);
    for (const std::string& text : options.sigma) {
        const size_t equals = text.rfind('=');
        const double value =
            io::positive_number("--sigma", equals == std::string::npos ? text : text.substr(equals + 1));
        if (equals == std::string::npos) {
            for (double& one : all)
                if (one == 0) one = value;
            continue;
        }
        const auto at = std::find(columns.begin(), columns.end(), text.substr(0, equals));
        if (at == columns.end())
            throw io::UsageError("fit: --sigma: the data have no column '" + text.substr(0, equals) + "'");
        all[static_cast<size_t>(at - columns.begin())] = value;
    }
    for (size_t c = 0; c < columns.size(); ++c)
        if (all[c] == 0) throw io::UsageError("fit: --sigma: the column " + columns[c] + " has no value");
    return all;
}

io::Json array_of(const Eigen::VectorXd& v)
{
    io::Json all = io::Json::array();
    for (const double x : v) all.push_back(x);
    return all;
}

io::Json as_json(const run::FitResult& result, const run::FitProblem& problem, const FitOptions& options)
{
    io::Json all = {{"hilda_fit", 1L},
                    {"model", result.model.name},
                    {"data", problem.data.source},
                    {"integrator", problem.run.scheme->name}};
    if (problem.run.scheme->adaptive)
        all["rtol"] = problem.run.settings.rtol;
    else
        all["step"] = problem.run.step;
    all["columns"] = io::Json::array();
    for (size_t c = 0; c < result.units.size(); ++c)
        all["columns"].push_back({{"name", problem.data.columns[c]}, {"unit", result.units[c]}});
    all["parameters"] = io::Json::array();
    for (size_t k = 0; k < result.parameters.size(); ++k) {
        const run::FittedParameter& of = result.parameters[k];
        const run::FitParameter& from = problem.parameters[k];
        io::Json one = {{"pointer", of.pointer},   {"value", of.value},     {"error", of.error},
                        {"low_95", of.low_95},     {"high_95", of.high_95}, {"bias", of.bias},
                        {"at_bound", of.at_bound}, {"start", from.start}};
        if (std::isfinite(from.low)) one["low"] = from.low;
        if (std::isfinite(from.high)) one["high"] = from.high;
        all["parameters"].push_back(std::move(one));
    }
    all["covariance"] = io::Json::array();
    for (const auto& row : result.covariance.rowwise())
        all["covariance"].push_back(array_of(Eigen::VectorXd(row.transpose())));
    all["chi_squared"] = result.chi_squared;
    all["values"] = result.values;
    all["degrees_of_freedom"] = result.degrees_of_freedom;
    all["sigma_known"] = !problem.sigma.empty();
    all["sigma"] = result.sigma;
    all["singular_values"] = array_of(result.singular_values);
    all["iterations"] = result.iterations;
    all["runs"] = result.runs;
    all["converged"] = result.has_converged;
    all["reason"] = result.reason;
    all["warnings"] = result.warnings;
    all["provenance"] = run::provenance(options.command_line, problem.jobs);
    std::vector<std::string> files = result.model.files;
    files.push_back(options.data);
    all["provenance"]["inputs"] = io::inputs(files);
    return all;
}

/// Columns t, NAME.data and NAME.model
std::string table_of(const run::FitResult& result, const run::FitData& data)
{
    std::string all = "t";
    for (const std::string& name : data.columns)
        all += "," + io::csv_field(name + ".data") + "," + io::csv_field(name + ".model");
    all += '\n';
    for (size_t k = 0; k < data.t.size(); ++k) {
        io::append_number(all, data.t[k]);
        for (size_t c = 0; c < data.columns.size(); ++c) {
            const auto row = static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(c);
            all += ',';
            if (!std::isnan(data.values(row, column))) io::append_number(all, data.values(row, column));
            all += ',';
            io::append_number(all, result.samples.values(row, column));
        }
        all += '\n';
    }
    return all;
}

void print(const run::FitResult& result, const run::FitProblem& problem)
{
    std::cout << fmt::format(
        "{}: {}, {}, {} with {}\n", result.model.name, io::counted(result.values, "value"),
        io::counted(static_cast<long>(result.parameters.size()), "parameter"), problem.run.scheme->name,
        problem.run.scheme->adaptive ? fmt::format("rtol = {:g}", problem.run.settings.rtol)
                                     : fmt::format("h = {:g} s", problem.run.step));
    Table table({{"parameter", ""},
                 {"value", "{:.10g}"},
                 {"standard error", "{:.2e}"},
                 {"95 % from", "{:.8g}"},
                 {"to", "{:.8g}"},
                 {"by time steps", "{:.1e}"}});
    for (const run::FittedParameter& of : result.parameters)
        table.add({of.pointer, of.value, of.error, of.low_95, of.high_95, of.bias});
    StudyText text;
    table.print(text);
    const double condition =
        result.singular_values[0] / result.singular_values[result.singular_values.size() - 1];
    std::cout << text.str()
              << (problem.sigma.empty()
                      ? fmt::format("standard deviation of the data, estimated  {:.3g}\n", result.sigma)
                      : fmt::format("chi^2 / degrees of freedom  {:.3g}\n", result.sigma * result.sigma))
              << (std::isfinite(condition) ? fmt::format("condition  {:.3g}\n", condition) : "")
              << fmt::format("{}, {}: {}\n", io::counted(result.iterations, "iteration"),
                             io::counted(result.runs, "run"), result.reason);
}

run::FitProblem problem_of(const FitOptions& options)
{
    const lie::Scheme* scheme = &lie::scheme(options.integrator);
    if (!options.step) scheme = &scheme->with_adaptive_steps();
    run::check_step_options(*scheme, options.given_settings, options.step.has_value(), {});
    run::refuse_unused_settings("fit", options.given_settings, {scheme});
    run::FitProblem problem{.read =
                                [&options](std::span<const std::string> changes) {
                                    std::vector<std::string> all = options.set;
                                    all.insert(all.end(), changes.begin(), changes.end());
                                    return run::named_model(options.model, all, "", options.allow_paths);
                                },
                            .parameters = {},
                            .data = {},
                            .sigma = {},
                            .run = {.scheme = scheme,
                                    .step = options.step.value_or(run::default_step),
                                    .settings = options.settings,
                                    .fix_initial = options.fix_initial},
                            .max_iterations = options.max_fit_iterations,
                            .jobs = options.jobs > 0
                                        ? options.jobs
                                        : std::max(1, static_cast<int>(std::thread::hardware_concurrency())),
                            .progress = !options.quiet};
    const dae::Description model = problem.read({});
    for (const std::string& text : options.parameters)
        problem.parameters.push_back(fit_parameter(text, model));
    problem.data = run::read_fit_data(options.data, options.columns);
    problem.sigma = sigma_of(options, problem.data.columns);
    if (!options.quiet)
        for (const std::string& warning : model.warnings) io::warning(warning);
    return problem;
}

}  // namespace

run::FitParameter fit_parameter(const std::string& text, const dae::Description& model)
{
    const auto refuse = [&](const std::string& what) { io::refuse_option(fit_option, what, text); };
    const size_t equals = text.rfind('=');
    run::FitParameter all{.pointer = text.substr(0, equals)};
    if (all.pointer.empty() || all.pointer[0] != '/')
        refuse("expected /json/pointer=START:LOW:HIGH:SCALE, of which LOW, HIGH and SCALE may be left out");
    std::vector<std::string> parts;
    for (size_t begin = equals == std::string::npos ? text.size() + 1 : equals + 1; begin <= text.size();) {
        const size_t end = std::min(text.find(':', begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    if (parts.size() == 2 || parts.size() > 4)
        refuse("expected START, START:LOW:HIGH or START:LOW:HIGH:SCALE");
    double* const to[] = {&all.start, &all.low, &all.high, &all.scale};
    for (size_t k = 0; k < parts.size(); ++k) {
        if (parts[k].empty()) continue;
        *to[k] = io::finite_number_in(parts[k]);
        if (std::isnan(*to[k])) refuse("'" + parts[k] + "' is no finite number");
    }
    if (parts.size() == 4 && !parts[3].empty() && !(all.scale > 0)) refuse("SCALE must be positive");
    if (parts.empty() || parts[0].empty()) all.start = run::number_at(model, all.pointer);
    if (!(all.low < all.start && all.start < all.high))
        refuse(fmt::format("START must be between LOW and HIGH: {} < {} < {} is not true", all.low, all.start,
                           all.high));
    return all;
}

int fit_model(const FitOptions& options)
{
    const std::string directory = !options.output.empty() ? options.output
                                  : options.json          ? ""
                                                          : "out/fit-" + run::short_name(options.model);
    if (!directory.empty()) io::check_output_directory(directory, options.force, io::force_overwrites);
    if (options.parameters.empty())
        throw io::UsageError("fit: --parameter /json/pointer is required: the numbers that are fitted");
    const run::FitProblem problem = problem_of(options);
    std::optional<io::OutputLock> lock;
    if (!directory.empty()) lock.emplace(directory, options.force, io::force_overwrites).create();
    const run::FitResult result = fit(problem);
    const io::Json all = as_json(result, problem, options);
    if (options.json)
        std::cout << all.text();
    else if (!options.quiet)
        print(result, problem);
    for (const std::string& warning : result.warnings)
        if (!options.quiet) io::warning(warning);
    if (!directory.empty()) {
        run::remove_figure(directory, "fit.png");
        io::write_file(directory + "/model.json", result.model.text);
        io::write_file(directory + "/fit.csv", table_of(result, problem.data));
        io::write_file(directory + "/fit.json", all.text());
        if (options.plot) draw_figures("fit.py", directory, options.figure_formats);
        if (!options.quiet && !options.json) std::cout << "written to " << directory << '\n';
    }
    return result.has_converged ? io::exit_code::done : io::exit_code::numerical_failure;
}

}  // namespace hilda::studies
