// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/watch.hpp"

#include "contact/compliant/compliant_force.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "run/watch/rigid_contact_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::run {

namespace {

constexpr long interval = 16;  // nodes from one complete check to the next
constexpr long contacts =
    16 * 16;  // the same for compliant contacts that are not compressed more than before

std::string percent(double part) { return fmt::format("{:.2g} %", 100 * part); }

}  // namespace

Watch::Watch(const dae::Model& model, const lie::State& x, const lie::Integrator& integrator,
             const lie::Scheme& scheme, const lie::TimeGrid& grid, Action action, bool ignore_stability)
    : model(model), integrator(integrator), scheme(scheme), grid(grid), action(action), limits(),
      energy(model, x, grid.h)
{
    values.ignore_stability = ignore_stability ? 1 : 0;
    for (int k = 0; k < static_cast<int>(model.forces().size()); ++k) {
        const dae::Force* force = model.forces()[static_cast<size_t>(k)].get();
        if (const auto* contact = dynamic_cast<const contact::CompliantForce*>(force))
            compliant.emplace_back(contact, k);
        else if (!force->is_implicit_in(scheme) &&
                 (force->internal_states() > 0 || std::isfinite(force->spring_limits.at_step) ||
                  std::isfinite(force->stable_step(x, scheme.loads))))
            with_limit.push_back(k);
    }
    values.deepest.resize(compliant.size());
    touching.reserve(x.body.size());
}

void Watch::accepted(const lie::State& x, long n, int)
{
    WatchRecord& r = values;
    touching.clear();
    if (!scheme.adaptive)
        for (size_t b = 0; b < x.body.size(); ++b)
            if (const double w = x.body[b].omega_bar.squaredNorm() * grid.h * grid.h;
                w > r.turn.value * r.turn.value)
                r.turn.include(std::sqrt(w), x.t, b);
    if (action == Action::strict && r.turn.value > limits.turn) stop("large_turn", turn_finding().text);
    for (const auto& contacts : model.rigid_contacts())
        if (const auto [speed, body] = contacts->fastest(x); body >= 0)
            r.motion.include(speed * grid.h, x.t, static_cast<size_t>(body));
    if (action == Action::strict && !model.rigid_contacts().empty()) {
        if (r.motion.value > limits.motion) stop("large_motion", motion_finding().text);
        for (const Finding& of_contacts : rigid_contact_findings(integrator.statistics()))
            stop(of_contacts.name, of_contacts.text);
    }
    if (const double condition = integrator.statistics().condition; condition < r.condition) {
        r.condition = condition;
        r.condition_t = x.t;
        if (action == Action::strict && condition < limits.condition)
            stop("ill_conditioned", condition_finding().text);
    }
    const bool periodic = n % interval == 0;
    if (!compliant.empty() || !model.near_forces().empty()) check_contacts(x, n % contacts == 0);
    if (periodic)
        for (const int k : with_limit) check_stability(k, x);
    energy.add_work(x);
    if (periodic || grid.is_row(n)) {
        energy.evaluate(x, n);
        check_energy();
    }
}

void Watch::check_stability(int k, const lie::State& x)
{
    check_stability(*model.forces()[static_cast<size_t>(k)], k, x);
}

void Watch::check_stability(const dae::Force& force, int number, const lie::State& x)
{
    if (values.unstable.place >= 0 || scheme.adaptive) return;
    if (touching.empty()) model.count_contacts(x, dae::Force::Counted::touching, touching);
    if (force.is_stable(x, 2 / scheme.stability * grid.h, scheme.loads, touching)) return;
    values.unstable.include(1, x.t, static_cast<size_t>(number));
    if (action == Action::strict || (action == Action::stop && values.ignore_stability == 0))
        stop("unstable_step", stability_finding().text);
}

