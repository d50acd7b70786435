// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/stages.hpp"

#include "granular/case/continued_case.hpp"
#include "granular/stages/case_changes.hpp"
#include "io/archive.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hilda::granular {

namespace {

/// Number of the particles that can move and of the clumps
std::size_t free_bodies(const World& w)
{
    std::size_t number = w.clumps().size();
    w.each_particle([&](const Particle& p) { number += !p.fixed && p.clump < 0 ? 1 : 0; });
    return number;
}

}  // namespace

Stages::Stages(const Case& c, const Environment& environment) : spec(c.stage_specs), h(c.h)
{
    Environment here = environment;
    check_ends(c);
    here.settings.clear(), here.seed.reset(), here.continues = nullptr, here.with_particles = false;
    io::JsonSource source = c.source;
    for (std::size_t k = 0; k < spec.size(); ++k) {
        Change& change = changes.emplace_back();
        if (spec[k].set.empty()) continue;
        try {
            change = read_change(c, source, spec[k], here);
        } catch (const io::PlacedError& e) {
            c.source.fail("/stages/" + std::to_string(k) + "/set",
                          (e.pointer.empty() ? "/" : e.pointer) + ": " + e.reason);
        }
    }
}

/// Throws io::PlacedError for a stage whose end cannot be after its start.
void Stages::check_ends(const Case& c) const
{
    long earliest = 0;  // start of the stage [steps]; a stage with a condition may end soon
    for (std::size_t k = 0; k < spec.size(); ++k) {
        const StageSpec& s = spec[k];
        if (s.end && steps_in(*s.end) <= earliest)
            c.source.fail(
                "/stages/" + std::to_string(k) + "/end",
                io::formatted("end must be after the stages before, which last until t = %.9g s, got %.9g",
                              static_cast<double>(earliest) * h, *s.end));
        if (s.until) continue;
        if (s.duration) earliest += steps_in(*s.duration);
        if (s.end) earliest = steps_in(*s.end);
    }
}

/// Applies what a stage sets to the source of the case and reads the result.
Stages::Change Stages::read_change(const Case& c, io::JsonSource& source, const StageSpec& s,
                                   const Environment& environment)
{
    Change change;
    const io::JsonSource before(io::written(source.root), "", std::size_t{1} << 28);
    for (const auto& [name, value] : s.set) {
        change.pointers.push_back(with_numbers(source.root, name));
        source.set(change.pointers.back() + '=' + io::written(value), "stage '" + s.name + '\'');
    }
    const io::JsonSource after(io::written(source.root), "", std::size_t{1} << 28);
    for (const CaseChange& entry : changes_of(before.root, after.root)) {
        if (!entry.is_possible(ChangeIn::stage))
            source.fail(entry.pointer, "cannot be set by a stage; " + changeable_entries(ChangeIn::stage));
        change.pointers.push_back(entry.pointer);  // also below an entry that is set as a whole
    }
    change.to = parameters_of(read_case(source, environment));
    check_parameters(c, change.to, change.pointers);
    return change;
}

void Stages::each_step_limit(World& w,
                             const std::function<void(const std::string&, const World::StepLimits&)>& f) const
{
    const std::vector<PairLaw> laws = w.all_laws();
    for (std::size_t k = 0; k < changes.size(); ++k) {
        if (changes[k].pointers.empty()) continue;
        w.set_laws(changes[k].to.laws);
        f("/stages/" + std::to_string(k) + "/set", w.step_limits());
    }
    w.set_laws(laws);
}

std::vector<int> Stages::moving() const
{
    std::vector<int> all;
    for (const Change& change : changes)
        all.insert(all.end(), change.to.moving.begin(), change.to.moving.end());
    return all;
}

long Stages::steps_in(double time) const { return granular::steps_in(time, h); }

void Stages::begin_run(Case& c, const Warn& warn)
{
    begin(c);
    report_selections(*c.world, warn);
}

/// Begins the next stage at the present instant.
void Stages::begin(Case& c)
{
    const std::size_t k = log.size();
    log.push_back({.start = c.world->steps()});
    largest_energy = 0, is_met.reset();
    if (!changes[k].pointers.empty()) {
        set_parameters(c, changes[k].to, changes[k].pointers, c.world->t());
        begin_change(c, changes[k].to, changes[k].pointers);
    }
    select(c);
}

/// Assigns particles to groups and removes particles, at the start of the present stage.
void Stages::select(Case& c)
{
    without_particles.clear();
    for (const auto& [name, selections] : what().groups) {
        const std::vector<std::uint32_t> ids = selected(*c.world, c.groups.get(), selections);
        c.groups->assign(ids, c.groups->number(name));
        if (ids.empty()) without_particles.push_back(name);
    }
    if (what().remove.empty()) return;
    const auto before = static_cast<std::int64_t>(c.world->count());
    c.world->remove(selected(*c.world, c.groups.get(), what().remove));
    log.back().removed = before - static_cast<std::int64_t>(c.world->count());
}

/// Warns if the present stage, which has just begun, removes particles or assigns them to groups and has
/// found none.
void Stages::report_selections(const World& w, const Warn& warn) const
{
    for (const std::string& name : without_particles)
        warn("stage_groups",
             io::formatted(
                 "stage '%s': groups: no particle is in the groups and regions of '%s' at t = %.9g s",
                 what().name.c_str(), name.c_str(), w.t()));
    if (!what().remove.empty() && log.back().removed == 0)
        warn("stage_remove",
             io::formatted("stage '%s': remove: no particle is in its groups and regions at t = %.9g s",
                           what().name.c_str(), w.t()));
}

