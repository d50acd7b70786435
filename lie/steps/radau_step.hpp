// SPDX-License-Identifier: GPL-3.0-or-later
/// The three-stage Radau IIA method of order 5 on the Lie group.

#pragma once

#include "lie/solver/tangent.hpp"
#include "lie/steps/local_coordinate_step.hpp"

#include <complex>
#include <string>

namespace hilda::lie {

/// Collocation at the Radau points c_i of a step, in the local coordinates A = A_n exp(θ̃), with the velocity
/// constraints at each stage (index 2):
///
///     ṙ = v,  θ̇ = J_r(θ)⁻¹ ω̄,  M v̇ + Cᵀ λ = Q(q, v, t),  C v = ν
///
/// Hairer, Wanner (1996), Solving Ordinary Differential Equations II, Secs. IV.8 and VII.4. The
/// transformation A⁻¹ = T Λ T⁻¹ splits a Newton step into a real and a complex system, with an eigenvalue μ
/// of A⁻¹ each:
///
///     | M + (h/μ) D + (h/μ) K_t P   Cᵀ |        K_t, D, V: see Tangent
///     | C + V P                     0  |        P = h/μ for r and h (μ + h/2 ω̄̃)⁻¹ for θ
///
/// The unknowns are the velocities and (h/μ) λ. The matrices are those of the state at the beginning of the
/// step; they are factored once for each attempt. Newton's method starts from the collocation polynomial of
/// the step before. The end of the step is projected onto the constraints of the positions and velocities,
/// and has the accelerations and multipliers of the saddle system (NodeStep::finish).
///
/// State::history holds the stages of the last step.
class RadauStep : public LocalCoordinateStep {
public:
    RadauStep(const System& model, const Settings& settings);

    int step(State& x, double h) override;
    Statistics statistics() const override;

    static constexpr int stages = 3;
    static const double c[stages], A_inverse[stages][stages];
    static const double T[stages][stages], T_inverse[stages][stages];
    /// The eigenvalues of A⁻¹. The second one and its conjugate belong to the last two columns of T.
    static const double mu;
    static const std::complex<double> mu_complex;

protected:
    // Interface of AdaptiveStep
    const std::string& scheme_name() const { return name; }
    /// The error estimate behaves like h⁴.
    int control_order() const { return 4; }
    /// Starts a run: there is no step before.
    void begin_run() { last_length = 0; }
    /// Starts a step from x_n.
    void begin_internal_step() { tangent_is_current = false; }
    /// One attempt from x_n to `end`, which is complete if the norm of the error estimate is at most 1.
    /// `again` is set for the first step and after a rejected step.
    int attempt(State& end, double h, double rtol, double atol, bool again, Eigen::VectorXd& tolerance,
                double& norm);
    /// The stages become those of the last step.
    void accept_stages(double h);
    /// Largest ratio of the next step to the accepted one: Newton's method must converge.
    double most_growth() const;
    void add_stages(State&, double) {}
    /// Sets x to the state at x_n.t + s h of the last step: the collocation polynomials of the velocities,
    /// and their integrals, projected.
    void interpolate(State& x, double s, double h);
    template <class Block>
    void transfer_stages(const Block& block);

    /// The increments of the stages from x_n, and their multipliers, by columns
    struct Stages {
        Eigen::MatrixXd q;       ///< (r, θ) of each body
        Eigen::MatrixXd v;       ///< (ṙ, ω̄) of each body
        Eigen::MatrixXd lambda;  ///< one component per row
    };
    Stages last;             ///< of the last accepted step
    double last_length = 0;  ///< its length [s]; 0 at a start

private:
    /// Sets `now` to the initial guess of Newton's method.
    void predict(double h);
    /// Factors the matrices of x_n for the step h.
    void factor(double h);
    void assemble(double h);
    /// Newton's method for the stages, with the tolerances of an adaptive step. Returns the number of
    /// iterations; 0 if it does not converge.
    int solve_adaptive(double h, double goal, const Eigen::VectorXd& tolerance);
    /// One Newton step; its size is in `change`.
    void iterate(double h);
    void set_residual(double h);
    void place_stage(State& x, int i) const;
    double estimate(double h, bool again, const Eigen::VectorXd& tolerance);
    double rms(const Stages& of, const Eigen::VectorXd& tolerance) const;

    static const std::string name;

    /// Right side and solution of a Newton system
    template <class Scalar>
    struct NewtonSystem {
        using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
        Vector q, v, c;          ///< the residuals
        Vector dq, dv, dlambda;  ///< the corrections
        Vector P_q, b;           ///< workspace

        NewtonSystem(int bodies, int rows);
        /// Sets the corrections.
        void solve(const Tangent& tangent, TangentMatrix<Scalar>& N, double h, Scalar mu);
    };
    Tangent tangent;
    bool tangent_is_current = false;
    double contraction = 0;  ///< of Newton's method in the last attempt; 0 after one iteration
    TangentMatrix<double> N;
    TangentMatrix<std::complex<double>> N_complex;
    NewtonSystem<double> real;
    NewtonSystem<std::complex<double>> complex;

    Stages now, change, residual;
    Eigen::VectorXd velocity, nu;
    Eigen::VectorXd error;  ///< of (r, θ, ṙ, ω̄) of each body
    Rows C;                 ///< at a stage
    State stage;            ///< workspace
};

template <class Block>
void RadauStep::transfer_stages(const Block& block)
{
    block(&last_length, 1);
    for (Eigen::MatrixXd* part : {&last.q, &last.v, &last.lambda}) block(part->data(), part->size());
}

}  // namespace hilda::lie
