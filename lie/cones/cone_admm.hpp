// SPDX-License-Identifier: GPL-3.0-or-later
/// Alternating direction method of multipliers (ADMM) for the cone problem with Coulomb's law.
///
/// With the penalties R_c = ρ g_c and the velocities w_c ∈ K* that the contact points should have, one
/// iteration is
///
///     (M + Σ C_cᵀ C_c/R_c) v + C_bᵀ λ = q + Σ C_cᵀ (p_c + (w_c - s_c n)/R_c),   C_b v = ν
///     s_c = μ |u_t| + β,   u_c = C_c v
///     p_c ← Π(p_c - (u_c + s_c n)/R_c),   w_c ← u_c + s_c n + R_c (change of p_c)
///
/// and converges for constant s. Here s is updated in each iteration. The matrix is factored for each ρ only.
/// ρ is adapted to the ratio of the two residuals, the distance of u_c + s_c n from w_c and the change of
/// w_c.
///
/// The variables of this fixed point are R_c p_c - w_c, from whose projections p_c and w_c follow, and s_c.
/// It is accelerated by Anderson's method (Fu, Zhang, Boyd 2020, SIAM J. Sci. Comput. 42, A3560-A3583). An
/// accelerated iterate whose change is larger than that of the iterate before is replaced by the
/// unaccelerated one.

#pragma once

#include "lie/cones/body_matrix.hpp"
#include "lie/cones/cone_problem.hpp"
#include "lie/steps/anderson.hpp"

#include <vector>

namespace hilda::lie {

class ConeAdmm {
public:
    using Iterate = ConeProblem::Iterate;

    /// Residuals [m/s]
    struct Tolerances {
        double first, last;  ///< of the result; it grows from the first to the last value
        double least;        ///< rounding error
    };
    /// Iterates from the velocities and impulses of x, at most `most` times. The iteration ends if the
    /// residual is below `least`, or if it is below the tolerance and does not decrease further. A residual
    /// just below the tolerance would exceed it in the next step: the momentum that is not balanced is added
    /// to the velocities in each step with the same impulses. The tolerance grows by a factor of ten in 50
    /// iterations. Sets x to the iterate with the smallest residual. Returns the number of iterations. The
    /// matrix has the contact points of the problem.
    int solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, const Tolerances& to, int most,
              bool accelerates = true);

private:
    void factor(const ConeProblem& problem, BodyMatrix& matrix);
    void set_right_side(const ConeProblem& problem);
    void project(const ConeProblem& problem);
    bool adapt_penalty();
    void set_variables(const ConeProblem& problem, Eigen::Ref<Eigen::VectorXd> out) const;
    void take_variables(const ConeProblem& problem, const Eigen::Ref<const Eigen::VectorXd>& from);

    double rho = 0;
    std::vector<Mat3> W;     ///< 1/R_c; the normal component only for μ = 0
    std::vector<Vec3> p, w;  ///< p_c in the cone, w_c in the dual cone
    Iterate now;             ///< with the impulses that balance the momenta of the bodies
    Eigen::VectorXd b;
    Eigen::MatrixXd memory;  ///< of the variables of the fixed point, their changes, and the next ones
    Anderson acceleration{0, 0};
    double primal = 0, dual = 0;  ///< residuals [m/s]
};

}  // namespace hilda::lie
