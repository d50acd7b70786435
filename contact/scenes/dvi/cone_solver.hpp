// SPDX-License-Identifier: GPL-3.0-or-later
/// Accelerated projected gradient descent (APGD) for cone complementarity problems.

#pragma once

#include "contact/scenes/dvi/cone_problem.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

/// A ConeSolver did not reach its tolerance.
class ConeNoConvergence : public lie::NumericalFailure {
public:
    ConeNoConvergence(const std::string& what, double residual, int iterations)
        : NumericalFailure("cone_not_converged", what), residual(residual), iterations(iterations)
    {}

    double residual;  ///< last residual [m/s]
    int iterations;
};

/// Accelerated projected gradient descent for a ConeProblem (Nesterov's method; Mazhar, Heyn, Negrut and
/// Tasora 2015, algorithm APGD).
///
/// Impulses are measured in the metric G = diag(g_c I), g_c = tr(N_cc)/3, in which every cone remains the
/// same cone.
///
///     γ_{k+1} = Π_K(y_k - G⁻¹(N y_k + r)/L_k),    L_k doubled until δᵀN δ ≤ L_k δᵀG δ,  δ = γ_{k+1} - y_k
///     θ_{k+1} = ½ θ_k (√(θ_k² + 4) - θ_k),        β_k = θ_k (1 - θ_k)/(θ_k² + θ_{k+1})
///     y_{k+1} = γ_{k+1} + β_k (γ_{k+1} - γ_k),    L_{k+1} = 0.9 L_k
///
/// The method restarts, y_{k+1} = γ_{k+1} and θ_{k+1} = 1, if (N y_k + r) · (γ_{k+1} - γ_k) > 0, an ascent
/// direction. N y_{k+1} is combined from N γ_{k+1} and N γ_k, so N is applied once per iteration and once per
/// doubling.
///
/// Addition to the paper: L_k does not exceed L_max = max_c Σ_b n_b |N_cc,b|/g_c, with n_b contacts on body
/// b. Above this bound the test always holds; near the solution the test fails by rounding.
///
/// The residual is that of the natural map, a velocity:
///
///     max_c g_c |γ_c - Π_K(γ_c - u_c/g_c)|  [m/s],     u = N γ + r
class ConeSolver {
public:
    double tolerance = 1e-6;  ///< of the residual [m/s]; the error of an impulse is about the mass times this
    int max_iterations = 10000;  ///< of one cone problem
    int max_passes = 200;        ///< cone problems of solve_coulomb()

    struct Outcome {
        int iterations = 0;   ///< of all passes together
        double residual = 0;  ///< last residual [m/s]
        int passes = 1;       ///< cone problems solved
    };

    /// Solves the cone problem; γ is the initial guess and the result. Throws ConeNoConvergence, and
    /// lie::InvalidInput for a contact between two fixed bodies.
    Outcome solve(const ConeProblem& problem, std::vector<Vec3>& gamma);

    /// Solves Coulomb's law without the relaxation by a fixed-point iteration (Acary, Cadoux, Lemaréchal and
    /// Malick 2011). Each pass solves a cone problem with given slip speeds s_c = |u_t|:
    ///
    ///     r_n + μ s  in place of  r_n,      s_{k+1} = |u_t| of its solution
    ///
    /// until the residual plus max μ |s_{k+1} - s_k| is within the tolerance. If a pass reduces this change
    /// by less than a half, the later passes are relaxed: the relaxation factor is halved, down to 1/16.
    /// Without a sliding contact the result is that of solve(). s [m/s] is the initial guess and the result;
    /// from s = 0 the first pass is the relaxed problem. r is restored on return. Unlike the cone problem,
    /// Coulomb's law can have several solutions or none, and the iteration need not converge:
    /// ConeNoConvergence.
    Outcome solve_coulomb(ConeProblem& problem, std::vector<Vec3>& gamma, std::vector<double>& s);

    /// u = N γ + r of the last solution, in the contact frames [m/s]
    const std::vector<Vec3>& velocities() const { return u; }

private:
    void apply(const ConeProblem& problem, const std::vector<Vec3>& gamma, std::vector<Vec3>& N_gamma);
    void set_metric(const ConeProblem& problem);
    double residual(const ConeProblem& problem, const std::vector<Vec3>& gamma);

    std::vector<double> g, r_n;
    double L_max = 0;
    std::vector<ConeProblem::Velocity> velocity_change;
    std::vector<Vec3> y, next, N_gamma, N_y, N_next, u;
    std::vector<int> contacts;  // number of contacts of each body
};

}  // namespace hilda::contact
