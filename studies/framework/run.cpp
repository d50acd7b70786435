// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/run.hpp"

#include "contact/evolving/unilateral.hpp"
#include "dae/model_file.hpp"
#include "io/message.hpp"
#include "lie/integrator.hpp"
#include "lie/trajectory.hpp"
#include "run/diagnosis.hpp"
#include "run/watch/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <sstream>

namespace hilda::studies {

std::string Run::resolution() const
{
    return rtol > 0 ? "rtol = " + run::step_text(rtol) : "h = " + run::step_text(h) + " s";
}

std::string Run::name() const { return scheme->name + " on " + c->problem.name + " at " + resolution(); }

double thread_seconds()
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

lie::Settings settings_of(const Run& run, const lie::Settings& of_study)
{
    lie::Settings settings = of_study;
    if (run.rtol > 0) settings.rtol = run.rtol;
    return settings;
}

void march(Run& run, const lie::Settings& of_study, std::span<lie::Observer* const> observers)
{
    const dae::Description& d = *run.c->started;
    const double begin = thread_seconds();
    std::unique_ptr<lie::Integrator> integrator;
    std::optional<run::Watch> watch;
    const auto ended = [&](const std::string& status, const std::string& message) {
        run.status = status;
        run.message = message;
    };
    try {
        integrator = contact::make_integrator(*d.model, *run.scheme, settings_of(run, of_study));
        lie::March march(d.x, *integrator, run.h);
        lie::TimeGrid grid = lie::TimeGrid::over(run.c->end, run.h);
        grid.interval = std::max(1L, grid.steps);  // no rows: the energy is evaluated at every 16th node
        watch.emplace(*d.model, d.x, *integrator, *run.scheme, grid, run::Watch::Action::record);
        std::vector<lie::Observer*> all(observers.begin(), observers.end());
        all.push_back(&*watch);
        while (march.number() < grid.steps) march.advance(all);
        run.statistics =
            integrator
                ->statistics();  // before the additional step of finish(), which is not a step of the run
        run.seconds = thread_seconds() - begin;
        march.finish(all);
        run.findings = watch->text();
        return;
    } catch (const lie::NumericalFailure& failure) {
        ended(failure.status, failure.what());
    } catch (const lie::InvalidInput& refused) {  // the scheme does not support this model
        ended("refused", refused.what());
    }
    if (integrator) run.statistics = integrator->statistics();
    if (watch) run.findings = watch->text();
    run.seconds = thread_seconds() - begin;
}

namespace {

std::vector<std::string> lines_of(const std::string& text)
{
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
}

/// The findings of all runs, counted: "large_turn (3 runs), energy_rises (1 run)"; empty if there are none
std::string counted_findings(const std::vector<const Run*>& runs)
{
    std::map<std::string, long> number;
    for (const Run* run : runs)
        for (const std::string& line : lines_of(run->findings)) ++number[line.substr(0, line.find(':'))];
    std::string all;
    for (const auto& [name, count] : number)
        all += fmt::format("{}{} ({})", all.empty() ? "" : ", ", name, io::counted(count, "run"));
    return all;
}

}  // namespace

std::string failures(const std::vector<const Run*>& run_pointers)
{
    // Euler angles fail near their singular values with any step: one line for all such runs
    const std::string singular = "singular_parametrisation";
    std::vector<std::pair<std::string, int>> stopped;  // "reps-half-1 on slider_crank", number of runs
    std::string lines;
    for (const Run* m : run_pointers) {
        if (!m->failed()) continue;
        if (m->status != singular) {
            lines += fmt::format("{}: {}: {}\n", m->name(), m->status, m->message);
            continue;
        }
        const std::string series = m->scheme->name + " on " + m->c->problem.name;
        if (stopped.empty() || stopped.back().first != series) stopped.emplace_back(series, 0);
        ++stopped.back().second;
    }
    std::string names;
    for (const auto& [series, runs] : stopped)
        names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", series, runs);
    if (!stopped.empty())
        lines += fmt::format(
            "{} (number of runs): {}: the Euler angle phi is too close to a singular value, 0 or pi; "
            "use --reparametrise or an rA scheme\n",
            names, singular);
    std::string text = lines.empty() ? lines : "\nfailed:\n" + lines;
    if (const std::string findings = counted_findings(run_pointers); !findings.empty())
        text += "\nwarnings, in study.json for each run: " + findings + '\n';
    return text;
}

io::Json as_json(const Run& m)
{
    io::Json out = {{"problem", m.c->problem.name}, {"integrator", m.scheme->name}};
    if (m.rtol > 0)
        out["rtol"] = m.rtol;
    else
        out["h"] = m.h;
    out["status"] = m.status;
    if (!m.message.empty()) out["message"] = m.message;
    for (const std::string& line : lines_of(m.findings)) out["warnings"].push_back(line);
    return out;
}

}  // namespace hilda::studies
