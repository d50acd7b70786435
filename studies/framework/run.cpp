// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/run.hpp"

#include "contact/evolving/unilateral.hpp"
#include "studies/running/diagnosis.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <ctime>

namespace hilda::studies {

std::string Run::grain() const
{
    return rtol > 0 ? "rtol = " + step_text(rtol) : "h = " + step_text(h) + " s";
}

std::string Run::name() const { return scheme->name + " on " + c->problem.name + " at " + grain(); }

double thread_seconds()
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

lie::Settings settings_of(const Run& member, const lie::Settings& of_study)
{
    lie::Settings settings = of_study;
    if (member.rtol > 0) settings.rtol = member.rtol;
    return settings;
}

void march(Run& member, const lie::Settings& of_study, std::span<lie::Observer* const> observers)
{
    const dae::Description& d = *member.c->started;
    const double begin = thread_seconds();
    std::unique_ptr<lie::Integrator> integrator;
    const auto ended = [&](const std::string& status, const std::string& message) {
        member.status = status;
        member.message = message;
    };
    try {
        integrator = contact::make_integrator(*d.model, *member.scheme, settings_of(member, of_study));
        lie::March march(d.x, *integrator, member.h);
        const lie::TimeGrid grid = lie::TimeGrid::over(member.c->end, member.h);
        while (march.number() < grid.steps) march.advance(observers);
        member.statistics = integrator->statistics();  // the look ahead of finish() is no step of the run
        member.seconds = thread_seconds() - begin;
        march.finish(observers);
        return;
    } catch (const lie::NumericalFailure& failure) {
        ended(failure.status, failure.what());
    } catch (const lie::InvalidInput& refused) {  // a scheme that cannot take this model
        ended("refused", refused.what());
    }
    if (integrator) member.statistics = integrator->statistics();
    member.seconds = thread_seconds() - begin;
}

std::string failures(const std::vector<const Run*>& run_pointers)
{
    std::string lines;
    for (const Run* m : run_pointers)
        if (m->failed()) lines += fmt::format("{}: {}: {}\n", m->name(), m->status, m->message);
    return lines.empty() ? lines : "\nfailed:\n" + lines;
}

nlohmann::ordered_json as_json(const Run& m)
{
    nlohmann::ordered_json out = {{"problem", m.c->problem.name}, {"integrator", m.scheme->name}};
    if (m.rtol > 0)
        out["rtol"] = m.rtol;
    else
        out["h"] = m.h;
    out["status"] = m.status;
    if (!m.message.empty()) out["message"] = m.message;
    return out;
}

}  // namespace hilda::studies
