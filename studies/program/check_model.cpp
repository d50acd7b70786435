// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/check_model.hpp"

#include "contact/compliant/contact_force.hpp"
#include "contact/compliant/manifold_force.hpp"
#include "contact/soft_friction.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/files.hpp"
#include "io/json.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "lie/schemes.hpp"
#include "lie/solver/saddle.hpp"
#include "run/columns/contact_outputs.hpp"
#include "run/columns/output_columns.hpp"
#include "run/events/run_events.hpp"
#include "run/named_model.hpp"
#include "run/watch/run_check.hpp"
#include "studies/framework/recommended_integrator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace hilda::studies {

namespace {

/// The largest value of a quantity, and the body at which it occurs
struct Largest {
    double value = 0;
    std::string body;

    void update(double candidate, const std::string& name)
    {
        if (!(candidate <= value) || body.empty()) value = candidate, body = name;
    }
};

/// Largest change of the initial state by the projection onto the constraints
struct Change {
    Largest r, A, rdot, omega_bar;  ///< [m], [rad], [m/s], [rad/s]
};

Change change(const dae::Model& model, const lie::State& from, const lie::State& to)
{
    Change c;
    for (int b = 0; b < model.bodies(); ++b) {
        const lie::Motion &x = from.body[b], &y = to.body[b];
        c.r.update((y.r - x.r).norm(), model.body_name(b));
        c.A.update(lie::log(x.A.transpose() * y.A).norm(), model.body_name(b));
        c.rdot.update((y.rdot - x.rdot).norm(), model.body_name(b));
        c.omega_bar.update((y.omega_bar - x.omega_bar).norm(), model.body_name(b));
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
        largest.F.update(all[b].F.norm(), model.body_name(b));
        largest.T.update(all[b].T.norm(), model.body_name(b));
    }
    return largest;
}

/// Stability limits of forces in a state with the default integrator [s]
class StableSteps {
public:
    StableSteps(const dae::Model& model, const lie::State& x) : x(x)
    {
        model.count_contacts(x, dae::Force::Counted::near, near);
    }
    double of(const dae::Force& force) const
    {
        return force.stable_step_with(x, lie::scheme(run::default_integrator).loads, near);
    }

private:
    const lie::State& x;
    std::vector<int> near;
};

/// Initial state of a compliant contact
struct CompliantContactInfo {
    std::string name;
    double gap, N;       ///< [m], [N]
    double curvature;    ///< sum of the mean curvatures of both surfaces [1/m]
    double stable_step;  ///< [s]
};

std::vector<CompliantContactInfo> compliant_contacts(const dae::Model& model, const lie::State& x)
{
    std::vector<CompliantContactInfo> all;
    const StableSteps stable_steps(model, x);
    model.for_forces(x, [&](const dae::Force& force, int) {
        if (const auto* several = dynamic_cast<const contact::ManifoldForce*>(&force)) {
            const run::ContactOutput now = run::ContactOutputs::of(force, x);
            all.push_back({.name = several->name,
                           .gap = now.gap,
                           .N = now.F_N,
                           .curvature = 0,
                           .stable_step = stable_steps.of(force)});
            return;
        }
        const auto* contact = dynamic_cast<const contact::ContactForce*>(&force);
        if (contact == nullptr || contact->normal_constraint() != nullptr) return;
        const contact::ContactState m = contact->at(x).contact_state;
        all.push_back({.name = contact->name,
                       .gap = m.contact_point.gap,
                       .N = std::max(0., m.N),
                       .curvature = 0.5 * (m.contact_point.K_i + m.contact_point.K_j).trace(),
                       .stable_step = stable_steps.of(*contact)});
    });
    return all;
}

/// null if there is no limit (infinite) or no value (NaN)
io::Json finite_or_null(double stable_step)
{
    return std::isfinite(stable_step) ? io::Json(stable_step) : nullptr;
}

std::string stability_text(double step)
{
    return std::isfinite(step) ? fmt::format("stable up to {:.3g} s", step) : "stable with any step";
}

/// Initial state of a pair of rigid bodies
struct RigidContactInfo {
    std::string name;
    double gap;  ///< the smallest [m]
    int points;  ///< closer than a hundredth of the smaller size
};

/// The pairs of rigid contacts; of larger groups only those with contact points
constexpr long most_pairs_in_full = 30;
std::vector<RigidContactInfo> rigid_contacts(const dae::Model& model, const lie::State& x)
{
    std::vector<RigidContactInfo> all;
    std::vector<contact::LoadedPoint> points;
    for (const auto& contacts : model.rigid_contacts()) {
        const auto* of = dynamic_cast<const contact::RigidContacts*>(contacts.get());
        if (of == nullptr || of->pairs().count() > run::ContactOutputs::most_rigid_pairs_with_columns)
            continue;
        for (int pair = 0; pair < of->numbers(); ++pair) {
            if (!of->pairs().has(pair)) continue;
            of->points(x, pair, points);
            if (points.empty() && of->pairs().count() > most_pairs_in_full) continue;
            all.push_back(
                {of->name_of_pair(pair), of->nearest(x, pair).gap, static_cast<int>(points.size())});
        }
    }
    return all;
}

io::Json as_json(const RigidContactInfo& c)
{
    return {{"name", c.name}, {"gap", c.gap}, {"points", c.points}};
}

io::Json as_json(const CompliantContactInfo& c)
{
    return {{"name", c.name},
            {"gap", c.gap},
            {"normal_force", c.N},
            {"curvature", c.curvature},
            {"stable_step", finite_or_null(c.stable_step)}};
}

std::string to_text(const CompliantContactInfo& c)
{
    return fmt::format("{} {:.3e} m, {:.3e} N, curvature {:.4g} 1/m, {}", c.gap > 0 ? "gap" : "overlap",
                       std::abs(c.gap), c.N, c.curvature, stability_text(c.stable_step));
}

/// Initial state of a contact constraint
struct ContactConstraintInfo {
    std::string name, friction, normal_rows;
    int rows, velocity_rows, unknowns;
    lie::Vec3 C, n;              ///< contact point [m], normal into body i; global
    lie::Vec3 alpha_i, alpha_j;  ///< contact points ᾱ_i, ᾱ_j, body frames [m]
    bool unilateral, inactive, fallback_active;
    double gap, F_N;                 ///< [m], [N]
    contact::Curvatures of_i, of_j;  ///< principal [1/m]
    double least_curvature;  ///< least relative principal curvature times the size L; 0 for a line contact
    double F_f;              ///< friction force [N]
    /// Stability limits of the step for the friction force and for the fallback [s]; infinite: no limit, NaN:
    /// no such force
    double stable_step = std::nan(""), stable_fallback = std::nan("");
};

std::vector<ContactConstraintInfo> contact_constraints(const dae::Model& model, const lie::State& x)
{
    using contact::EvolvingContact;
    std::vector<ContactConstraintInfo> all;
    const run::ContactOutputs contacts(model);
    const StableSteps stable_steps(model, x);
    for (size_t k = 0; k < contacts.contacts.size(); ++k) {
        const run::ContactOutputs::Contact& contact = contacts.contacts[k];
        const EvolvingContact* c = contact.constraint;
        if (c == nullptr) continue;
        const dae::Constraint::Arguments at = model.arguments(*c, x);
        const bool fallback_active = dae::Model::mode(*c, x) == contact::EvolvingContact::fallback_active;
        const contact::ContactPoint contact_point =
            fallback_active ? dynamic_cast<const contact::ContactForce&>(*contact.compliant)
                                  .at(x)
                                  .contact_state.contact_point
                            : c->contact_point(at);
        const run::ContactOutput loads = contacts.at(k, x);
        all.push_back(
            {.name = c->name,
             .friction = c->friction == EvolvingContact::Friction::rolling    ? "rolling"
                         : c->friction == EvolvingContact::Friction::implicit ? "implicit"
                         : contact.friction != nullptr                        ? "tracked"
                                                                              : "none",
             .normal_rows = c->normal_rows == EvolvingContact::NormalRows::tangent ? "tangent" : "fixed-xy",
             .rows = c->position_rows(),
             .velocity_rows = c->velocity_rows(),
             .unknowns = c->algebraic_variables(),
             .C = contact_point.C(),
             .n = contact_point.n,
             .alpha_i = at.bi.A.transpose() * (contact_point.C_i - at.bi.r),
             .alpha_j = at.bj.A.transpose() * (contact_point.C_j - at.bj.r),
             .unilateral = c->unilateral.enabled,
             .inactive = dae::Model::mode(*c, x) == contact::EvolvingContact::inactive,
             .fallback_active = fallback_active,
             .gap = contact_point.gap,
             .F_N = loads.F_N,
             .of_i = contact::principal_curvatures(contact_point.K_i, contact_point.n),
             .of_j = contact::principal_curvatures(contact_point.K_j, contact_point.n),
             .least_curvature = contact::least_curvature(contact_point) * c->L,
             .F_f = loads.F.norm()});
        if (contact.friction != nullptr) all.back().stable_step = stable_steps.of(*contact.friction);
        if (contact.compliant != nullptr) all.back().stable_fallback = stable_steps.of(*contact.compliant);
    }
    return all;
}

io::Json as_json(const lie::Vec3& v) { return {v.x(), v.y(), v.z()}; }

io::Json as_json(const ContactConstraintInfo& c)
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
            {"unilateral", c.unilateral},
            {"open", c.inactive},
            {"fallback_active", c.fallback_active},
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

std::vector<std::string> to_text(const ContactConstraintInfo& c)
{
    const auto vector = [](const lie::Vec3& v) {
        return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x(), v.y(), v.z());
    };
    std::vector<std::string> all = {
        fmt::format("{}, {}{}{}", io::counted(c.rows, "row"), io::counted(c.unknowns, "unknown"),
                    c.velocity_rows == 0
                        ? ""
                        : fmt::format(", {} of {}", io::counted(c.velocity_rows, "row"),
                                      c.friction == "rolling" ? "rolling" : "implicit friction"),
                    c.normal_rows == "tangent" ? "" : ", normals projected on " + c.normal_rows),
        fmt::format("at {} m, normal {} into body i, gap {:.1e} m", vector(c.C), vector(c.n), c.gap),
        fmt::format("normal force {:.10g} N{}", c.F_N,
                    c.fallback_active ? ", of the fallback, which is active"
                    : c.inactive      ? ", contact inactive"
                    : c.F_N >= 0      ? ""
                    : c.unilateral    ? ", contact separates in the first step"
                                      : ", tensile"),
        fmt::format(
            "curvatures {:.4g}, {:.4g} and {:.4g}, {:.4g} 1/m; least relative curvature times size {:.3g}",
            c.of_i.least, c.of_i.most, c.of_j.least, c.of_j.most, c.least_curvature)};
    if (!std::isnan(c.stable_step))
        all.push_back(fmt::format("friction {:.6g} N, {}", c.F_f, stability_text(c.stable_step)));
    if (!std::isnan(c.stable_fallback)) all.push_back("fallback: " + stability_text(c.stable_fallback));
    return all;
}

