// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/start.hpp"

#include "dae/rank.hpp"
#include "lie/bounded_rows.hpp"

#include <algorithm>

namespace hilda::dae {

namespace {

// A row is redundant when what it adds to the rows before it is shorter than this, rows having length one.
// Coordinates written with nine or ten digits must not hide a redundant row, and a driver near its singular
// point is not one.
constexpr double rank_tolerance = 1e-7;
// A redundant row agrees with the others when it holds to this, scaled, once the others do.
constexpr double agreement = 1e-6;

std::string number(double value)
{
    std::ostringstream text;
    text.precision(3);
    text << value;
    return text.str();
}

/// KLU, whose digits count at a start, but for many contacts, of which only those that are closed are then factored
lie::LinearSolver solver_of(const Model& model)
{
    return model.evolving().empty() ? lie::LinearSolver::klu : lie::LinearSolver::automatic;
}

/// A row dropped from the equations, in position, velocity and acceleration, each relative to what moves there;
/// all three vanish when it says nothing new.
void check_agreement(const Model& model, const Model::Row& row, const State& x)
{
    double velocity_scale = 1, acceleration_scale = 1;
    for (const int b : {row.block->i, row.block->j}) {
        if (b == ground) continue;
        const Motion& body = x.body[b];
        velocity_scale = std::max({velocity_scale, body.rdot.norm(), body.omega_bar.norm()});
        acceleration_scale = std::max({acceleration_scale, body.rddot.norm(), body.omegadot_bar.norm()});
    }
    const auto check = [&](const char* level, double residual, double scale) {
        if (std::abs(residual) > agreement * scale)
            throw ConstraintError(model.name_of(row) + ": contradicts the constraints before it in " + level +
                                      ", by " + number(residual),
                                  row.constraint);
    };
    check("position", model.scaled_residual(row, x), 1);
    check("velocity", model.scaled_velocity_residual(row, x), velocity_scale);
    check("acceleration", model.scaled_acceleration_residual(row, x), acceleration_scale);
}

}  // namespace

int project_positions(const Model& model, lie::Saddle& K, State& x, double tolerance)
{
    Eigen::VectorXd step(K.size());
    constexpr int most = 50;
    double farthest = 0;  // from the origin, where rounding is coarser
    for (const lie::Motion& body : x.body) farthest = std::max(farthest, body.r.norm());
    tolerance = std::max(tolerance, 8 * std::numeric_limits<double>::epsilon() * farthest);
    const auto residual = [&] { return model.largest_residual(x, Model::Over::in_equations).value; };
    for (int k = 0;; ++k) {
        const double before = residual();
        if (!std::isfinite(before))
            throw lie::NonFinite("a constraint has no finite value while positions are projected");
        K.assemble(x);
        step.setZero();
        model.phi(x, K.constraint_part(step));
        step *= -1;
        K.solve_refined(step);
        // A half-way house for far starts: no body turns by more than half a radian in one step.
        double turn = 0;
        for (int b = 0; b < model.bodies(); ++b) turn = std::max(turn, step.segment<3>(6 * b + 3).norm());
        const double part = turn > 0.5 ? 0.5 / turn : 1;
        const State from = x;
        for (int b = 0; b < model.bodies(); ++b) {
            x.body[b].r += part * step.segment<3>(6 * b);
            x.body[b].A = lie::orthonormalised(x.body[b].A * lie::exp(part * step.segment<3>(6 * b + 3)));
        }
        if (x.alpha.size() > 0)
            x.alpha += part * K.algebraic_part(step);  // those of a model are in its order
        // Goes on below the tolerance for as long as it still gains: the last step is free and gives the last
        // digits.
        const double after = residual();
        if (before <= tolerance && after >= 0.1 * before) {
            if (after > before) x = from;
            return k;
        }
        if (k == most)
            throw lie::NoConvergence(
                "no position satisfies the constraints near the one given; largest residual " +
                    number(after) + " in " +
                    model.name_of(model.largest_residual(x, Model::Over::in_equations)),
                after, most);
    }
}

void project_velocities(const lie::System& system, lie::Saddle& K, State& x)
{
    K.assemble(x);
    Eigen::VectorXd v(K.size());
    for (int b = 0; b < system.bodies(); ++b) {
        v.segment<3>(6 * b) = system.mass().m[b] * x.body[b].rdot;
        v.segment<3>(6 * b + 3) = system.mass().J_bar[b] * x.body[b].omega_bar;
    }
    K.algebraic_part(v).setZero();
    system.nu(x, K.constraint_part(v));
    K.solve_refined(v);
    for (int b = 0; b < system.bodies(); ++b) {
        x.body[b].rdot = v.segment<3>(6 * b);
        x.body[b].omega_bar = v.segment<3>(6 * b + 3);
    }
}

namespace {

// Friction in the equations of a step is, at a start, as stiff as over a long step, and stops what slips within an instant,
// if it can [s].
constexpr double as_stiff_as_in = 1, an_instant = 1e-6;

/// C a = γ - C v/τ for the rows that give way, so that their acceleration is γ where nothing slips and against the slip where
/// something does
void stop_within(double tau, const lie::Rows& C, const State& x, Eigen::VectorXd& a)
{
    for (const lie::Rows::Regularised& c : C.regularised)
        for (int k = c.first; k < c.first + 2; ++k) {
            double slip = 0;
            for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
                const lie::Motion& body = x.body[C.entry[n].body];
                slip += C.entry[n].r.dot(body.rdot) + C.entry[n].pi.dot(body.omega_bar);
            }
            a[6 * static_cast<int>(x.body.size()) + k] -= slip / tau;
        }
}

}  // namespace

