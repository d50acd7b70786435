// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/start.hpp"

#include <SuiteSparseQR.hpp>

#include <memory>
#include <numeric>

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

/// The rows that depend on those before them, as numbers into model.active_rows(). In the metric of the mass,
/// so that the answer does not depend on units.
std::vector<int> dependent_rows(const Model& model, const State& x)
{
    lie::Rows C = model.pattern();
    model.variation(x, C);
    const int m = C.rows(), n = 6 * model.bodies();

    cholmod_common common;
    cholmod_l_start(&common);
    common.print = 0;
    // column k of the matrix is row k of the constraints
    cholmod_triplet* triplets =
        cholmod_l_allocate_triplet(n, m, 6 * C.entry.size(), 0, CHOLMOD_REAL, &common);
    auto* row = static_cast<SuiteSparse_long*>(triplets->i);
    auto* column = static_cast<SuiteSparse_long*>(triplets->j);
    auto* value = static_cast<double*>(triplets->x);
    for (int k = 0; k < m; ++k) {
        double sum = 0;
        const size_t first = triplets->nnz;
        for (int e = C.start[k]; e < C.start[k + 1]; ++e)
            for (int c = 0; c < 6; ++c) {
                const int b = C.entry[e].body;
                const double inertia = c < 3 ? model.mass().m[b] : model.mass().J_bar[b](c - 3, c - 3);
                const double v = (c < 3 ? C.entry[e].r[c] : C.entry[e].pi[c - 3]) / std::sqrt(inertia);
                if (v == 0) continue;
                row[triplets->nnz] = 6 * b + c;
                column[triplets->nnz] = k;
                value[triplets->nnz++] = v;
                sum += v * v;
            }
        for (size_t e = first; e < triplets->nnz; ++e) value[e] /= std::sqrt(sum);
    }
    cholmod_sparse* A = cholmod_l_triplet_to_sparse(triplets, triplets->nnz, &common);
    cholmod_l_free_triplet(&triplets, &common);

    // The order is kept, so that of two equal rows the later one is the redundant one.
    cholmod_sparse* R = nullptr;
    SuiteSparse_long* E = nullptr;
    const SuiteSparse_long rank =
        SuiteSparseQR<double>(SPQR_ORDERING_FIXED, rank_tolerance, 0, A, &R, &E, &common);
    std::vector<int> dependent;
    for (SuiteSparse_long k = rank; k < m; ++k)
        dependent.push_back(static_cast<int>(E != nullptr ? E[k] : k));
    std::sort(dependent.begin(), dependent.end());

    cholmod_l_free(m, sizeof(SuiteSparse_long), E, &common);
    cholmod_l_free_sparse(&R, &common);
    cholmod_l_free_sparse(&A, &common);
    cholmod_l_finish(&common);
    if (rank < 0) throw lie::SingularMatrix("SuiteSparseQR found no rank for the constraints", 0);
    return dependent;
}

/// Row k, dropped from the equations, in position, velocity and acceleration; all three vanish when it says
/// nothing new.
void check_agreement(const Model& model, const Model::Row& row, const State& x)
{
    const Block& block = row.in_force(x);
    static const Motion at_rest;
    const Motion& bi = block.i == ground ? at_rest : x.body[block.i];
    const Motion& bj = block.j == ground ? at_rest : x.body[block.j];
    const Variation v = block.variation(bi, bj, x.t);
    const double size =
        std::sqrt(v.r_i.squaredNorm() + v.pi_i.squaredNorm() + v.r_j.squaredNorm() + v.pi_j.squaredNorm());

    const double position = block.phi(bi, bj, x.t) / size;
    const double velocity = (v.r_i.dot(bi.rdot) + v.pi_i.dot(bi.omega_bar) + v.r_j.dot(bj.rdot) +
                             v.pi_j.dot(bj.omega_bar) - block.nu(bi, bj, x.t)) /
                            size;
    const double acceleration = (v.r_i.dot(bi.rddot) + v.pi_i.dot(bi.omegadot_bar) + v.r_j.dot(bj.rddot) +
                                 v.pi_j.dot(bj.omegadot_bar) - block.gamma(bi, bj, x.t)) /
                                size;
    double scale = 1;
    for (const Motion* b : {&bi, &bj}) scale = std::max({scale, b->rddot.norm(), b->omegadot_bar.norm()});
    const char* level = std::abs(position) > agreement               ? "position"
                        : std::abs(velocity) > agreement * scale     ? "velocity"
                        : std::abs(acceleration) > agreement * scale ? "acceleration"
                                                                     : nullptr;
    if (level != nullptr)
        throw ConstraintError(model.name_of(row) + ": contradicts the constraints before it in " + level +
                                  ", by " +
                                  number(level[0] == 'p'   ? position
                                         : level[0] == 'v' ? velocity
                                                           : acceleration),
                              row.constraint);
}

}  // namespace

