// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study_context.hpp"

#include "io/error.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "run/recording/setting_options.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

StudyContext::StudyContext(const Study& study, const StudyOptions& options, run::FinishedJobs* finished)
    : name(study.name), keys(study.keys), options(options), settings(options.settings),
      problems(options.problems), set(options.set), output(options.output), against(options.against),
      grid(options.grid), jobs_at_once(options.jobs), repeats(options.repeats), check(options.check),
      quiet(options.quiet), finished(finished),
      sharing(
          std::make_unique<run::JobSharing>(run::JobSharing{.finished = finished, .shard = options.shard}))
{}

bool StudyContext::is_given(const std::string& option) const
{
    return std::find(options.given.begin(), options.given.end(), option) != options.given.end();
}

void StudyContext::refuse(const std::string& what) const
{
    throw io::UsageError("study " + name + ": " + what);
}

Schemes StudyContext::schemes(const std::vector<std::string>& defaults) const
{
    Schemes selected;
    for (const std::string& scheme : options.integrators) selected.push_back(&lie::scheme(scheme));
    if (selected.empty()) {
        for (const std::string& scheme : defaults)
            for (const lie::Scheme& s : lie::schemes())
                if (s.name == scheme) selected.push_back(&s);
        if (defaults.empty())
            for (const lie::Scheme& s : lie::schemes())
                if (!s.needs_tree) selected.push_back(&s);  // for all mechanisms
    }
    for (const lie::Scheme*& scheme : selected)
        for (const std::string& option : options.given)
            if (!scheme->uses_option(option) && scheme->with_adaptive_steps().uses_option(option))
                scheme = &scheme->with_adaptive_steps();
    Schemes users = selected;
    if (!options.reference.empty()) users.push_back(&lie::scheme(options.reference).with_adaptive_steps());
    run::refuse_unused_settings("study " + name, options.given, users);
    return selected;
}

Schemes StudyContext::fixed_step_schemes(const std::vector<std::string>& defaults) const
{
    Schemes fixed;
    for (const lie::Scheme* s : schemes(defaults)) {
        if (!s->adaptive)
            fixed.push_back(s);
        else if (!options.integrators.empty())
            refuse(s->name +
                   " chooses its own steps by --rtol and --atol; hilda study "
                   "work-precision compares it with the others");
    }
    return fixed;
}

std::vector<double> StudyContext::steps(const std::vector<double>& defaults) const
{
    std::vector<double> all = options.steps.empty() ? defaults : options.steps;
    std::sort(all.rbegin(), all.rend());
    return all;
}

double StudyContext::one_step(double defaults) const
{
    if (options.steps.size() > 1)
        refuse("--steps takes one step, got " + std::to_string(options.steps.size()));
    return options.steps.empty() ? defaults : options.steps.front();
}

std::vector<Benchmark> StudyContext::benchmarks(const std::vector<std::string>& defaults,
                                                const std::vector<double>& steps, const DefaultEnd& end) const
{
    std::vector<Benchmark> all = studies::benchmarks(name, options, defaults, end);
    for (const Benchmark& c : all) check_steps(name, c, steps);
    return all;
}

run::Pool StudyContext::pool(size_t jobs, const std::string& label, int threads) const
{
    return {threads > 0 ? threads : options.jobs, options.quiet ? "" : name + label, static_cast<long>(jobs),
            sharing.get()};
}

void StudyContext::job(const std::function<void()>& job,
                       const std::function<void(io::Archive&)>& transfer) const
{
    run::JobSharing here{.finished = finished};
    run::Pool(1, "", 1, &here).run([&](long) { job(); }, [&](io::Archive& a, long) { transfer(a); });
}

void StudyContext::jobs(long count, const std::function<void(long)>& job,
                        const run::Pool::Transfer& transfer) const
{
    run::Pool(1, "", count, sharing.get()).run(job, transfer);
}

void StudyContext::evaluate(const std::vector<Criterion>& criteria)
{
    if (criteria.empty())
        io::message("hilda: warning: --check: there is no criterion for these problems and integrators\n");
    criteria_passed = studies::evaluate(criteria, text, json);
}

io::Json StudyContext::measure(const std::string& of,
                               const std::vector<std::pair<std::string, double>>& values)
{
    Measured& m = measured.emplace_back(Measured{.of = of, .value = {}});
    io::Json object = io::Json::object();
    for (const auto& [key, value] : values) m.value[key] = value, object[key] = value;
    return object;
}

void StudyContext::end_of_runs(const std::vector<const Run*>& runs)
{
    failed_runs = failures(runs);
    for (const Run* run : runs)
        if (const size_t end = run->findings.find(": "); end != std::string::npos)
            warned(run->findings.substr(0, end),
                   run->name() + run->findings.substr(end, run->findings.find('\n') - end));
    const auto has_failed = [](const Run* run) { return run->failed(); };
    const auto failed = static_cast<size_t>(std::count_if(runs.begin(), runs.end(), has_failed));
    if (failed == 0 || (failed < runs.size() && !every_run_must_succeed)) return;
    const Run& first = **std::find_if(runs.begin(), runs.end(), has_failed);
    const std::string all = io::counted(static_cast<long>(runs.size()), "run");
    numerical_failure = fmt::format("hilda: error[{}]: study {}: {} failed; {}: {}\n", first.status, name,
                                    runs.size() == 1       ? "its run"
                                    : failed < runs.size() ? fmt::format("{} of {}", failed, all)
                                                           : "all " + all,
                                    first.name(), first.message);
}

void StudyContext::warned(const std::string& warning, const std::string& text)
{
    if (options.strict && numerical_failure.empty())
        numerical_failure =
            fmt::format("hilda: error[{}]: study {}: {} (a warning, with --strict)\n", warning, name, text);
}

void check_parts(const StudyContext& study, const std::string& what, const std::vector<std::string>& known)
{
    for (const std::string& name : study.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            study.refuse("unknown " + what + io::with_nearest(name, known));
}

SceneOptions scene_options(StudyContext& s, double h, double end, const std::string& grid)
{
    SceneOptions o{s.one_step(h), s.options.end.value_or(end),
                   s.options.preset.empty() ? "dissertation" : s.options.preset};
    s.json = {{"preset", o.preset}, {"h", o.h}, {"end", o.end}, {"grid", grid}};
    return o;
}

}  // namespace hilda::studies
