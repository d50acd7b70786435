// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/run_summary.hpp"

#include "granular/case/case_file.hpp"
#include "granular/running/watch_report.hpp"
#include "granular/stages/stages.hpp"

namespace hilda::granular {

namespace {

io::Json insertions(const Insertions& of, double t, double h)
{
    io::Json all = io::Json::array();
    for (const Insertion& i : of.all) {
        io::Json one = {{"name", i.what().name},
                        {"particles", static_cast<long>(i.count())},
                        {"mass", i.mass()},
                        {"due_mass", i.due_mass(t)}};
        if (const std::string text = i.shortfall(t, h); !text.empty()) one["warning"] = text;
        all.push_back(std::move(one));
    }
    return all;
}

}  // namespace

io::Json run_summary(const RunOptions& options, const Case& c, const ChangeHistory& history,
                     const RunEnd& end)
{
    const World& w = *c.world;
    io::Json s = {{"status", end.status}, {"exit_code", end.code}};
    if (!end.message.empty()) s["message"] = end.message;
    s["case"] = {{"name", c.name},
                 {"particles", w.count()},
                 {"boundaries", c.boundaries.size()},
                 {"step", c.h},
                 {"end", c.end},
                 {"interval", c.interval},
                 {"frame_interval", c.frame_interval},
                 {"set", c.source.changes},
                 {"warnings", c.notices}};
    s["counters"] = {{"steps", w.steps()}, {"rebuilds", w.rebuilds()}, {"rows", end.rows}, {"t", w.t()}};
    if (w.removes())
        s["outflow"] = {{"particles", static_cast<long>(w.outflow().count)}, {"mass", w.outflow().mass}};
    if (c.insertions != nullptr) s["insertions"] = insertions(*c.insertions, w.t(), c.h);
    if (!history.all.empty()) s["changes"] = history.summary();
    if (c.stages != nullptr) s["stages"] = c.stages->summary(w.t());
    if (c.groups != nullptr) s["groups"] = c.groups->names;
    s["kinetic_energy"] = w.kinetic_energy();
    s["watch"] = watch_summary(w.watch());
    s["files"] = end.files;
    s["timing"] = {{"wall_seconds", end.seconds},
                   {"steps_per_second", static_cast<double>(w.steps() - end.resumed_at) / end.seconds},
                   {"particle_steps_per_second", end.particle_steps / end.seconds}};
    s["provenance"] = options.provenance;
    s["provenance"]["bytes_per_particle"] =
        w.count() > 0 ? static_cast<double>(w.bytes()) / static_cast<double>(w.count()) : 0;
    if (end.resumed_at > 0) s["provenance"]["resumed_at_step"] = end.resumed_at;
    return s;
}

}  // namespace hilda::granular
