// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/benchmark.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace hilda::studies {

namespace {

dae::Description read(const Problem& problem, const std::vector<std::string>& set,
                      const StudyOptions& options)
{
    const std::string within = problem.file.empty() || options.allow_paths
                                   ? ""
                                   : std::filesystem::absolute(problem.file).parent_path().string();
    return dae::read_model(problem.model, problem.file.empty() ? problem.name : problem.file, set,
                           options.normal_rows, problem.folder, within);
}

}  // namespace

double end_of_model(const dae::Description& d) { return d.end; }

dae::Description read_and_start(const Benchmark& benchmark, const StudyOptions& options)
{
    dae::Description d = read(benchmark.problem, benchmark.set, options);
    dae::start(d, {.fix_initial = options.fix_initial});
    return d;
}

Benchmark make_benchmark(Problem problem, const StudyOptions& options, const DefaultEnd& end)
{
    dae::Description d = read(problem, options.set, options);
    const dae::StartReport report = dae::start(d, {.fix_initial = options.fix_initial});
    if (!options.quiet) {
        for (const std::string& w : d.warnings) io::warning(w);
        for (const std::string& row : report.dropped)
            io::warning(problem.name + ": " + row +
                        ": redundant with the constraints before it, dropped from the equations");
    }
    Benchmark c;
    c.set = options.set;
    c.end = options.end ? *options.end : end(d);
    c.observable = problem.observable;
    if (c.observable.body.empty()) c.observable.body = d.model->all_bodies().back().name;
    c.instants.dt = c.end / static_cast<double>(c.instants.count);
    c.reference_name = problem.reference_name;
    c.problem = std::move(problem);
    c.started = std::make_shared<const dae::Description>(std::move(d));
    return c;
}

std::vector<Benchmark> benchmarks(const std::string& kind, const StudyOptions& options,
                                  const std::vector<std::string>& defaults, const DefaultEnd& end)
{
    std::vector<Benchmark> all;
    for (const std::string& name : options.problems.empty() ? defaults : options.problems) {
        all.push_back(make_benchmark(problem_or_file(name), options, end));
        for (size_t k = 0; k + 1 < all.size(); ++k)
            if (all[k].problem.name == all.back().problem.name)
                throw io::UsageError("study " + kind + ": two problems are called '" + all[k].problem.name +
                                     "'");
    }
    return all;
}

namespace {

bool divides(double h, double end)
{
    const double steps = std::round(end / h);
    return steps >= 1 && std::abs(end / h - steps) <= 1e-6;
}

/// io::UsageError for a step above the stability limit of a force, as in hilda run
void check_stable(const std::string& kind, const Benchmark& c, const std::vector<double>& steps)
{
    const dae::Model& model = *c.started->model;
    const dae::Model::StableStep stable = model.stable_step(c.started->x, lie::LoadEvaluation::implicit);
    for (const double h : steps)
        if (!(h <= stable.h))
            throw io::UsageError(
                fmt::format("study {}: {}: the step {} s is above {:.3g} s, the stability limit of {} "
                            "in an explicit step; --steps sets others",
                            kind, c.problem.name, h, stable.h, model.force_of(stable.force)->label()));
}

}  // namespace

void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps, double most)
{
    check_stable(kind, c, steps);
    for (const double h : steps)
        if (!(h <= most * (1 + 1e-9)) || !divides(h, c.end))
            throw io::UsageError(fmt::format(
                "study {}: --steps must divide the end of {}, {} s, and be at most {:.4g} s, got {}", kind,
                c.problem.name, c.end, most, h));
}

void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps)
{
    check_stable(kind, c, steps);
    for (const double h : steps)
        if (!divides(h, c.end))
            throw io::UsageError(fmt::format("study {}: --steps must divide the end of {}, {} s, got {}",
                                             kind, c.problem.name, c.end, h));
}

}  // namespace hilda::studies
