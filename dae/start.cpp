// SPDX-License-Identifier: GPL-3.0-or-later
/// Removal of redundant rows, projection and consistent internal states at a start.
#include "dae/start.hpp"

#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/driven_hinge.hpp"
#include "dae/forces/spring_limits.hpp"
#include "dae/model.hpp"
#include "dae/rank.hpp"
#include "dae/start/derivative_check.hpp"
#include "dae/start/static_friction.hpp"
#include "lie/cones/overlap_correction.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"
#include "lie/trajectory.hpp"

#include <algorithm>
#include <optional>

namespace hilda::dae {

namespace {

// Tolerance of dependent_rows() for rows of length one. It is above the error of coordinates with nine or ten
// digits, which must not hide a redundant row, and below the independent part of a driver row near its
// singularity.
constexpr double rank_tolerance = 1e-7;
// Largest scaled residual of a redundant row when the other rows are satisfied
constexpr double redundancy_tolerance = 1e-6;

std::string number(double value)
{
    std::ostringstream text;
    text.precision(3);
    text << value;
    return text.str();
}

/// Violation of a row in its unit: a distance, or an angle for a row that concerns orientations only
struct Violation {
    double value;
    std::string unit;  ///< m or rad
};

Violation violation(const Model& model, const Model::Row& row, const State& x)
{
    const Block& block = row.active_block(x);
    const Constraint::Arguments at = Model::arguments(block, x);
    const double phi = block.phi(at);
    if (const auto* dp1 = dynamic_cast<const DP1*>(&block)) {
        const double scale = dp1->a_bar_i.norm() * dp1->a_bar_j.norm(), f = dp1->f.f(x.t);
        const auto angle = [&](double product) { return std::acos(std::clamp(product / scale, -1., 1.)); };
        return {std::abs(angle(f + phi) - angle(f)), "rad"};
    }
    // Φ is the sine of the angle
    if (dynamic_cast<const DrivenHinge*>(&block) != nullptr)
        return {std::asin(std::min(std::abs(phi), 1.)), "rad"};
    const Variation v = block.variation(at);
    const double distance = std::max(v.r_i.norm(), v.r_j.norm()),
                 angle = std::max(v.pi_i.norm(), v.pi_j.norm());
    if (dynamic_cast<const D*>(&block) != nullptr) {  // Φ = l² - f, Φ_r = 2 l
        const double l = distance / 2;
        return {std::abs(l - std::sqrt(std::max(0., l * l - phi))), "m"};
    }
    if (distance > 0) return {std::abs(phi) / distance, "m"};
    if (angle > 0) return {std::abs(phi) / angle, "rad"};
    return {std::abs(model.scaled_residual(row, x)), "m or rad"};
}

/// The same for the velocities
Violation velocity_violation(const Model& model, const Model::Row& row, const State& x)
{
    const Block& block = row.active_block(x);
    const Constraint::Arguments at = Model::arguments(block, x);
    const Variation v = block.variation(at);
    const double residual = std::abs(v.r_i.dot(at.bi.rdot) + v.pi_i.dot(at.bi.omega_bar) +
                                     v.r_j.dot(at.bj.rdot) + v.pi_j.dot(at.bj.omega_bar) - block.nu(at));
    const double distance = std::max(v.r_i.norm(), v.r_j.norm()),
                 angle = std::max(v.pi_i.norm(), v.pi_j.norm());
    if (distance > 0) return {residual / distance, "m/s"};
    if (angle > 0) return {residual / angle, "rad/s"};
    return {std::abs(model.scaled_velocity_residual(row, x)), "m/s or rad/s"};
}

/// Linear solver of a start. KLU is the most accurate. With general constraints `automatic` is used, which
/// factors the rows of active constraints only.
lie::LinearSolver start_solver(const Model& model)
{
    return model.general_constraints().empty() ? lie::LinearSolver::klu : lie::LinearSolver::automatic;
}

/// Throws ConstraintError if a redundant row contradicts the others in position, velocity or acceleration.
/// Residuals of velocities and accelerations are relative to the largest value of the bodies of the row, at
/// least 1.
void check_redundant_row(const Model& model, const Model::Row& row, const State& x)
{
    double velocity_scale = 1, acceleration_scale = 1;
    for (const int b : {row.block->i, row.block->j}) {
        if (b == ground) continue;
        const Motion& body = x.body[b];
        velocity_scale = std::max({velocity_scale, body.rdot.norm(), body.omega_bar.norm()});
        acceleration_scale = std::max({acceleration_scale, body.rddot.norm(), body.omegadot_bar.norm()});
    }
    const auto check = [&](const char* level, double residual, double scale) {
        if (!(std::abs(residual) <= redundancy_tolerance * scale))
            throw ConstraintError(model.name_of(row) + ": contradicts the " +
                                      (model.keep_redundant ? "other constraints" : "constraints before it") +
                                      " in " + level + ", residual " + number(residual) + ", at most " +
                                      number(redundancy_tolerance * scale) + " is allowed",
                                  row.constraint);
    };
    check("position", model.scaled_residual(row, x), 1);
    check("velocity", model.scaled_velocity_residual(row, x), velocity_scale);
    check("acceleration", model.scaled_acceleration_residual(row, x), acceleration_scale);
}

/// Computes the internal states, accelerations and multipliers of a start. If internal states depend on
/// multipliers, they are iterated until they are consistent.
void solve_with_internal_states(const Model& model, lie::Saddle& K, State& x)
{
    const auto solve_once = [&] {
        model.set_internal_state_at_start(x);
        lie::solve_accelerations(model, K, x);
    };
    solve_once();
    const auto& forces = model.forces();
    if (std::none_of(forces.begin(), forces.end(),
                     [](const auto& f) { return f->internal_state_uses_multipliers(); }))
        return;
    // Fixed-point iteration of λ with Aitken's relaxation factor w. Without it the iteration diverges if
    // friction with a large coefficient has a long lever arm relative to the normal force.
    constexpr int max_iterations = 200;
    Eigen::VectorXd from, R, before;
    double w = 1;
    for (int k = 0; k < max_iterations && x.lambda.allFinite(); ++k) {
        from = x.lambda;
        solve_once();
        R = x.lambda - from;
        // rounding may prevent 1e-13
        if (R.norm() <= (k < max_iterations / 2 ? 1e-13 : 1e-10) * x.lambda.norm()) return;
        if (k > 0) w *= -before.dot(R - before) / (R - before).squaredNorm();
        x.lambda = from + w * R;
        before = R;
    }
    throw lie::NumericalFailure(
        "start_not_converged",
        "the friction forces and the normal forces on which they depend did not converge at the start in " +
            std::to_string(max_iterations) + " iterations; last change of the multipliers " +
            number(R.norm()));
}

/// Prepares the model at x, removes the rows that are redundant within `tolerance`, and projects the
/// positions onto the others. Returns the numbers of the removed rows. K: the saddle matrix of the model.
std::vector<int> project_without_redundant(Model& model, State& x, double tolerance,
                                           std::optional<lie::Saddle>& K)
{
    K.reset();
    model.prepare(x);
    std::vector<int> redundant;
    if (!model.keep_redundant) redundant = dependent_rows(model, x, tolerance);
    if (!redundant.empty()) model.drop(redundant);
    K.emplace(model, lie::Metric::mass, start_solver(model));
    if (model.rows() > 0) lie::project_positions(model, *K, x);
    return redundant;
}

/// Removes redundant rows and projects the positions x onto the constraints. Returns the numbers of the
/// removed rows. K: the saddle matrix of the model without them.
///
/// If the positions violate the constraints, a redundant row appears independent by about the size of the
/// violation. The positions are therefore first projected with a rank tolerance of this size. The tolerance
/// is reduced until the projected positions satisfy the removed rows as well.
std::vector<int> drop_redundant_and_project(Model& model, State& x, double residual,
                                            std::optional<lie::Saddle>& K)
{
    for (double tolerance = std::min(0.1, 10 * residual); tolerance > rank_tolerance; tolerance /= 10) {
        State candidate = x;
        try {
            const bool complete = project_without_redundant(model, candidate, tolerance, K).empty();
            if (!complete && !(model.largest_residual(candidate).value < redundancy_tolerance)) continue;
        } catch (const lie::NumericalFailure&) {
            continue;
        } catch (const ConstraintError&) {
            continue;
        }
        x = candidate;
        break;
    }
    std::vector<int> redundant = project_without_redundant(model, x, rank_tolerance, K);
    // Repeat at the projected positions. The complement of a driver is exact there, because the hinge is
    // exact.
    const auto has_complement = [](const Model::Row& row) { return row.complement != nullptr; };
    if (std::any_of(model.all_rows().begin(), model.all_rows().end(), has_complement))
        redundant = project_without_redundant(model, x, rank_tolerance, K);
    return redundant;
}

/// Number of the rows of a model with all rows that are redundant in the state x, for the report
int number_of_redundant(const Model& model, State x)
{
    try {
        return static_cast<int>(dependent_rows(model, x, rank_tolerance).size());
    } catch (const lie::NumericalFailure&) {
        return 0;  // contact forces that are not determined: they are those of minimum norm
    }
}

/// Violations of a general constraint: of a contact its own, otherwise the largest |Φ|, and the largest
/// |C v - ν| of the position rows
ContactConstraint::Violation position_violation(const Constraint& c, const Constraint::Arguments& x,
                                                double tolerance)
{
    if (const ContactConstraint* const contact = c.as_contact(); contact != nullptr)
        return contact->position_violation(x, tolerance);
    Eigen::Matrix<double, Constraint::max_position_rows, 1> Phi;
    c.phi(x, Phi.data());
    return {Phi.head(c.position_rows()).lpNorm<Eigen::Infinity>(), tolerance,
            "the initial positions violate the constraint by", "m"};
}

ContactConstraint::Violation velocity_violation(const Constraint& c, const Constraint::Arguments& x,
                                                double tolerance)
{
    if (const ContactConstraint* const contact = c.as_contact(); contact != nullptr)
        return contact->velocity_violation(x, tolerance);
    Constraint::Derivatives C;
    C.set_zero(c);
    c.variation(x, C);
    Eigen::Matrix<double, Constraint::max_rows, 1> right;
    c.nu(x, right.data());
    Eigen::Matrix<double, 6, 1> v_i, v_j;
    v_i << x.bi.rdot, x.bi.omega_bar;
    v_j << x.bj.rdot, x.bj.omega_bar;
    return {(C.C_i * v_i + C.C_j * v_j - right.head(C.C_i.rows()))
                .head(c.position_rows())
                .lpNorm<Eigen::Infinity>(),
            tolerance, "the initial velocities violate the constraint by", "m/s"};
}

using ViolationOf = ContactConstraint::Violation(const Constraint& c, const Constraint::Arguments& x,
                                                 double tolerance);

/// Throws ConstraintError if a violation of an active general constraint exceeds its limit, unless the
/// initial state may be projected. Records the largest violation.
void check_general_constraints(const Model& model, const State& x, const StartOptions& options,
                               ViolationOf* violation_of, double& residual, std::string& worst,
                               std::string& text)
{
    for (size_t k = 0; k < model.general_constraints().size(); ++k) {
        const Constraint& c = *model.general_constraints()[k];
        if (Model::inactive(c, x)) continue;
        const ContactConstraint::Violation v = violation_of(c, model.arguments(c, x), options.tolerance);
        if (!options.fix_initial && !(v.value <= v.most))
            throw ConstraintError(model.name_of(c) + ": " + v.text + " " + number(v.value) + " " + v.unit +
                                      ", at most " + number(v.most) + " " + v.unit +
                                      " is allowed; use --fix-initial to project the initial state onto the "
                                      "constraints",
                                  static_cast<int>(k), true);
        if (v.value > residual) {
            residual = v.value;
            worst = model.name_of(c);
            text = number(v.value) + ' ' + v.unit;
        }
    }
}

/// Throws lie::InvalidInput if the velocities of a body are so large that their squares overflow.
void check_velocities(const Model& model, const State& x)
{
    if (x.body.size() != model.mass().m.size()) return;  // rejected by Model::prepare()
    for (int b = 0; b < model.bodies(); ++b) {
        const lie::Motion& body = x.body[b];
        const double twice_energy = model.mass().m[b] * body.rdot.squaredNorm() +
                                    body.omega_bar.dot(model.mass().J_bar[b] * body.omega_bar);
        if (!std::isfinite(twice_energy))
            throw lie::InvalidInput("the initial velocity of body '" + model.body_name(b) +
                                    "' is too large: its kinetic energy overflows");
    }
}

}  // namespace

namespace {

/// Why the rigid bodies cannot start in x, "" if they can
std::string rigid_contact_error(const Model& model, const State& x)
{
    for (const auto& contacts : model.rigid_contacts())
        if (const std::string reason = contacts->start_error(x); !reason.empty())
            return (contacts->place.empty() ? "" : contacts->place + ": ") + reason;
    return {};
}

/// Refuses rigid bodies that overlap, or moves them apart by the shortest motion that keeps the joints
/// closed. Returns whether bodies have moved.
bool move_apart(const Model& model, State& x, const StartOptions& options)
{
    const std::string error = rigid_contact_error(model, x);
    if (error.empty()) return false;
    if (!options.fix_initial) throw lie::InvalidInput(error + "; use --fix-initial to move the bodies apart");
    constexpr double of_joints = 1e-10;  // [m, rad]
    lie::OverlapCorrection overlaps(model, of_joints);
    if (!overlaps.correct(x, 0) || !rigid_contact_error(model, x).empty())
        throw lie::InvalidInput(error +
                                "; no motion was found that moves the bodies apart and keeps the joints "
                                "closed");
    return true;
}

}  // namespace

StartReport start(Model& model, State& x, const StartOptions& options)
{
    check_velocities(model, x);
    model.prepare(x);
    StartReport report;
    report.rows = static_cast<int>(model.all_rows().size());
    if (report.rows > 0) {
        const Model::Residual position = model.largest_residual(x, Model::RowSet::blocks);
        report.position_residual = position.value;
        report.worst_position = model.name_of(model.all_rows()[position.row]);
        if (!std::isfinite(position.value))
            throw ConstraintError(report.worst_position + ": the residual at the start must be finite, got " +
                                      number(position.value),
                                  model.all_rows()[position.row].constraint);
        const Violation v = violation(model, model.all_rows()[position.row], x);
        report.position_violation = number(v.value) + ' ' + v.unit;
        if (!options.fix_initial && !(position.value <= options.tolerance))
            throw ConstraintError("the initial positions violate " + report.worst_position + " by " +
                                      report.position_violation + ", more than " + number(options.tolerance) +
                                      "; use --fix-initial to project them onto the constraints",
                                  model.all_rows()[position.row].constraint);
    }

    check_general_constraints(model, x, options, position_violation, report.position_residual,
                              report.worst_position, report.position_violation);
    std::optional<lie::Saddle> saddle;
    const std::vector<int> dropped = drop_redundant_and_project(model, x, report.position_residual, saddle);
    lie::Saddle& K = *saddle;
    for (const int k : dropped) report.dropped.push_back(model.name_of(model.all_rows()[k]));
    report.rank = model.rows() - model.pattern().algebraic_variables();
    if (model.keep_redundant) report.redundant = number_of_redundant(model, x);
    report.rank -= report.redundant;
    for (const auto& c : model.general_constraints())
        if (Model::inactive(*c, x))
            report.rank -= c->position_rows() - c->algebraic_variables() + c->velocity_rows();
        else
            report.rank -= 2 * c->bounded_pairs();
    report.degrees_of_freedom = 6 * model.bodies() - report.rank;

    if (move_apart(model, x, options)) {
        report.projected = true;
        K.assemble(x);
    }
    if (report.rows > 0) {
        // The velocities as given are checked at the projected positions.
        const Model::Residual velocity = model.largest_velocity_residual(x);
        report.velocity_residual = velocity.value;
        report.worst_velocity = model.name_of(model.all_rows()[velocity.row]);
        const Violation v = velocity_violation(model, model.all_rows()[velocity.row], x);
        report.velocity_violation = number(v.value) + ' ' + v.unit;
        if (!options.fix_initial && !(velocity.value <= options.tolerance))
            throw ConstraintError("the initial velocities violate " + report.worst_velocity + " by " +
                                      report.velocity_violation + ", more than " + number(options.tolerance) +
                                      "; use --fix-initial to project them onto the constraints",
                                  model.all_rows()[velocity.row].constraint);
    }
    check_general_constraints(model, x, options, velocity_violation, report.velocity_residual,
                              report.worst_velocity, report.velocity_violation);
    if (model.rows() > 0) {
        lie::project_velocities(model, K, x);
        report.projected = report.projected ||
                           std::max(report.position_residual, report.velocity_residual) > options.tolerance;
    }
    solve_with_internal_states(model, K, x);  // those of prepare() belong to positions before the projection
    const StaticStart friction = set_static_friction(model, K, x);
    if (!friction.has_converged)
        report.warnings.emplace_back(
            "the friction that holds bodies at rest could not be found at the start: its "
            "springs start unstretched");
    for (const Slipping& one : friction.slipping)
        report.warnings.push_back(model.force_of(one.force)->label() + ": its bodies are at rest, and " +
                                  one.name + " of " + number(one.needed) +
                                  " would hold them, more than the largest, " + number(one.bound) +
                                  "; they begin to slip");
    // If all rows are kept, the contradictory ones are not known: any row may have the residual.
    for (const int k : report.redundant > 0 ? model.active_rows() : dropped)
        check_redundant_row(model, model.all_rows()[k], x);
    set_spring_limits(model, K, x);
    model.set_tree(x);
    for (std::string& text : wrong_derivatives(model, x)) report.warnings.push_back(std::move(text));
    return report;
}

void set_start_accelerations(const Model& model, State& x)
{
    lie::Saddle K(model, lie::Metric::mass, start_solver(model));
    solve_with_internal_states(model, K, x);
    set_static_friction(model, K, x);
}

void check_dropped_rows(const Model& model, const State& x)
{
    for (const int k : model.dropped_rows()) {
        const Model::Row& row = model.all_rows()[k];
        const double residual = std::abs(model.scaled_residual(row, x));
        if (!(residual <= redundancy_tolerance))
            throw lie::NodeFailure(
                "constraint_drift",
                model.name_of(row) + ": removed as redundant at the start, now violated by " +
                    number(residual) + " m or rad, more than " + number(redundancy_tolerance) +
                    "; it is no longer redundant. With \"redundant\": \"keep\" in the "
                    "model file all rows are kept");
    }
}

}  // namespace hilda::dae