int project_positions(const Model& model, lie::Saddle& K, State& x, double tolerance)
{
    Eigen::VectorXd step(K.size());
    constexpr int most = 50;
    const auto residual = [&] {
        double largest = 0;
        for (const int k : model.active_rows())
            largest = std::max(largest, std::abs(model.scaled_residual(model.all_rows()[k], x)));
        return largest;
    };
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
                    number(after) + " in " + model.name_of(model.all_rows()[model.largest_residual(x).row]),
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
    system.nu(x, K.constraint_part(v));
    K.solve_refined(v);
    for (int b = 0; b < system.bodies(); ++b) {
        x.body[b].rdot = v.segment<3>(6 * b);
        x.body[b].omega_bar = v.segment<3>(6 * b + 3);
    }
}

void solve_accelerations(const lie::System& system, lie::Saddle& K, State& x)
{
    K.assemble(x);
    lie::Loads loads(system.bodies());
    system.loads(x, loads);
    Eigen::VectorXd a(K.size());
    for (int b = 0; b < system.bodies(); ++b) {
        const Vec3& omega_bar = x.body[b].omega_bar;
        a.segment<3>(6 * b) = loads.F[b];
        a.segment<3>(6 * b + 3) = loads.n_bar[b] - omega_bar.cross(system.mass().J_bar[b] * omega_bar);
    }
    system.gamma(x, K.constraint_part(a));
    if (!a.allFinite()) throw lie::NonFinite("a load or a constraint is not finite");
    K.solve_refined(a);
    for (int b = 0; b < system.bodies(); ++b) {
        x.body[b].rddot = a.segment<3>(6 * b);
        x.body[b].omegadot_bar = a.segment<3>(6 * b + 3);
    }
    x.lambda = K.constraint_part(a);
}

StartReport start(Model& model, State& x, const StartOptions& options)
{
    model.prepare(x);
    StartReport report;
    report.rows = static_cast<int>(model.all_rows().size());
    if (report.rows > 0) {
        const Model::Residual position = model.largest_residual(x);
        report.position_residual = position.value;
        report.worst_position = model.name_of(model.all_rows()[position.row]);
        if (!std::isfinite(position.value))
            throw ConstraintError(
                report.worst_position + ": has no finite value at the start, got " + number(position.value),
                model.all_rows()[position.row].constraint);
        if (!options.fix_initial && position.value > options.tolerance)
            throw ConstraintError("the initial positions violate " + report.worst_position + " by " +
                                      number(position.value) + ", more than " + number(options.tolerance) +
                                      " m or rad; --fix-initial moves them",
                                  model.all_rows()[position.row].constraint);
    }

    const std::vector<int> dependent = dependent_rows(model, x);
    std::vector<int> dropped;
    for (const int k : dependent) dropped.push_back(model.active_rows()[k]);
    for (const int k : dropped) {
        report.dropped.push_back(model.name_of(model.all_rows()[k]));
        model.drop(k);
    }
    report.rank = report.rows - static_cast<int>(dropped.size());
    report.degrees_of_freedom = 6 * model.bodies() - report.rank;
    x.lambda = Eigen::VectorXd::Zero(report.rank);

    lie::Saddle K(model);
    const State given = x;
    if (report.rows > 0) {
        project_positions(model, K, x);
        State turned =
            given;  // the velocities given belong to the positions given; judge them where they now are
        for (size_t b = 0; b < x.body.size(); ++b)
            turned.body[b].r = x.body[b].r, turned.body[b].A = x.body[b].A;
        const Model::Residual velocity = model.largest_velocity_residual(turned);
        report.velocity_residual = velocity.value;
        report.worst_velocity = model.name_of(model.all_rows()[velocity.row]);
        if (!options.fix_initial && !(velocity.value <= options.tolerance))
            throw ConstraintError("the initial velocities violate " + report.worst_velocity + " by " +
                                      number(velocity.value) + ", more than " + number(options.tolerance) +
                                      " m/s or rad/s; --fix-initial moves them",
                                  model.all_rows()[velocity.row].constraint);
        project_velocities(model, K, x);
        report.projected = std::max(report.position_residual, report.velocity_residual) > options.tolerance;
    }
    solve_accelerations(model, K, x);
    for (const int k : dropped) check_agreement(model, model.all_rows()[k], x);
    return report;
}

}  // namespace hilda::dae