void Watch::check_contacts(const lie::State& x, bool all)
{
    const auto check = [&](const contact::CompliantForce& contact, int number, double& deepest) {
        const double overlap = contact.overlap(x);
        if (overlap == 0 || (overlap <= deepest && !all)) return;
        deepest = std::max(deepest, overlap);
        values.overlap.include(contact.relative_overlap(x), x.t, static_cast<size_t>(number));
        check_stability(dynamic_cast<const dae::Force&>(contact), number, x);
    };
    for (size_t c = 0; c < compliant.size(); ++c)
        check(*compliant[c].first, compliant[c].second, values.deepest[c]);
    // The deepest overlaps of near pairs are those of their places in the state. A pair that returns is
    // checked again.
    const auto others = static_cast<int>(model.forces().size());
    model.near_forces().visit(x, [&](const dae::Force& force, int number) {
        const auto place = static_cast<size_t>(model.near_forces().place(force));
        if (place >= values.near_deepest.size()) values.near_deepest.resize(2 * place + 1);
        DeepestOverlap& deepest = values.near_deepest[place];
        if (deepest.number != number) deepest = {.number = number, .overlap = 0};
        check(dynamic_cast<const contact::CompliantForce&>(force), others + number, deepest.overlap);
    });
    if (action == Action::record) return;
    if (values.overlap.value > limits.overlap_end) stop("overlap_too_large", overlap_finding().text);
    if (action == Action::strict && values.overlap.value > limits.overlap)
        stop("large_overlap", overlap_finding().text);
}

std::string Watch::label_of(const Extreme& e) const
{
    return model.force_of(static_cast<int>(e.place))->label();
}

bool Watch::energy_rises() const
{
    return energy.is_passive() && energy.record.rise > energy.limit(limits.energy);
}

bool Watch::energy_created() const
{
    if (scheme.energy_drifts || !energy_rises()) return false;
    const EnergyRecord& r = energy.record;
    return r.rise > energy.limit(limits.energy) + std::min(r.step_error, limits.step_error * r.kinetic_most);
}

bool Watch::energy_lost() const
{
    const EnergyRecord& r = energy.record;
    return energy.is_conservative() &&
           r.loss > energy.limit(limits.loss) + std::min(r.step_error, limits.step_error * r.kinetic_most);
}

void Watch::check_energy() const
{
    if (action == Action::record) return;
    if (action == Action::strict && energy_lost()) stop("energy_lost", loss_finding().text);
    if (energy_created()) stop("energy_created", energy_finding().text);
    if (action == Action::strict && energy_rises()) stop("energy_rises", energy_finding().text);
}

void Watch::stop(const std::string& status, const std::string& text) const
{
    throw lie::NodeFailure(status, text);
}

Finding Watch::turn_finding() const
{
    return {
        "large_turn",
        fmt::format("body '{}' turns by {:.3g} rad in one step at t = {:.6g} s; above {:g} rad the error of "
                    "a step is large; reduce the step",
                    model.body_name(static_cast<int>(values.turn.place)), values.turn.value, values.turn.t,
                    limits.turn)};
}

Finding Watch::motion_finding() const
{
    return {
        "large_motion",
        fmt::format(
            "body '{}' moves by {:.3g} times the width of the thinnest body in one step at t = {:.6g} s; "
            "rigid bodies can then pass through each other; reduce the step",
            model.body_name(static_cast<int>(values.motion.place)), values.motion.value, values.motion.t)};
}

Finding Watch::overlap_finding() const
{
    return {"large_overlap",
            fmt::format("{}: the surfaces overlap by {:.3g} of their radius at t = {:.6g} s; laws of small "
                        "deformation hold up to about {:g}",
                        label_of(values.overlap), values.overlap.value, values.overlap.t, limits.overlap)};
}

Finding Watch::condition_finding() const
{
    return {"ill_conditioned",
            fmt::format("the matrix of the step is nearly singular at t = {:.6g} s, reciprocal condition "
                        "{:.1e}: a singular position, or redundant constraints",
                        values.condition_t, values.condition)};
}