void Stages::resume(Case& c) const
{
    for (std::size_t k = 0; k < log.size(); ++k)
        if (!changes[k].pointers.empty())
            set_parameters(c, changes[k].to, changes[k].pointers, static_cast<double>(log[k].start) * h);
}

/// Whether the condition of the present stage is met. It is evaluated at some instants only.
bool Stages::is_at_rest(const World& w)
{
    const RestCondition& rest = *what().until;
    const long since = w.steps() - log.back().start, interval = steps_in(rest.interval);
    if (since == 0 || since % interval != 0) return false;
    const std::size_t bodies = free_bodies(w);
    if (bodies == 0) return false;
    const double energy = w.kinetic_energy(), number = static_cast<double>(bodies);
    largest_energy = std::max(largest_energy, energy);
    if (static_cast<double>(since) * h < rest.from * (1 - 1e-12)) return false;
    return (!rest.kinetic_energy || energy / number <= *rest.kinetic_energy) &&
           (!rest.share || energy <= *rest.share * largest_energy);
}

void Stages::update(Case& c, const Warn& warn)
{
    const World& w = *c.world;
    while (!is_over) {
        const StageSpec& s = what();
        const bool rests = s.until && is_at_rest(w);
        if (!rests && !is_late(w)) return;
        if (s.until) is_met = rests;
        if (w.steps() == log.back().start)
            warn("stage_end",
                 c.source.place("/stages/" + std::to_string(number()) + "/end") +
                     io::formatted(": end must be after the start of the stage at t = %.9g s, got "
                                   "%.9g; the stage has no steps",
                                   w.t(), *s.end));
        if (!rests && s.until) report_condition(w, warn);
        const Part before = log.back();
        log.back().end = w.steps(), log.back().reason = rests ? condition : duration;
        if (is_last()) {
            is_over = true;
            return;
        }
        try {
            begin(c);
        } catch (const io::PlacedError& e) {
            log.pop_back();
            log.back() = before;
            throw StageFailed("stage_motion",
                              "stage '" + spec[log.size()].name + "': " + e.pointer + ": " + e.reason);
        }
        report_selections(w, warn);
    }
}

/// Whether the present stage has reached its duration or its end
bool Stages::is_late(const World& w) const
{
    const StageSpec& s = what();
    return (s.duration && w.steps() - log.back().start >= steps_in(*s.duration)) ||
           (s.end && w.steps() >= steps_in(*s.end));
}

/// Warns that the condition of the present stage is not met. Throws StageFailed if the stage has reached its
/// duration or its end and has "on_timeout": "fail".
void Stages::report_condition(const World& w, const Warn& warn) const
{
    const StageSpec& s = what();
    const double energy = w.kinetic_energy();
    const std::string message = io::formatted(
        "stage '%s': its condition is not met until t = %.9g s, after %.9g s: the kinetic energy is %.3g J "
        "of %zu free particles and clumps, %.3g of the largest one in the stage",
        s.name.c_str(), w.t(), static_cast<double>(w.steps() - log.back().start) * h, energy, free_bodies(w),
        largest_energy > 0 ? energy / largest_energy : 1.);
    if (s.fails && is_late(w)) throw StageFailed("stage_timeout", message);
    warn("stage_timeout", message);
}

void Stages::end_run(const World& w, const Warn& warn)
{
    if (is_over || !what().until) return;
    is_met = is_at_rest(w);
    if (!*is_met) report_condition(w, warn);
}

void Stages::transfer(io::Archive& a)
{
    a.list(log);
    a.check(!log.empty() && log.size() <= spec.size(),
            "invalid number of stages, got " + std::to_string(log.size()));
    a.check_each(
        log, "invalid stage",
        [](const Part& p) {
            return p.start >= 0 && p.end >= 0 && p.removed >= 0 && p.reason >= running &&
                   p.reason <= duration;
        },
        [](const Part& p) { return std::to_string(p.start) + " to " + std::to_string(p.end); });
    a.value(largest_energy);
    a.check(std::isfinite(largest_energy), "the kinetic energy of a stage must be finite");
    std::uint64_t over = is_over ? 1 : 0;
    a.value(over);
    a.check(over <= 1, "invalid end of the stages");
    is_over = over != 0;
}

io::Json Stages::summary(double t) const
{
    // without the rounding error of the product
    const auto rounded = [](double time) {
        return std::strtod(io::formatted("%.12g", time).c_str(), nullptr);
    };
    constexpr const char* reasons[] = {"end of the run", "condition", "duration"};
    io::Json all = io::Json::array();
    for (std::size_t k = 0; k < log.size(); ++k) {
        io::Json stage = {
            {"name", spec[k].name},
            {"start", rounded(static_cast<double>(log[k].start) * h)},
            {"end", rounded(log[k].reason == running ? t : static_cast<double>(log[k].end) * h)},
            {"reason", reasons[log[k].reason]}};
        const bool has_ended = log[k].reason != running;
        if (spec[k].until && (has_ended || is_met))
            stage["condition_met"] = has_ended ? log[k].reason == condition : *is_met;
        if (!spec[k].remove.empty()) stage["removed"] = log[k].removed;
        all.push_back(std::move(stage));
    }
    return all;
}

}  // namespace hilda::granular