void solve_accelerations(const lie::System& system, lie::Saddle& K, State& x)
{
    lie::BoundedRows within_bounds(system.pattern());
    within_bounds.all_stick(K);
    K.assemble(x, as_stiff_as_in);
    lie::Loads loads(system.bodies());
    system.loads(x, loads);
    Eigen::VectorXd a(K.size());
    for (int b = 0; b < system.bodies(); ++b) {
        const Vec3& omega_bar = x.body[b].omega_bar;
        a.segment<3>(6 * b) = loads.F[b];
        a.segment<3>(6 * b + 3) = loads.n_bar[b] - omega_bar.cross(system.mass().J_bar[b] * omega_bar);
    }
    K.algebraic_part(a).setZero();
    system.gamma(x, K.constraint_part(a));
    stop_within(an_instant, K.rows(), x, a);
    if (!a.allFinite()) throw lie::NonFinite("a load or a constraint is not finite");
    const Eigen::VectorXd right_side = a;
    constexpr int most = 100;
    for (int k = 0;; ++k) {
        K.solve_refined(a);
        if (within_bounds(K, K.rows(), a, x)) break;
        if (k == most)
            throw lie::NumericalFailure(
                "start_not_converged",
                "friction and the normal forces that bound it do not settle at the start");
        a = right_side;
    }
    for (int b = 0; b < system.bodies(); ++b) {
        x.body[b].rddot = a.segment<3>(6 * b);
        x.body[b].omegadot_bar = a.segment<3>(6 * b + 3);
    }
    x.lambda = K.constraint_part(a);
}

namespace {

/// Accelerations and multipliers at a start, and what the forces remember of it
void settle(const Model& model, lie::Saddle& K, State& x)
{
    const auto once = [&] {
        model.set_internal_state_at_start(x);
        solve_accelerations(model, K, x);
    };
    once();
    const auto& forces = model.forces();
    if (std::none_of(forces.begin(), forces.end(),
                     [](const auto& f) { return f->internal_state_uses_multipliers(); }))
        return;
    // λ goes by w times what a pass makes of it, with the w of Aitken's extrapolation: passes alone diverge where much
    // friction has a long lever against the normal force.
    constexpr int most = 200;
    Eigen::VectorXd from, R, before;
    double w = 1;
    for (int k = 0; k < most && x.lambda.allFinite(); ++k) {
        from = x.lambda;
        once();
        R = x.lambda - from;
        if (R.norm() <= (k < most / 2 ? 1e-13 : 1e-10) * x.lambda.norm()) return;  // rounding may be more
        if (k > 0) w *= -before.dot(R - before) / (R - before).squaredNorm();
        x.lambda = from + w * R;
        before = R;
    }
    throw lie::NumericalFailure(
        "start_not_converged",
        "friction and the normal forces that it depends on do not settle at the start; "
        "the multipliers still change by " +
            number(R.norm()));
}

/// Readies the model at x without the rows that add less than `tolerance` to those before them, and projects
/// positions onto the others. Returns the numbers of the rows left out.
std::vector<int> project_without_redundant(Model& model, State& x, double tolerance)
{
    model.prepare(x);
    const std::vector<int> redundant = dependent_rows(model, x, tolerance);
    for (const int k : redundant) model.drop(k);
    if (model.rows() > 0) {
        lie::Saddle K(model, lie::Metric::mass, solver_of(model));
        project_positions(model, K, x);
    }
    return redundant;
}

/// Puts x on the constraints, and the model into the form without redundant rows it has there.
///
/// Off the constraints a redundant row looks independent, by about as much as the data are off. So data to be
/// mended are first mended with rows counted as redundant up to that, and less and less until the mended
/// positions satisfy the rows left out as well.
std::vector<int> drop_and_project(Model& model, State& x, double residual)
{
    for (double tolerance = std::min(0.1, 10 * residual); tolerance > rank_tolerance; tolerance /= 10) {
        State mended = x;
        try {
            const bool complete = project_without_redundant(model, mended, tolerance).empty();
            if (!complete && !(model.largest_residual(mended).value < agreement)) continue;
        } catch (const lie::NumericalFailure&) {
            continue;
        } catch (const ContactError&) {
            continue;
        }
        x = mended;
        break;
    }
    std::vector<int> redundant = project_without_redundant(model, x, rank_tolerance);
    // Once more where x is now: there a driver's complement is exact, being made from hinges that are.
    const auto has_complement = [](const Model::Row& row) { return row.complement != nullptr; };
    if (std::any_of(model.all_rows().begin(), model.all_rows().end(), has_complement))
        redundant = project_without_redundant(model, x, rank_tolerance);
    return redundant;
}

}  // namespace