io::Json as_json(const Largest& l) { return {{"value", l.value}, {"body", l.body}}; }

/// Copies the notes of an object and of the objects in it to those with the same keys, or the same numbers in
/// lists of equal length.
void copy_notes(const io::Json& from, io::Json& to)
{
    if (from.members() != nullptr && to.members() != nullptr) {
        for (const auto& m : *from.members()) {
            if (m.key == "note")
                to["note"] = m.value;
            else if (to.member(m.key) != nullptr)
                copy_notes(m.value, to[m.key]);
        }
    } else if (auto* list = std::get_if<io::Json::List>(&to.value);
               list != nullptr && from.size() == list->size()) {
        for (size_t k = 0; from.list() != nullptr && k < list->size(); ++k)
            copy_notes(from.at(k), (*list)[k]);
    }
}

/// Writes the model with its projected initial state and the notes of its file. The text is checked as hilda
/// check would. io::UsageError if the file is that of the model, which has its parameters.
void write_projected(const dae::Description& d, const std::string& model, const std::string& file)
{
    if (std::error_code error; std::filesystem::equivalent(model, file, error))
        throw io::UsageError("check: --fix would replace the model " + model + " itself; give another file");
    std::string text = dae::text_at(d, d.x);
    if (run::is_model_path(model)) {
        io::JsonSource fixed(text, file);
        copy_notes(io::JsonSource(io::read_file(model, io::JsonSource::max_bytes), model).root, fixed.root);
        text = io::written(fixed.root) + '\n';
    }
    dae::Description written = dae::read_model(text, file);
    dae::start(written);
    io::write_named_file(file, text);
}

}  // namespace

