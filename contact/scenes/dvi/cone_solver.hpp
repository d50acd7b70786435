// SPDX-License-Identifier: GPL-3.0-or-later
/// Accelerated projected gradients for cone complementarity problems.

#pragma once

#include "contact/scenes/dvi/cone_problem.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

/// The impulses of rigid contacts did not reach their tolerance.
class ConeNoConvergence : public lie::NumericalFailure {
public:
    ConeNoConvergence(const std::string& what, double residual, int iterations)
        : NumericalFailure("cone_not_converged", what), residual(residual), iterations(iterations)
    {}

    double residual;  ///< [m/s]
    int iterations;
};

/// Nesterov's method for the minimum of a ConeProblem (Mazhar, Heyn, Negrut and Tasora 2015, algorithm APGD), with
/// lengths of γ measured by G = diag(g_c I), g_c = tr(N_cc)/3, of which every cone stays the cone it is:
///
///     γ_{k+1} = Π_K(y_k - G⁻¹(N y_k + r)/L_k),    L_k doubled until δᵀN δ ≤ L_k δᵀG δ,  δ = γ_{k+1} - y_k
///     θ_{k+1} = ½ θ_k (√(θ_k² + 4) - θ_k),        β_k = θ_k (1 - θ_k)/(θ_k² + θ_{k+1})
///     y_{k+1} = γ_{k+1} + β_k (γ_{k+1} - γ_k),    L_{k+1} = 0.9 L_k
///
/// It begins anew, y_{k+1} = γ_{k+1} and θ_{k+1} = 1, where (N y_k + r)·(γ_{k+1} - γ_k) > 0: it would go uphill. As
/// N y_{k+1} follows from N γ_{k+1} and N γ_k, N is applied once an iteration, and once for each doubling. Beside the
/// paper: L never exceeds the bound L_max = max_c Σ_b n_b |N_cc,b|/g_c, with n_b contacts on body b, above which no
/// test is needed; the test itself is lost in rounding near the solution.
///
/// The residual is that of the natural map, a velocity:
///
///     max_c g_c |γ_c - Π_K(γ_c - u_c/g_c)|  [m/s],     u = N γ + r
class ConeSolver {
public:
    double tolerance = 1e-6;  ///< of the residual [m/s]; an impulse is wrong by about the mass times this
    int max_iterations = 10000;
    int max_passes = 200;  ///< of solve_coulomb()

    struct Outcome {
        int iterations = 0;   ///< all together
        double residual = 0;  ///< [m/s]
        int passes = 1;       ///< cone problems solved
    };

    /// From the γ given to that of the minimum. ConeNoConvergence, InvalidInput for a contact of two bodies neither of
    /// which moves.
    Outcome solve(const ConeProblem& problem, std::vector<Vec3>& gamma);

    /// Coulomb's law without the relaxation, by a fixed point (Acary, Cadoux, Lemaréchal and Malick 2011): a cone problem
    /// with the slip speeds s_c = |u_t| given,
    ///
    ///     r_n + μ s  in place of  r_n,      s_{k+1} = |u_t| of its solution
    ///
    /// until the residual and μ |s_{k+1} - s_k| together are within the tolerance. Where a pass gains less than a half, the
    /// next ones go half as far. Nothing is relaxed where no contact slides. s [m/s] is where to begin, and the result; from
    /// s = 0 the first pass is the relaxation. r is as it was when it returns. Unlike the cone problem the law may have many
    /// solutions or none, and the fixed point need not be found: ConeNoConvergence.
    Outcome solve_coulomb(ConeProblem& problem, std::vector<Vec3>& gamma, std::vector<double>& s);

    /// u = N γ + r of what was solved last [m/s]
    const std::vector<Vec3>& velocities() const { return u; }

private:
    void apply(const ConeProblem& problem, const std::vector<Vec3>& gamma, std::vector<Vec3>& N_gamma);
    void measure(const ConeProblem& problem);
    double residual(const ConeProblem& problem, const std::vector<Vec3>& gamma);

    std::vector<double> g, r_n;
    double L_max = 0;
    std::vector<ConeProblem::Velocity> change;
    std::vector<Vec3> y, next, N_gamma, N_y, N_next, u;
    std::vector<int> contacts;  // on each body
};

}  // namespace hilda::contact