namespace {

/// Bodies that are to be in contact and are not, unless they may be moved; and what of it is the largest error
void check_contact_positions(const Model& model, const State& x, const StartOptions& options,
                             StartReport& report)
{
    for (size_t k = 0; k < model.evolving().size(); ++k) {
        const auto& c = model.evolving()[k];
        if (Model::inactive(*c, x)) continue;
        const double error = std::abs(c->gap(model.at(*c, x)));
        if (!options.fix_initial && !(error <= c->allowance()))
            throw ContactError(model.name_of(*c) + ": not in contact at the start, a gap or overlap of " +
                                   number(error) + " m, more than " + number(c->allowance()) +
                                   " m; --fix-initial closes it",
                               static_cast<int>(k));
        if (error > report.position_residual) {
            report.position_residual = error;
            report.worst_position = model.name_of(*c);
        }
    }
}

void check_contact_velocities(const Model& model, const State& x, const StartOptions& options,
                              StartReport& report)
{
    for (size_t k = 0; k < model.evolving().size(); ++k) {
        const auto& c = model.evolving()[k];
        if (Model::inactive(*c, x)) continue;
        const double error = c->velocity_error(model.at(*c, x));
        if (!options.fix_initial && !(error <= options.tolerance))
            throw ContactError(model.name_of(*c) + ": the initial velocities violate the contact by " +
                                   number(error) + " m/s, more than " + number(options.tolerance) +
                                   "; --fix-initial tries to move them",
                               static_cast<int>(k));
        if (error > report.velocity_residual) {
            report.velocity_residual = error;
            report.worst_velocity = model.name_of(*c);
        }
    }
}

}  // namespace

StartReport start(Model& model, State& x, const StartOptions& options)
{
    model.prepare(x);
    StartReport report;
    report.rows = static_cast<int>(model.all_rows().size());
    if (report.rows > 0) {
        const Model::Residual position = model.largest_residual(x, Model::Over::blocks);
        report.position_residual = position.value;
        report.worst_position = model.name_of(model.all_rows()[position.row]);
        if (!std::isfinite(position.value))
            throw ConstraintError(
                report.worst_position + ": has no finite value at the start, got " + number(position.value),
                model.all_rows()[position.row].constraint);
        if (!options.fix_initial && position.value > options.tolerance)
            throw ConstraintError("the initial positions violate " + report.worst_position + " by " +
                                      number(position.value) + ", more than " + number(options.tolerance) +
                                      " m or rad; --fix-initial tries to move them",
                                  model.all_rows()[position.row].constraint);
    }

    check_contact_positions(model, x, options, report);
    const std::vector<int> dropped = drop_and_project(model, x, report.position_residual);
    for (const int k : dropped) report.dropped.push_back(model.name_of(model.all_rows()[k]));
    report.rank = model.rows() - model.pattern().unknowns();
    for (const auto& c : model.evolving())
        if (Model::inactive(*c, x))
            report.rank -= c->rows() - c->unknowns() + c->velocity_rows();
        else if (c->is_regularised())
            report.rank -= c->velocity_rows();
    report.degrees_of_freedom = 6 * model.bodies() - report.rank;

    lie::Saddle K(model, lie::Metric::mass, solver_of(model));
    if (report.rows > 0) {
        // the velocities given belong to the positions given; they are judged where these are now
        const Model::Residual velocity = model.largest_velocity_residual(x);
        report.velocity_residual = velocity.value;
        report.worst_velocity = model.name_of(model.all_rows()[velocity.row]);
        if (!options.fix_initial && !(velocity.value <= options.tolerance))
            throw ConstraintError("the initial velocities violate " + report.worst_velocity + " by " +
                                      number(velocity.value) + ", more than " + number(options.tolerance) +
                                      " m/s or rad/s; --fix-initial tries to move them",
                                  model.all_rows()[velocity.row].constraint);
    }
    check_contact_velocities(model, x, options, report);
    if (model.rows() > 0) {
        project_velocities(model, K, x);
        report.projected = std::max(report.position_residual, report.velocity_residual) > options.tolerance;
    }
    settle(model, K, x);  // what prepare() let them remember is of a start not yet on the constraints
    for (const int k : dropped) check_agreement(model, model.all_rows()[k], x);
    return report;
}

void check_dropped_rows(const Model& model, const State& x)
{
    for (const int k : model.dropped_rows()) {
        const Model::Row& row = model.all_rows()[k];
        const double residual = std::abs(model.scaled_residual(row, x));
        if (!(residual <= agreement))
            throw lie::NumericalFailure(
                "constraint_drift", model.name_of(row) + ", dropped as redundant at the start, is off by " +
                                        number(residual) + ", more than " + number(agreement) + " m or rad");
    }
}

}  // namespace hilda::dae
