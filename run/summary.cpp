// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/summary.hpp"

#include "contact/evolving/unilateral.hpp"
#include "dae/model_file.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/provenance.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "run/columns/contact_rows.hpp"
#include "run/diagnosis.hpp"
#include "run/provenance.hpp"
#include "run/recording/setting_options.hpp"
#include "run/run_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

namespace hilda::run {

namespace {

double per_step(const lie::Statistics& s)
{
    return static_cast<double>(s.iterations) / static_cast<double>(std::max(1L, s.steps));
}

std::string event_name(contact::ContactEvent::Type type)
{
    using Type = contact::ContactEvent::Type;
    return type == Type::lift_off  ? "lift-off"
           : type == Type::impact  ? "impact"
           : type == Type::closing ? "closing"
                                   : "fallback";
}

}  // namespace

void describe(RunResult& r, const RunOptions& options, const lie::Scheme& scheme,
              const dae::Description& description, const lie::TimeGrid& grid)
{
    r.model = description.name;
    r.integrator = scheme.name;
    r.step = grid.h;
    r.interval = static_cast<double>(grid.interval) * grid.h;
    r.settings = settings_json(options.settings, &scheme);
    if (scheme.adaptive) {
        r.rtol = options.settings.rtol;
        r.atol = options.settings.atol > 0 ? options.settings.atol : options.settings.rtol;
    }
    r.bodies = description.model->bodies();
    r.rigid_contacts = static_cast<int>(description.model->rigid_contacts().size());
    r.constraints = description.model->constraints();
    for (const contact::EvolvingContact* c : evolving_contacts(*description.model))
        r.contacts.push_back(c->name);
    r.set = description.changes;
    r.parameters = description.parameters;
    r.command_line = options.command_line;
    std::vector<std::string> inputs = options.inputs;
    inputs.insert(inputs.end(), description.files.begin(), description.files.end());
    r.inputs = io::inputs(inputs);
    r.threads = 1;  // the number used, independent of --threads
}

std::vector<RunResult::Event> contact_events(const lie::Integrator& integrator, const dae::Model& model,
                                             double t)
{
    std::vector<RunResult::Event> all;
    if (const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(&integrator))
        for (const contact::ContactEvent& e : unilateral->events())
            if (e.t <= t)
                all.push_back({e.t, model.general_constraints()[static_cast<size_t>(e.contact)]->name,
                               event_name(e.type), e.speed});
    return all;
}

io::Json summary(const RunResult& r)
{
    io::Json out = {{"status", r.status}, {"exit_code", r.exit_code}};
    if (!r.message.empty()) out["message"] = r.message;
    out["model"] = {{"name", r.model},
                    {"bodies", r.bodies},
                    {"constraints", r.constraints},
                    {"rows", r.start.rows},
                    {"rank", r.start.rank},
                    {"degrees_of_freedom", r.start.degrees_of_freedom},
                    {"dropped_rows", r.start.dropped},
                    {"initial_position_residual", r.start.position_residual},
                    {"initial_velocity_residual", r.start.velocity_residual},
                    {"initial_projected", r.start.projected},
                    {"set", r.set},
                    {"warnings", r.warnings}};
    for (const auto& [name, value] : r.parameters) out["model"]["parameters"][name] = value;
    out["integrator"] = {{"name", r.integrator}};
    if (r.rtol > 0)
        out["integrator"].update(
            {{"rtol", r.rtol}, {"atol", r.atol}, {"end", r.end}, {"interval", r.interval}});
    else
        out["integrator"].update({{"step", r.step}, {"end", r.end}, {"interval", r.interval}});
    for (const io::Json::Member& setting : *r.settings.members())
        if (out["integrator"].member(setting.key) == nullptr) out["integrator"][setting.key] = setting.value;
    out["counters"] = {{"steps", r.statistics.steps},
                       {"newton_iterations", r.statistics.iterations},
                       {"factorizations", r.statistics.factorizations},
                       {"refactorizations", r.statistics.refactorizations},
                       {"rows", r.invariants.rows},
                       {"t", r.t}};
    if (r.rigid_contacts > 0)
        out["rigid_contacts"] = {{"iterations", r.statistics.cone_iterations},
                                 {"factorizations", r.statistics.cone_factorizations},
                                 {"law_residual", r.statistics.cone_residual},
                                 {"overlap", r.statistics.overlap},
                                 {"friction_relaxed", r.statistics.friction_relaxed},
                                 {"restitution_reduced", r.statistics.restitution_reduced}};
    out["invariants"] = {{"constraint_norm", r.invariants.constraint_norm},
                         {"orthogonality", r.invariants.orthogonality},
                         {"energy_start", r.invariants.energy_start},
                         {"energy_end", r.invariants.energy_end},
                         {"energy_drift", r.invariants.energy_drift},
                         {"energy_drift_end", r.invariants.energy_end - r.invariants.energy_start}};
    out["watch"] = r.watch;
    if (r.error) out["error_estimate"] = r.error->json();
    if (!r.contacts.empty()) {
        out["contacts"] = io::Json::array();
        for (size_t k = 0; k < r.invariants.contact.size(); ++k) {
            const ContactExtremes& c = r.invariants.contact[k];
            out["contacts"].push_back({{"name", r.contacts[k]},
                                       {"normal_force_least", c.F_N_least},
                                       {"normal_force_most", c.F_N_most},
                                       {"lambda_N", c.lambda_N}});
        }
    }
    if (!r.located.empty()) {
        out["events"] = io::Json::array();
        for (const EventCount& e : r.located) {
            io::Json event = {{"name", e.name}, {"count", e.count}};
            if (e.count > 0) event["last"] = e.last;
            out["events"].push_back(event);
        }
    }
    if (!r.stopped_by.empty()) out["stopped_by"] = r.stopped_by;
    if (!r.events.empty()) {
        constexpr size_t most = 1000;  // a bouncing ball that comes to rest causes many events
        out["contact_events"] = {{"count", r.events.size()}, {"first", io::Json::array()}};
        for (size_t k = 0; k < std::min(most, r.events.size()); ++k) {
            const RunResult::Event& e = r.events[k];
            out["contact_events"]["first"].push_back(
                {{"t", e.t}, {"contact", e.contact}, {"what", e.what}, {"speed", e.speed}});
        }
    }
    out["files"] = r.files;
    out["timing"] = {{"setup_seconds", r.setup_seconds},
                     {"wall_seconds", r.wall_seconds},
                     {"steps_per_second",
                      r.wall_seconds > 0 ? static_cast<double>(r.statistics.steps) / r.wall_seconds : 0}};
    out["provenance"] = provenance(r.command_line, r.threads);
    out["provenance"]["inputs"] = r.inputs;
    if (r.resumed_at >= 0) out["provenance"]["resumed_at_step"] = r.resumed_at;
    return out;
}

void print(const RunResult& r, std::ostream& out)
{
    const auto line = [&](const char* what, const std::string& text) {
        out << fmt::format("{:<14}{}\n", what, text);
    };
    line("model",
         fmt::format(
             "{}: {}, {}, {}{} of freedom", r.model, io::counted(r.bodies, "body", "bodies"),
             io::counted(r.start.rows, "constraint row"),
             r.contacts.empty() ? "" : io::counted(static_cast<long>(r.contacts.size()), "contact") + ", ",
             io::counted(r.start.degrees_of_freedom, "degree")));
    const std::string resolution = r.rtol > 0
                                       ? fmt::format("rtol {}, atol {}", step_text(r.rtol), step_text(r.atol))
                                       : fmt::format("step {} s", step_text(r.step));
    line("integrator", fmt::format("{}, {}, end {:g} s", r.integrator, resolution, r.end));
    if (r.status != "ok") line("status", fmt::format("{} at t = {:g} s", r.status, r.t));
    line("steps",
         fmt::format("{}, {:.2f} iterations per step, {}, {}", r.statistics.steps, per_step(r.statistics),
                     io::counted(r.statistics.factorizations, "factorization"),
                     io::counted(r.statistics.refactorizations, "refactorization")));
    line("energy",
         fmt::format("{:.6e} J at the start, {:.6e} J at the end, largest change {:.1e} J",
                     r.invariants.energy_start, r.invariants.energy_end, r.invariants.energy_drift));
    line("constraints", fmt::format("{:.1e} m or rad, largest residual", r.invariants.constraint_norm));
    for (size_t k = 0; k < r.invariants.contact.size(); ++k)
        if (r.invariants.contact[k].F_N_least > r.invariants.contact[k].F_N_most)
            line(k == 0 ? "contacts" : "", r.contacts[k] + ": no row");
        else
            line(k == 0 ? "contacts" : "",
                 fmt::format("{}: F_N from {:.6g} to {:.6g} N", r.contacts[k],
                             r.invariants.contact[k].F_N_least, r.invariants.contact[k].F_N_most));
    if (r.rigid_contacts > 0)
        line("contact law", fmt::format("{:.1e} m/s, largest residual; overlap at most {:.1e} of a size",
                                        r.statistics.cone_residual, r.statistics.overlap));
    for (const EventCount& e : r.located)
        line(&e == r.located.data() ? "events" : "",
             e.name + ": " +
                 (e.count == 0 ? "none"
                               : fmt::format("{}, the last at t = {:.12g} s{}", e.count, e.last,
                                             e.name == r.stopped_by ? ", which ends the run" : "")));
    line("orthogonality", fmt::format("{:.1e} largest |A'A - I|", r.invariants.orthogonality));
    if (r.error) {
        line("errors", r.error->text());
        for (const std::string& doubt : r.error->doubts) line("", "not reliable: " + doubt);
    }
    line("wall time",
         fmt::format("{:.3f} s, {:.0f} steps/s", r.wall_seconds,
                     r.wall_seconds > 0 ? static_cast<double>(r.statistics.steps) / r.wall_seconds : 0));
    std::string files;
    for (const std::string& file : r.files) files += (files.empty() ? "" : ", ") + file;
    line("written", fmt::format("{} in {}: {}", io::counted(r.invariants.rows, "row"), r.directory, files));
}

}  // namespace hilda::run
