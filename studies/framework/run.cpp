// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/run.hpp"

#include "dae/model_file.hpp"
#include "io/message.hpp"
#include "lie/trajectory.hpp"
#include "run/diagnosis.hpp"
#include "run/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

namespace hilda::studies {

std::string Run::resolution() const
{
    return rtol > 0 ? "rtol = " + run::step_text(rtol) : "h = " + run::step_text(h) + " s";
}

std::string Run::name() const { return scheme->name + " on " + c->problem.name + " at " + resolution(); }

lie::Settings settings_of(const Run& run, const lie::Settings& of_study)
{
    lie::Settings settings = of_study;
    if (run.rtol > 0) settings.rtol = run.rtol;
    return settings;
}

void march(Run& run, const lie::Settings& of_study, std::span<lie::Observer* const> observers)
{
    const dae::Description& d = *run.c->started;
    const double begin = run::thread_seconds();
    try {
        lie::TimeGrid grid = lie::TimeGrid::over(run.c->end, run.h);
        grid.interval = std::max(1L, grid.steps);  // no rows: the energy is evaluated at every 16th node
        run::Simulation simulation({.model = *d.model,
                                    .start = d.x,
                                    .scheme = *run.scheme,
                                    .grid = grid,
                                    .settings = settings_of(run, of_study),
                                    .watch = run::Watch::Action::record,
                                    .accept_unstable = true});
        for (lie::Observer* observer : observers) simulation.observe(*observer);
        const run::Outcome outcome = simulation.run();
        run.status = outcome.status;
        run.message = outcome.cause;
        run.statistics = outcome.statistics;
        for (const run::Finding& found : simulation.findings_of_solution())
            run.findings += found.name + ": " + found.text + '\n';
        run.seconds = outcome.setup_seconds + outcome.step_seconds;
        return;
    } catch (const lie::NumericalFailure& failure) {  // of the start
        run.status = failure.status, run.message = failure.what();
    } catch (const lie::InvalidInput& refused) {  // the scheme does not support this model
        run.status = "refused", run.message = refused.what();
    } catch (const io::UsageError& refused) {  // the run cannot be correct: see run::check_run()
        run.status = "refused", run.message = refused.what();
    }
    run.seconds = run::thread_seconds() - begin;
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