int check_model(const run::CheckOptions& options)
{
    const bool fix_initial = options.fix_initial || !options.write.empty();
    dae::Description d =
        run::named_model(options.model, options.set, options.normal_rows, options.allow_paths);
    const lie::State given = d.x;
    const dae::StartReport start = dae::start(d, {.fix_initial = fix_initial});
    for (std::string& w : contact::soft_friction_warnings(*d.model, d.x)) d.warnings.push_back(std::move(w));
    if (!options.write.empty()) write_projected(d, options.model, options.write);
    const dae::Model& model = *d.model;
    const Recommendation recommended = recommended_integrator(model, d.x, start.degrees_of_freedom);
    const size_t output_columns =
        run::OutputColumns(model, run::outputs_and_events(d)).columns.size() - d.events.size();
    const double energy = lie::energy(model, d.x);
    const Reactions loads = largest_reactions(model, d.x);
    const std::vector<CompliantContactInfo> compliant = compliant_contacts(model, d.x);
    const std::vector<ContactConstraintInfo> constrained = contact_constraints(model, d.x);
    const std::vector<RigidContactInfo> rigid = rigid_contacts(model, d.x);
    long rigid_pairs = 0;
    for (const auto& contacts : model.rigid_contacts())
        rigid_pairs += dynamic_cast<const contact::RigidContacts&>(*contacts).pairs().count();
    const long pairs = model.near_forces().pairs();  // of groups
    const auto single = std::count_if(model.forces().begin(), model.forces().end(), [](const auto& force) {
        const auto* contact = dynamic_cast<const contact::ContactForce*>(force.get());
        return (contact != nullptr && contact->normal_constraint() == nullptr) ||
               dynamic_cast<const contact::ManifoldForce*>(force.get()) != nullptr;
    });
    const run::RowsOfGeneralConstraints general = run::rows_of_general_constraints(model, d.x);
    const int constraints = model.constraints() + general.others, rows = start.rows + general.of_others;
    double condition = std::nan("");
    if (!constrained.empty()) {
        lie::Saddle K(model);
        K.assemble(d.x);
        condition = 1 / K.reciprocal_condition();
    }
    const auto other_forces =
        std::count_if(model.forces().begin(), model.forces().end(), [](const auto& force) {
            return dynamic_cast<const contact::TrackedForce*>(force.get()) == nullptr &&
                   dynamic_cast<const contact::CompliantForce*>(force.get()) == nullptr;
        });
    const Change change_of_start = change(model, given, d.x);

    if (options.json) {
        io::Json out = {
            {"status", "ok"},
            {"model", d.name},
            {"bodies", model.bodies()},
            {"constraints", constraints},
            {"forces", other_forces},
            {"contacts", io::Json::array()},
            {"contact_pairs", static_cast<long>(single) + pairs},
            {"evolving_contacts", io::Json::array()},
            {"rigid_contacts", io::Json::array()},
            {"rows", rows},
            {"rank", start.rank},
            {"degrees_of_freedom", start.degrees_of_freedom},
            {"dropped_rows", start.dropped},
            {"position_residual", {{"value", start.position_residual}, {"row", start.worst_position}}},
            {"velocity_residual", {{"value", start.velocity_residual}, {"row", start.worst_velocity}}},
            {"energy", energy},
            {"largest_reaction_force", as_json(loads.F)},
            {"largest_reaction_torque", as_json(loads.T)},
            {"end", d.end},
            {"recommended_integrator", recommended.integrator},
            {"recommendation", recommended.reason},
            {"warnings", d.warnings}};
        if (output_columns > 0) out["output_columns"] = output_columns;
        if (!d.parameters.empty())
            for (const auto& [name, value] : d.parameters) out["parameters"][name] = value;
        for (const CompliantContactInfo& c : compliant) out["contacts"].push_back(as_json(c));
        for (const ContactConstraintInfo& c : constrained) out["evolving_contacts"].push_back(as_json(c));
        for (const RigidContactInfo& c : rigid) out["rigid_contacts"].push_back(as_json(c));
        if (!constrained.empty()) out["condition"] = condition;
        if (fix_initial)
            out["fix_initial"] = {{"projected", start.projected},
                                  {"r", as_json(change_of_start.r)},
                                  {"A", as_json(change_of_start.A)},
                                  {"rdot", as_json(change_of_start.rdot)},
                                  {"omega_bar", as_json(change_of_start.omega_bar)}};
        std::cout << out.text();
        return io::exit_code::done;
    }

    for (const std::string& w : d.warnings) io::warning(w);
    if (options.quiet) return io::exit_code::done;
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
    line("constraints", fmt::format("{} with {} of rank {}", constraints, io::counted(rows, "row"),
                                    start.rank - general.of_contacts));
    line("forces", std::to_string(other_forces));
    if (output_columns > 0)
        line("outputs", io::counted(static_cast<long>(output_columns), "column") + " in outputs.csv");
    if (!d.events.empty()) line("events", io::counted(static_cast<long>(d.events.size()), "formula"));
    std::string parameters;
    const char* label = "parameters";
    for (const auto& [name, value] : d.parameters) {
        constexpr size_t width = 80;
        const std::string equation = name + " = " + io::shortest(value);
        if (!parameters.empty() && parameters.size() + equation.size() > width)
            line(label, parameters + ','), parameters.clear(), label = "";
        parameters += (parameters.empty() ? "" : ", ") + equation;
    }
    if (!parameters.empty()) line(label, parameters);
    if (!compliant.empty() || pairs > 0)
        line("contacts",
             pairs > 0 ? fmt::format("{} of {} listed, the pairs of groups that are close to each other",
                                     compliant.size(), single + pairs)
                       : std::to_string(compliant.size()));
    if (!constrained.empty()) {
        line("contact constraints", fmt::format("{}, of rank {}", constrained.size(), general.of_contacts));
        for (const ContactConstraintInfo& c : constrained) {
            std::string head = "  " + c.name + ' ';
            for (const std::string& words : to_text(c)) line(head.c_str(), words), head.clear();
        }
    }
    for (const CompliantContactInfo& c : compliant) line(("  " + c.name + " ").c_str(), to_text(c));
    if (rigid_pairs > 0) line("rigid contacts", io::counted(rigid_pairs, "pair"));
    for (const RigidContactInfo& c : rigid)
        line(("  " + c.name + " ").c_str(),
             fmt::format("{} {:.3e} m, {}", c.gap > 0 ? "gap" : "overlap", std::abs(c.gap),
                         io::counted(c.points, "contact point")));
    line("degrees of freedom", std::to_string(start.degrees_of_freedom));
    for (const std::string& row : start.dropped) line("redundant", row);
    if (start.redundant > 0)
        line("redundant", io::counted(start.redundant, "row") + ", kept in the equations");
    const auto initial = [&](double value, const char* unit, const std::string& row,
                             const std::string& violation) {
        return value > dae::StartOptions{}.tolerance ? violation + ", " + row : residual(value, unit, row);
    };
    line("position residual",
         initial(start.position_residual, "m or rad", start.worst_position, start.position_violation));
    line("velocity residual",
         initial(start.velocity_residual, "m/s or rad/s", start.worst_velocity, start.velocity_violation));
    if (!constrained.empty())
        line("condition", fmt::format("{:.1e} of the row-scaled saddle matrix", condition));
    line("recommended", fmt::format("--integrator {}; {}", recommended.integrator, recommended.reason));
    line("energy", fmt::format("{:.6e} J", energy));
    line("largest reaction", at(loads.F, "N") + ", " + at(loads.T, "N m"));
    line("end", fmt::format("{:g} s", d.end));
    if (fix_initial) {
        line("--fix-initial", start.projected ? "changes the initial state by:"
                                              : "changes the initial state by rounding errors only:");
        line("  r", at(change_of_start.r, "m"));
        line("  A", at(change_of_start.A, "rad"));
        line("  r_dot", at(change_of_start.rdot, "m/s"));
        line("  omega", at(change_of_start.omega_bar, "rad/s"));
        if (!options.write.empty()) line("written", options.write);
    }
    return io::exit_code::done;
}

}  // namespace hilda::studies
