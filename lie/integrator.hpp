// SPDX-License-Identifier: GPL-3.0-or-later
/// What a time-stepping scheme is, and the list of them.

#pragma once

#include "lie/solver/saddle.hpp"

namespace hilda::lie {

/// What a scheme is told; each takes from it what concerns it.
struct Settings {
    /// Stop when the correction is shorter than this. Half-implicit schemes measure (Δr, Δθ̄, Δλ̂) in m, rad
    /// and kg m, fully implicit ones h² (Δr̈, Δω̄̇, Δλ): the same lengths. See NewtonStep::converged for the norm.
    double tolerance = 1e-10;
    int max_iterations = 30;
    LinearSolver linear_solver = LinearSolver::automatic;
    double rho_infinity = 0.8;   ///< generalised-α: spectral radius for infinite frequency, 0 … 1
    bool reparametrise = false;  ///< Euler angles: turn to another body frame near the singular set
    double rtol = 1e-10;         ///< adaptive schemes: relative error of a step
    double atol = 0;             ///< the same, absolute [m, m/s; 1, 1/s]; 0: as rtol
    /// Asked between the inner steps of adaptive schemes: whether to give up, with Interrupted
    bool (*stop)() = nullptr;
};

/// What a run has cost so far.
struct Statistics {
    long steps = 0;
    long iterations = 0;
    long factorizations = 0;    ///< with a new choice of pivots
    long refactorizations = 0;  ///< with the pivots of the last one
    double correction = 0;      ///< norm of the last one, in the units of Newton::tolerance

    double iterations_per_step() const
    {
        return steps > 0 ? static_cast<double>(iterations) / static_cast<double>(steps) : 0;
    }
};

class Integrator {
public:
    Integrator() = default;
    Integrator(const Integrator&) = delete;
    Integrator& operator=(const Integrator&) = delete;
    virtual ~Integrator() = default;

    /// Takes x from t_n to t_n + h and returns the number of Newton iterations. On a NumericalFailure x is as
    /// it was. What a multi-step scheme keeps in x.history belongs to it and to this h: with another scheme or step,
    /// begin with an empty one.
    virtual int step(State& x, double h) = 0;

    /// Half-implicit schemes find λ_n, r̈_n, ω̄̇_n in the step that leaves t_n, so a node is known in full one
    /// step late. Where this is true, step() leaves them in its result, and complete() hands them to the node
    /// they belong to.
    virtual bool is_staggered() const { return false; }
    virtual void fill_node(State& /*node*/, const State& /*after*/) const {}
    /// Whether it keeps something in x.history. An empty one then means a start, at which λ, r̈, ω̄̇ of x are those of x.
    virtual bool keeps_history() const { return false; }

    /// Pivots are all that a scheme may remember outside the state, and they decide on last digits. The state
    /// at which those in use were chosen, and how a new integrator gets them there; none for a scheme that
    /// finds them again by a step from the node where it chose them.
    virtual const State* pivots() const { return nullptr; }
    virtual void choose_pivots(const State& /*x*/) {}

    virtual const System& system() const = 0;
    virtual Statistics statistics() const = 0;
};

/// A scheme as it stands in the list: what a user picks by name.
struct Scheme {
    std::string name;
    int order = 1;            ///< of r, A, ṙ, ω̄ where the motion is smooth
    int order_lambda = 1;     ///< of the multipliers, from a moving start
    std::string formulation;  ///< rA, rp, reps
    std::string unknowns;     ///< of the Newton iteration
    std::string source;
    /// Chooses its own steps inside the step it is asked for, by rtol and atol. It remembers past steps
    /// outside the state, so its runs do not resume.
    bool adaptive = false;
    bool algebraic = false;     ///< takes systems with massless unknowns: contacts that evolve
    bool nonholonomic = false;  ///< takes rows that hold velocities alone: rolling
    bool regularised = false;   ///< takes rows that give way: friction in the equations of the step
    std::unique_ptr<Integrator> (*construct)(const System&, const Settings&) = nullptr;

    /// InvalidInput for a system with unknowns or rows that the scheme does not take
    std::unique_ptr<Integrator> make(const System& system, const Settings& settings) const;
};

/// All schemes, by name.
const std::vector<Scheme>& schemes();

/// The scheme of that name; InvalidInput names those there are.
const Scheme& scheme(const std::string& name);

/// Puts a scheme into the list: the last line of its file.
bool register_scheme(Scheme scheme);

template <class Method>
bool register_scheme(Scheme scheme)
{
    scheme.construct = [](const System& system, const Settings& settings) -> std::unique_ptr<Integrator> {
        return std::make_unique<Method>(system, settings);
    };
    return register_scheme(std::move(scheme));
}

}  // namespace hilda::lie
