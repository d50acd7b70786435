// SPDX-License-Identifier: GPL-3.0-or-later
/// Proximal semismooth Newton method (augmented Lagrangian) for the cone problem.
///
/// For the convex problem with the offsets s + β, an outer iteration with the proximal terms R_c = ρ g_c
/// solves
///
///     M v + C_bᵀ λ = q + Σ C_cᵀ p_c(v),    C_b v = ν,    p_c(v) = Π(p⁰_c - (u_c + offset_c n)/R_c)
///
/// by Newton's method with the generalised derivative of Π and a line search, and then replaces p⁰ by p(v).
/// It minimises ½ |v - v*|²_M + Σ ½ R_c |p_c(v)|² over the velocities with C_b v = ν.
///
/// For Coulomb's law the offset is μ |u_t| + β of the same v. Newton's matrix contains its derivative, and
/// the line search reduces the residual of the momenta. Slip terms that lag by an outer iteration would need
/// R ≥ 10⁻² g and several hundred factorisations for some chains.
///
/// An outer iteration whose Newton iterations do not converge can be repeated with larger proximal terms,
/// which are then reduced slowly. A pile with friction may need this: with small proximal terms its Newton
/// iterations cycle, with large ones the impulses between bodies at rest change little in an outer iteration.

#pragma once

#include "lie/cones/body_matrix.hpp"
#include "lie/cones/cone_problem.hpp"

#include <vector>

namespace hilda::lie {

class ConeNewton {
public:
    using Iterate = ConeProblem::Iterate;

    struct Options {
        double rho = 1e-4;
        int most_outer = 20, most_inner = 60;
        int most_factorizations = 60;
        double last_tolerance = 0;  ///< of many factorisations: after 50 it grows by ten in each 50 of them
        bool coulomb = false;       ///< Coulomb's law; otherwise the convex problem with the offsets of x
        double reduction = 1;       ///< of ρ after each outer iteration
        double least = 1e-2;        ///< ρ, relative to the first one
        double growth = 1;          ///< of ρ after an outer iteration that is repeated
    };
    /// Iterates from x until the residual is below the tolerance [m/s]: that of the law, or that of the
    /// convex problem. x becomes the iterate with the smallest residual, and x.residual that residual.
    /// Returns the number of factorisations.
    int solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, double tolerance,
              const Options& options);

private:
    void set_impulses(const ConeProblem& problem, const Eigen::VectorXd& y);
    void set_residual(const ConeProblem& problem, const Eigen::VectorXd& y);
    Vec3 u_hat(const ConeProblem& problem, int c, const Eigen::VectorXd& y) const;
    Mat3 weight(const ConeProblem& problem, int c, const Eigen::VectorXd& y) const;
    double line_search(const ConeProblem& problem, Eigen::VectorXd& y);
    double value(const ConeProblem& problem, const Eigen::VectorXd& y) const;
    double length_of_residual(const ConeProblem& problem) const;
    double unbalance(const ConeProblem& problem) const;

    double rho = 0;
    bool coulomb = false;
    std::vector<Vec3> centre, p;  ///< p⁰_c and p_c(v)
    std::vector<double> offset;
    std::vector<Mat3> W;
    Eigen::VectorXd e, step, trial, before;
    Iterate best;
};

}  // namespace hilda::lie
