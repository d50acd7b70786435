// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/check_model.hpp"

#include "contact/compliant/contact_force.hpp"
#include "studies/message.hpp"
#include "studies/output.hpp"
#include "studies/program/named_model.hpp"
#include "studies/running/contact_rows.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>

namespace hilda::studies {

namespace {

/// For contacts that are constraints
constexpr const char* recommended = "rA-half-1-momentum";

/// A quantity at its largest, and the body it is at
struct Largest {
    double value = 0;
    std::string body;

    void look(double candidate, const std::string& name)
    {
        if (!(candidate <= value) || body.empty()) value = candidate, body = name;
    }
};

/// How far the start that is used lies from the one given
struct Change {
    Largest r, A, rdot, omega_bar;  ///< [m], [rad], [m/s], [rad/s]
};

Change change(const dae::Model& model, const lie::State& from, const lie::State& to)
{
    Change c;
    for (int b = 0; b < model.bodies(); ++b) {
        const lie::Motion &x = from.body[b], &y = to.body[b];
        c.r.look((y.r - x.r).norm(), model.body_name(b));
        c.A.look(lie::log(x.A.transpose() * y.A).norm(), model.body_name(b));
        c.rdot.look((y.rdot - x.rdot).norm(), model.body_name(b));
        c.omega_bar.look((y.omega_bar - x.omega_bar).norm(), model.body_name(b));
    }
    return c;
}

struct Reactions {
    Largest F, T;  ///< [N], [N m]
};

Reactions largest_reactions(const dae::Model& model, const lie::State& x)
{
    Reactions largest;
    const std::vector<dae::Reaction> all = dae::reactions(model, x);
    for (int b = 0; b < model.bodies(); ++b) {
        largest.F.look(all[b].F.norm(), model.body_name(b));
        largest.T.look(all[b].T.norm(), model.body_name(b));
    }
    return largest;
}

/// A contact at the start
struct Touching {
    std::string name;
    double gap, N;       ///< [m], [N]
    double curvature;    ///< κ_i + κ_j, each the mean over the directions [1/m]
    double stable_step;  ///< [s]
};

std::vector<Touching> contacts(const dae::Model& model, const lie::State& x)
{
    std::vector<Touching> all;
    for (const auto& force : model.forces()) {
        const auto* contact = dynamic_cast<const contact::ContactForce*>(force.get());
        if (contact == nullptr || contact->held_by() != nullptr) continue;
        const contact::ContactState m = contact->at(x).contact_state;
        all.push_back({.name = contact->name,
                       .gap = m.contact_point.gap,
                       .N = std::max(0., m.N),
                       .curvature = 0.5 * (m.contact_point.K_i + m.contact_point.K_j).trace(),
                       .stable_step = contact->stable_step(x)});
    }
    return all;
}

/// null where it is any step, or none
nlohmann::ordered_json finite_or_null(double stable_step)
{
    return std::isfinite(stable_step) ? nlohmann::ordered_json(stable_step) : nullptr;
}

std::string stable_in_words(double step)
{
    return std::isfinite(step) ? fmt::format("stable up to {:.3g} s", step) : "stable with any step";
}

nlohmann::ordered_json as_json(const Touching& c)
{
    return {{"name", c.name},
            {"gap", c.gap},
            {"normal_force", c.N},
            {"curvature", c.curvature},
            {"stable_step", finite_or_null(c.stable_step)}};
}

std::string in_words(const Touching& c)
{
    return fmt::format("{} {:.3e} m, {:.3e} N, curvature {:.4g} 1/m, {}", c.gap > 0 ? "gap" : "overlap",
                       std::abs(c.gap), c.N, c.curvature, stable_in_words(c.stable_step));
}

/// A contact that is a constraint, at the start
struct Evolving {
    std::string name, friction, normal_rows;
    int rows, velocity_rows, unknowns;
    lie::Vec3 C, n, alpha_i,
        alpha_j;  ///< where it touches, the normal into body i [m, global]; on both bodies
    bool opens, open, fallback_active;
    double gap, F_N;                 ///< [m], [N]
    contact::Curvatures of_i, of_j;  ///< principal [1/m]
    double
        least_curvature;  ///< smaller one of their sum, times the size L: how far from a touch along a line
    double F_f;           ///< of friction [N]
    /// Largest that friction and what stands by are stable with [s]; infinite for any, NaN where there is none
    double stable_step = std::nan(""), stable_fallback = std::nan("");
};

std::vector<Evolving> evolving(const dae::Model& model, const lie::State& x)
{
    using contact::EvolvingContact;
    std::vector<Evolving> all;
    for (const EvolvingContact* c : evolving_contacts(model)) {
        const dae::Constraint::At at = model.at(*c, x);
        const ContactForces beside = forces_of(model, *c);
        const bool fallback_active = dae::Model::mode(*c, x) == dae::Constraint::fallback_active;
        const contact::ContactPoint contact_point =
            fallback_active ? beside.fallback->at(x).contact_state.contact_point : c->contact_point(at);
        const OnBodyI acts = on_body_i(model, *c, beside, x);
        all.push_back(
            {.name = c->name,
             .friction = c->friction == EvolvingContact::Friction::rolling ? "rolling"
                         : beside.friction != nullptr                      ? "tracked"
                                                                           : "none",
             .normal_rows = c->normal_rows == EvolvingContact::NormalRows::tangent ? "tangent" : "fixed-xy",
             .rows = c->rows(),
             .velocity_rows = c->velocity_rows(),
             .unknowns = c->unknowns(),
             .C = contact_point.C(),
             .n = contact_point.n,
             .alpha_i = at.bi.A.transpose() * (contact_point.C_i - at.bi.r),
             .alpha_j = at.bj.A.transpose() * (contact_point.C_j - at.bj.r),
             .opens = c->unilateral.enabled,
             .open = dae::Model::mode(*c, x) == dae::Constraint::inactive,
             .fallback_active = fallback_active,
             .gap = contact_point.gap,
             .F_N = acts.F_N,
             .of_i = contact::principal_curvatures(contact_point.K_i, contact_point.n),
             .of_j = contact::principal_curvatures(contact_point.K_j, contact_point.n),
             .least_curvature = contact::least_curvature(contact_point) * c->L,
             .F_f = acts.friction.norm()});
        if (beside.friction != nullptr) all.back().stable_step = beside.friction->stable_step(x);
        if (beside.fallback != nullptr) all.back().stable_fallback = beside.fallback->stable_step(x);
    }
    return all;
}

nlohmann::ordered_json as_json(const lie::Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json as_json(const Evolving& c)
{
    return {{"name", c.name},
            {"rows", c.rows},
            {"velocity_rows", c.velocity_rows},
            {"unknowns", c.unknowns},
            {"normal_rows", c.normal_rows},
            {"friction", c.friction},
            {"point", as_json(c.C)},
            {"normal", as_json(c.n)},
            {"alpha_i", as_json(c.alpha_i)},
            {"alpha_j", as_json(c.alpha_j)},
            {"unilateral", c.opens},
            {"open", c.open},
            {"handed_over", c.fallback_active},
            {"gap", c.gap},
            {"normal_force", c.F_N},
            {"curvatures_i", {c.of_i.least, c.of_i.most}},
            {"curvatures_j", {c.of_j.least, c.of_j.most}},
            {"least_relative_curvature", c.least_curvature},
            {"friction_force", c.F_f},
            {"stable_step", finite_or_null(c.stable_step)},
            {"fallback", !std::isnan(c.stable_fallback)},
            {"fallback_stable_step", finite_or_null(c.stable_fallback)}};
}

std::vector<std::string> in_words(const Evolving& c)
{
    const auto vector = [](const lie::Vec3& v) {
        return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
    };
    std::vector<std::string> all = {
        fmt::format("{} rows, {} unknowns{}{}", c.rows, c.unknowns,
                    c.velocity_rows > 0 ? fmt::format(", {} rows of rolling", c.velocity_rows) : "",
                    c.normal_rows == "tangent" ? "" : ", normals projected on " + c.normal_rows),
        fmt::format("at {} m, normal {} into the first, gap {:.1e} m", vector(c.C), vector(c.n), c.gap),
        fmt::format("normal force {:.10g} N{}", c.F_N,
                    c.fallback_active ? ": of the fallback, to which it has handed over"
                    : c.open          ? ": it is open"
                    : c.F_N >= 0      ? ""
                    : c.opens         ? ": it opens"
                                      : ": it pulls"),
        fmt::format("curvatures {:.4g}, {:.4g} and {:.4g}, {:.4g} 1/m; least of the sum, times size, {:.3g}",
                    c.of_i.least, c.of_i.most, c.of_j.least, c.of_j.most, c.least_curvature)};
    if (!std::isnan(c.stable_step))
        all.push_back(fmt::format("friction {:.6g} N, {}", c.F_f, stable_in_words(c.stable_step)));
    if (!std::isnan(c.stable_fallback))
        all.push_back("a fallback stands by, " + stable_in_words(c.stable_fallback));
    return all;
}

nlohmann::ordered_json as_json(const Largest& l) { return {{"value", l.value}, {"body", l.body}}; }

}  // namespace

int check_model(const CheckOptions& options)
{
    dae::Description d =
        named_model(options.model, normal_rows(options.model, options.set, options.normal_rows));
    const lie::State given = d.x;
    const dae::StartReport start = dae::start(d, {.fix_initial = options.fix_initial});
    const dae::Model& model = *d.model;
    const double energy = lie::energy(model, d.x);
    const Reactions loads = largest_reactions(model, d.x);
    const std::vector<Touching> touching = contacts(model, d.x);
    const std::vector<Evolving> held = evolving(model, d.x);
    const int of_contacts = contact_rank(model, d.x);
    double condition = std::nan("");
    if (!held.empty()) {
        lie::Saddle K(model);
        K.assemble(d.x);
        condition = 1 / K.reciprocal_condition();
    }
    const auto other_forces = std::count_if(
        model.forces().begin(), model.forces().end(),
        [](const auto& force) { return dynamic_cast<const contact::TrackedForce*>(force.get()) == nullptr; });
    const Change moved = change(model, given, d.x);

    if (options.json) {
        nlohmann::ordered_json out = {
            {"status", "ok"},
            {"model", d.name},
            {"bodies", model.bodies()},
            {"constraints", model.constraints()},
            {"forces", other_forces},
            {"contacts", nlohmann::ordered_json::array()},
            {"evolving_contacts", nlohmann::ordered_json::array()},
            {"rows", start.rows},
            {"rank", start.rank},
            {"degrees_of_freedom", start.degrees_of_freedom},
            {"dropped_rows", start.dropped},
            {"position_residual", {{"value", start.position_residual}, {"row", start.worst_position}}},
            {"velocity_residual", {{"value", start.velocity_residual}, {"row", start.worst_velocity}}},
            {"energy", energy},
            {"largest_reaction_force", as_json(loads.F)},
            {"largest_reaction_torque", as_json(loads.T)},
            {"end", d.end},
            {"warnings", d.warnings}};
        for (const Touching& c : touching) out["contacts"].push_back(as_json(c));
        for (const Evolving& c : held) out["evolving_contacts"].push_back(as_json(c));
        if (!held.empty()) out.update({{"condition", condition}, {"recommended_integrator", recommended}});
        if (options.fix_initial)
            out["fix_initial"] = {{"projected", start.projected},
                                  {"r", as_json(moved.r)},
                                  {"A", as_json(moved.A)},
                                  {"rdot", as_json(moved.rdot)},
                                  {"omega_bar", as_json(moved.omega_bar)}};
        std::cout << as_text(out);
        return exit_code::done;
    }

    for (const std::string& w : d.warnings) warning(w);
    if (options.quiet) return exit_code::done;
    const auto line = [](const char* what, const std::string& text) {
        std::cout << fmt::format("{:<20}{}\n", what, text);
    };
    const auto at = [](const Largest& l, const char* unit) {
        return l.body.empty() ? std::string("none") : fmt::format("{:.3e} {} on '{}'", l.value, unit, l.body);
    };
    const auto residual = [](double value, const char* unit, const std::string& row) {
        return row.empty() ? std::string("none") : fmt::format("{:.1e} {}, {}", value, unit, row);
    };
    line("model", d.name);
    line("bodies", std::to_string(model.bodies()));
    line("constraints", fmt::format("{} with {} rows of rank {}", model.constraints(), start.rows,
                                    start.rank - of_contacts));
    line("forces", std::to_string(other_forces));
    if (!touching.empty()) line("contacts", std::to_string(touching.size()));
    if (!held.empty()) {
        line("contacts held", fmt::format("{}, of rank {}", held.size(), of_contacts));
        for (const Evolving& c : held) {
            std::string head = "  " + c.name + ' ';
            for (const std::string& words : in_words(c)) line(head.c_str(), words), head.clear();
        }
    }
    for (const Touching& c : touching) line(("  " + c.name + " ").c_str(), in_words(c));
    line("degrees of freedom", std::to_string(start.degrees_of_freedom));
    for (const std::string& row : start.dropped) line("redundant", row);
    line("position residual", residual(start.position_residual, "m or rad", start.worst_position));
    line("velocity residual", residual(start.velocity_residual, "m/s or rad/s", start.worst_velocity));
    if (!held.empty()) {
        line("condition", fmt::format("{:.1e} of the saddle matrix, rows scaled", condition));
        line("recommended",
             fmt::format("--integrator {}: second order in motion and normal force; rA-half-1, the "
                         "default, is the text of the dissertation",
                         recommended));
    }
    line("energy", fmt::format("{:.6e} J", energy));
    line("largest reaction", at(loads.F, "N") + ", " + at(loads.T, "N m"));
    line("end", fmt::format("{:g} s", d.end));
    if (options.fix_initial) {
        line("--fix-initial", start.projected ? "moves the start:" : "changes nothing but rounding:");
        line("  r", at(moved.r, "m"));
        line("  A", at(moved.A, "rad"));
        line("  r_dot", at(moved.rdot, "m/s"));
        line("  omega", at(moved.omega_bar, "rad/s"));
    }
    return exit_code::done;
}

}  // namespace hilda::studies