Finding Watch::stability_finding() const
{
    return {
        "unstable_step",
        fmt::format("the step {:g} s is above the stability limit of {} at t = {:.6g} s; reduce the step, or "
                    "accept it with --accept-step",
                    grid.h, label_of(values.unstable), values.unstable.t)};
}

Finding Watch::energy_finding() const
{
    const EnergyRecord& r = energy.record;
    std::string text = fmt::format(
        "the energy rises by {:.3g} J until t = {:.6g} s, {} of the largest kinetic energy {:.3g} J", r.rise,
        r.rise_t, percent(r.rise / r.kinetic_most), r.kinetic_most);
    if (scheme.energy_drifts)
        text += fmt::format("; the energy of {} drifts with an error of order {}", scheme.name, scheme.order);
    if (values.unstable.place >= 0)
        text += fmt::format("; the step is above the stability limit of {}", label_of(values.unstable));
    return {"energy_rises", text + (scheme.adaptive ? "; reduce --rtol" : "; reduce the step")};
}

Finding Watch::loss_finding() const
{
    const EnergyRecord& r = energy.record;
    return {"energy_lost",
            fmt::format(
                "the energy falls by {:.3g} J until t = {:.6g} s, {} of the largest kinetic energy {:.3g} "
                "J, and nothing in the model dissipates energy; {}",
                r.loss, r.loss_t, percent(r.loss / r.kinetic_most), r.kinetic_most,
                scheme.adaptive ? "reduce --rtol" : "reduce the step, or use an integrator of higher order")};
}

std::vector<Finding> Watch::findings() const
{
    std::vector<Finding> all;
    if (values.turn.value > limits.turn) all.push_back(turn_finding());
    if (values.motion.value > limits.motion) all.push_back(motion_finding());
    if (values.unstable.place >= 0) all.push_back(stability_finding());
    if (values.overlap.value > limits.overlap) all.push_back(overlap_finding());
    if (values.condition < limits.condition) all.push_back(condition_finding());
    if (energy_rises()) all.push_back(energy_finding());
    if (energy_lost()) all.push_back(loss_finding());
    return all;
}

io::Json Watch::json() const
{
    const auto place = [&](const Extreme& e, const std::string& name) {
        return e.place < 0 ? io::Json() : io::Json{{"value", e.value}, {"t", e.t}, {"of", name}};
    };
    const auto force = [&](const Extreme& e) { return e.place < 0 ? std::string() : label_of(e); };
    const EnergyRecord& r = energy.record;
    return {{"largest_turn", place(values.turn, values.turn.place < 0
                                                    ? std::string()
                                                    : model.body_name(static_cast<int>(values.turn.place)))},
            {"largest_overlap", place(values.overlap, force(values.overlap))},
            {"unstable_step", values.unstable.place < 0
                                  ? io::Json()
                                  : io::Json{{"t", values.unstable.t}, {"of", force(values.unstable)}}},
            {"condition", values.condition},
            {"energy",
             {{"passive", energy.is_passive()},
              {"kinetic_most", r.kinetic_most},
              {"work_of_loads", r.work_of_loads()},
              {"work_of_drivers", r.work_of_drivers()},
              {"dissipated", r.dissipated()},
              {"rise", r.rise},
              {"rise_t", r.rise_t},
              {"conservative", energy.is_conservative()},
              {"loss", r.loss},
              {"loss_t", r.loss_t},
              {"step_error", r.step_error}}}};
}

void transfer(io::Archive& a, WatchRecord& r)
{
    a.value(r.turn), a.value(r.motion), a.value(r.overlap), a.value(r.unstable), a.value(r.ignore_stability);
    a.value(r.condition), a.value(r.condition_t), a.value(r.energy), a.list(r.deepest),
        a.list(r.near_deepest);
}

WatchRecord Watch::record() const
{
    WatchRecord all = values;
    all.energy = energy.record;
    return all;
}

void Watch::restore(const WatchRecord& saved)
{
    values = saved;
    energy.record = saved.energy;
}

}  // namespace hilda::run
