// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/dvi/cone_solver.hpp"

#include <algorithm>
#include <limits>

namespace hilda::contact {

namespace {

// solve_coulomb(): tolerance of a pass relative to that of the law, so that the error of a pass does not
// limit the fixed point; reduction of the change below which the iteration is relaxed; smallest relaxation
// factor.
constexpr double inner_tolerance = 0.1, slow_progress = 0.5, min_relaxation = 1. / 16;

[[noreturn]] void fail(const char* problem_name, size_t contacts, double residual, double tolerance,
                       int count, const char* counted)
{
    std::ostringstream text;
    text << problem_name << " of " << contacts << " contacts did not converge: residual " << residual
         << " m/s above the tolerance of " << tolerance << " m/s after " << count << ' ' << counted;
    throw ConeNoConvergence(text.str(), residual, count);
}

}  // namespace

void ConeSolver::apply(const ConeProblem& problem, const std::vector<Vec3>& gamma, std::vector<Vec3>& N_gamma)
{
    problem.velocity_change(gamma, velocity_change);
    problem.relative_velocities(velocity_change, N_gamma);
}

/// Sets g and L_max, from |Σ_c∈b M_b^-½ D_cb γ_c|² ≤ n_b Σ_c∈b γ_cᵀ N_cc,b γ_c summed over the bodies b.
void ConeSolver::set_metric(const ConeProblem& problem)
{
    contacts.assign(problem.body.size(), 0);
    for (const ConeProblem::ContactPair& c : problem.contact) ++contacts[c.i], ++contacts[c.j];
    g.resize(problem.contact.size());
    L_max = 0;
    for (size_t c = 0; c < g.size(); ++c) {
        const ConeProblem::ContactPair& at = problem.contact[c];
        const auto [of_i, of_j] = problem.block(at);
        g[c] = (of_i.trace() + of_j.trace()) / 3;
        if (!(g[c] > 0))
            lie::reject("contact::ConeSolver", "a contact needs at least one movable body; contact", c);
        L_max = std::max(L_max, (contacts[at.i] * of_i.norm() + contacts[at.j] * of_j.norm()) / g[c]);
    }
}

double ConeSolver::residual(const ConeProblem& problem, const std::vector<Vec3>& gamma)
{
    double worst = 0;
    u.resize(gamma.size());
    for (size_t c = 0; c < gamma.size(); ++c) {
        u[c] = N_gamma[c] + problem.contact[c].r;
        const Vec3 natural = gamma[c] - project_on_cone(gamma[c] - u[c] / g[c], problem.contact[c].mu);
        const double here = g[c] * natural.norm();
        if (!(here <= worst)) worst = here;  // also true for NaN
    }
    return worst;
}

ConeSolver::Outcome ConeSolver::solve(const ConeProblem& problem, std::vector<Vec3>& gamma)
{
    const size_t contacts = problem.contact.size();
    set_metric(problem);
    gamma.resize(contacts, Vec3::Zero());
    for (size_t c = 0; c < contacts; ++c) gamma[c] = project_on_cone(gamma[c], problem.contact[c].mu);
    apply(problem, gamma, N_gamma);
    y = gamma;
    N_y = N_gamma;
    next.resize(contacts);

    Outcome out;
    out.residual = residual(problem, gamma);
    double theta = 1, L = 1;  // 1 is the mean eigenvalue of G⁻¹ N
    while (!(out.residual <= tolerance)) {
        if (out.iterations == max_iterations || !std::isfinite(out.residual))
            fail("contact::ConeSolver: the cone problem", contacts, out.residual, tolerance, out.iterations,
                 "iterations");
        ++out.iterations;
        for (bool backtrack = true; backtrack;) {
            for (size_t c = 0; c < contacts; ++c) {
                const ConeProblem::ContactPair& at = problem.contact[c];
                next[c] = project_on_cone(y[c] - (N_y[c] + at.r) / (L * g[c]), at.mu);
            }
            apply(problem, next, N_next);
            double curvature = 0, length = 0;
            for (size_t c = 0; c < contacts; ++c) {
                const Vec3 delta = next[c] - y[c];
                curvature += delta.dot(N_next[c] - N_y[c]);
                length += g[c] * delta.squaredNorm();
            }
            backtrack = L < L_max && curvature > L * length;
            if (backtrack) L = std::min(2 * L, L_max);
        }
        double slope = 0;
        for (size_t c = 0; c < contacts; ++c)
            slope += (N_y[c] + problem.contact[c].r).dot(next[c] - gamma[c]);
        double theta_next = 0.5 * theta * (std::sqrt(theta * theta + 4) - theta);
        double beta = theta * (1 - theta) / (theta * theta + theta_next);
        if (slope > 0) theta_next = 1, beta = 0;
        for (size_t c = 0; c < contacts; ++c) {
            y[c] = next[c] + beta * (next[c] - gamma[c]);
            N_y[c] = N_next[c] + beta * (N_next[c] - N_gamma[c]);
        }
        gamma.swap(next);
        N_gamma.swap(N_next);
        theta = theta_next;
        L *= 0.9;
        out.residual = residual(problem, gamma);
    }
    return out;
}

ConeSolver::Outcome ConeSolver::solve_coulomb(ConeProblem& problem, std::vector<Vec3>& gamma,
                                              std::vector<double>& s)
{
    const size_t contacts = problem.contact.size();
    s.resize(contacts, 0);
    r_n.resize(contacts);
    for (size_t c = 0; c < contacts; ++c) r_n[c] = problem.contact[c].r[0];
    const auto restore = [&] {
        for (size_t c = 0; c < contacts; ++c) problem.contact[c].r[0] = r_n[c];
    };
    const double outer_tolerance = tolerance;
    Outcome total{.passes = 0};
    double relaxation = 1, previous_change = std::numeric_limits<double>::infinity();
    while (total.passes < max_passes) {
        for (size_t c = 0; c < contacts; ++c) problem.contact[c].r[0] = r_n[c] + problem.contact[c].mu * s[c];
        Outcome pass;
        try {
            tolerance = inner_tolerance * outer_tolerance;
            pass = solve(problem, gamma);
        } catch (...) {
            tolerance = outer_tolerance;
            restore();
            throw;
        }
        tolerance = outer_tolerance;
        restore();
        ++total.passes;
        total.iterations += pass.iterations;
        double slip_change = 0;
        for (size_t c = 0; c < contacts; ++c) {
            const double mu = problem.contact[c].mu, slip = std::hypot(u[c][1], u[c][2]);
            u[c][0] -= mu * s[c];
            slip_change = std::max(slip_change, mu * std::abs(slip - s[c]));
        }
        total.residual = pass.residual + slip_change;
        if (!(slip_change <= slow_progress * previous_change))
            relaxation = std::max(0.5 * relaxation, min_relaxation);
        previous_change = slip_change;
        const bool done = total.residual <= tolerance;
        for (size_t c = 0; c < contacts; ++c) {
            const double slip = std::hypot(u[c][1], u[c][2]);
            s[c] += done ? slip - s[c] : relaxation * (slip - s[c]);
        }
        if (done) return total;
    }
    fail("contact::ConeSolver: Coulomb's law", contacts, total.residual, tolerance, total.passes,
         "cone problems");
}

}  // namespace hilda::contact
