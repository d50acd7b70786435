// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/run.hpp"

#include "contact/evolving/unilateral.hpp"
#include "dae/model_file.hpp"
#include "studies/running/diagnosis.hpp"

#include <fmt/format.h>

#include <ctime>

namespace hilda::studies {

std::string Run::resolution() const
{
    return rtol > 0 ? "rtol = " + step_text(rtol) : "h = " + step_text(h) + " s";
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
    const auto ended = [&](const std::string& status, const std::string& message) {
        run.status = status;
        run.message = message;
    };
    try {
        integrator = contact::make_integrator(*d.model, *run.scheme, settings_of(run, of_study));
        lie::March march(d.x, *integrator, run.h);
        const lie::TimeGrid grid = lie::TimeGrid::over(run.c->end, run.h);
        while (march.number() < grid.steps) march.advance(observers);
        run.statistics =
            integrator
                ->statistics();  // before the additional step of finish(), which is not a step of the run
        run.seconds = thread_seconds() - begin;
        march.finish(observers);
        return;
    } catch (const lie::NumericalFailure& failure) {
        ended(failure.status, failure.what());
    } catch (const lie::InvalidInput& refused) {  // the scheme does not support this model
        ended("refused", refused.what());
    }
    if (integrator) run.statistics = integrator->statistics();
    run.seconds = thread_seconds() - begin;
}

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
    return lines.empty() ? lines : "\nfailed:\n" + lines;
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
    return out;
}

}  // namespace hilda::studies
