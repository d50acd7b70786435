// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the schemes that solve their step by Newton's method.

#pragma once

#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace hilda::lie {

/// Loads, convergence test, error messages and counters.
class NewtonStep : public Integrator {
public:
    NewtonStep(const System& model, const Settings& settings);

    const System& system() const override { return model; }

protected:
    /// Restores x from x_n at the end of its scope unless the step has been accepted, also after an
    /// exception.
    class Attempt {
    public:
        Attempt(State& x, const State& x_n) : x(x), x_n(x_n) {}
        ~Attempt();
        Attempt(const Attempt&) = delete;
        Attempt& operator=(const Attempt&) = delete;

        bool accepted = false;

    private:
        State& x;
        const State& x_n;
    };

    /// τ̄ = n̄ - ω̄ × J̄ ω̄ of body i, with n̄ from `loads`                                               Eq.
    /// 2.13c
    Vec3 tau_bar(int i, const Motion& body) const;

    /// Whether loads depend on a history through the internal states of x: friction, plasticity
    bool has_history(const State& x) const;
    /// For schemes without Feature::history: throws InvalidInput "integrator SCHEME: WHY" for loads with one.
    void refuse_history(const State& x, std::string_view scheme, std::string_view why) const;

    // For schemes with the unknowns z = (motion of the bodies, multipliers, algebraic variables), scaled:

    /// Initial guess: by_v v + by_vdot v̇ for each body, with v = (ṙ, ω̄) of t_n; by_lambda λ_n; 0
    void predict(double by_v, double by_vdot, double by_lambda);
    /// Sets the multipliers of the initial guess to zero if the system keeps redundant rows. For schemes
    /// whose multipliers act in the directions of the rows of the iterate: their part in the null space of
    /// the frozen matrix exerts a force there. It would grow from step to step.
    void start_redundant();
    /// Poses of x from the increments in z: r = r_n + z_r, A = A_n exp(z_θ)
    void place_increments(State& x) const;
    /// x.alpha = α_n + factor · (algebraic part of z)
    void place_algebraic(State& x, double factor) const;
    /// algebraic part of z = factor · (x.alpha - α_n)
    void take_algebraic(const State& x, double factor);
    /// The residual of the equations of motion in the state x: M r̈ + Φ_rᵀ λ - F, J̄ ω̄̇ + Π̄ᵀ λ - τ̄ and
    /// Φ_αᵀ λ in the components of e for the bodies and the algebraic variables. Sets `loads`, and the rows
    /// C, in x.
    void set_motion_residual(const State& x, Rows& C);
    Eigen::VectorBlock<Eigen::VectorXd> constraint_part(Eigen::VectorXd& z) const
    {
        return z.segment(6 * bodies, model.rows());
    }
    Eigen::VectorBlock<Eigen::VectorXd> algebraic_part(Eigen::VectorXd& z) const
    {
        return z.tail(z.size() - 6 * bodies - model.rows());
    }
    /// Euclidean norm of the components of the bodies and of the algebraic variables
    double length_of_motion(Eigen::VectorXd& e) const;

    /// Whether the iteration ends with correction k = 1, 2, … .
    ///
    /// `motion` is the Euclidean norm of (Δr, Δθ̄) of all bodies and Δα. Δλ̂ is `factor` times `multipliers`.
    /// The test uses
    ///
    ///     correction² = (motion² + |Δλ̂|²) / max(1, bodies/4)
    ///
    /// For up to four bodies this is the Euclidean norm of Fang (2022). For more bodies it is the root mean
    /// square over groups of four, so that the accuracy of a body does not depend on the length of a chain.
    ///
    /// The iteration ends
    /// - if the correction and the error that remains are below the tolerance, or below four ulp of the
    ///   largest coordinate. The error is about θ/(1 - θ) times the correction, with the ratio θ of the last
    ///   two. It is ignored if the corrections no longer decrease (θ > 0.95), and for correction
    ///   `most_iterations`;
    /// - for k > 2, if the correction is below 1000 ulp and has decreased by less than a factor of two;
    /// - if the system keeps redundant rows, with correction `most_iterations`, unless it exceeds the first
    ///   one by far. Near a singular configuration the corrections in the direction of a small singular value
    ///   of the rows do not become small, and the residual there is left to the following steps.
    /// Changes of a multiplier below its rounding error (rounding_mass times ulp) are ignored. Without these
    /// limits a heavy body, or one far from the origin, would prevent convergence.
    bool converged(int k, double motion, const Eigen::Ref<const Eigen::VectorXd>& multipliers, double factor);

    /// Copies λ, r̈, ω̄̇ from the result of a step to the node at its beginning: fill_node() of half-implicit
    /// schemes.
    static void take_loads(State& node, const State& after);

    /// Throws NumericalFailure if a body rotates by π or more in the step.
    ///
    /// The equations of an implicit scheme have several solutions, which differ by full revolutions of a
    /// body. A rotation of at least π indicates the wrong one.
    void refuse_whole_turns(const State& x, double h, const std::string& scheme) const;

    /// Marks the step as accepted, updates the counters and returns the number of iterations k.
    int done(Attempt& attempt, int k);

    /// Throws NoConvergence with the constraint row that has the largest |Φ| at the last iterate x.
    [[noreturn]] void no_convergence(const std::string& scheme, double correction, const State& x) const;

    /// The counters, with the factorisations of the scheme's matrix
    template <class Matrix>
    Statistics statistics_with(const Matrix& N) const
    {
        return {steps,
                iterations,
                N.factorizations(),
                N.refactorizations(),
                correction,
                N.reciprocal_condition()};
    }

    /// The shift ε of the saddle matrix for redundant rows (Saddle::set_shift) in a step h from x_n, from the
    /// angular velocities and accelerations there
    double shift(double h) const;

    const System& model;
    const Mass& mass;  ///< of the model; the functions of System are virtual
    const int bodies;
    const Settings settings;
    /// Largest number of Newton iterations: that of the settings; at most 6 with redundant rows
    const int most_iterations;
    Loads loads;
    State x_n;              ///< the state at the beginning of the step
    Eigen::VectorXd z, e;   ///< the unknowns and their correction
    double correction = 0;  ///< norm of the last correction
    std::vector<Mat3> J_bar_inverse;

private:
    void set_rounding_mass();

    long steps = 0, iterations = 0;
    /// Sensitivity of the multiplier of each row to rounding errors of Φ [kg]: four times the total mass of
    /// the bodies that constraints connect with the row, directly or through other bodies
    Eigen::VectorXd rounding_mass;
    double ulp = 0;  ///< of the largest coordinate in x_n [m]
    double first_correction = 0;
};

}  // namespace hilda::lie
