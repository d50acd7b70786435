// SPDX-License-Identifier: GPL-3.0-or-later
/// What steps share that solve by Newton's method: the loads, the norm, the failure, the book-keeping; and,
/// in SaddleStep, the saddle matrix frozen at t_n as the Newton matrix of the rA schemes.

#pragma once

#include "lie/integrator.hpp"

#include <algorithm>
#include <limits>

namespace hilda::lie {

class NewtonStep : public Integrator {
public:
    NewtonStep(const System& model, const Settings& settings)
        : model(model), settings(settings), loads(model.bodies())
    {
        for (const Mat3& J_bar : model.mass().J_bar) J_bar_inverse.push_back(J_bar.inverse());
    }

    const System& system() const override { return model; }

protected:
    /// While a step is tried: unless it is accepted, x is put back to what it was, whatever was thrown.
    class Attempt {
    public:
        Attempt(State& x, const State& x_n) : x(x), x_n(x_n) {}
        ~Attempt()
        {
            if (!accepted) x = x_n;
        }
        Attempt(const Attempt&) = delete;
        Attempt& operator=(const Attempt&) = delete;

        bool accepted = false;

    private:
        State& x;
        const State& x_n;
    };

    /// τ̄ = n̄ - ω̄ × J̄ ω̄ of body i Eq. 3.4b
    Vec3 tau_bar(int i, const Motion& body) const
    {
        return loads.n_bar[i] - body.omega_bar.cross(model.mass().J_bar[i] * body.omega_bar);
    }

    /// Whether the k-th correction, of this length over all unknowns, ends the iteration.
    ///
    /// The length is Euclidean, as in Fang (2022), for a mechanism; beyond four bodies it is the root mean
    /// square over groups of four, so that a chain of a thousand stops at the same accuracy of each body. It
    /// ends below the tolerance, or below what rounding leaves, or where it has stopped to shrink not far above
    /// that.
    bool converged(int k, double length)
    {
        const double before = correction;
        correction = length / std::sqrt(std::max(1.0, model.bodies() / 4.0));
        if (correction < settings.tolerance) return true;
        const double rest = rounding();
        return correction < rest || (k > 1 && correction > 0.5 * before && correction < 30 * rest);
    }

    /// What the rounding of Φ, about ε max|r| a row, leaves of a correction: positions move by as much, and a
    /// multiplier by that times the masses that hang on it. A twentieth of the product, by experience with
    /// chains: 1e-9 for 256 bars of 2 m and 39 kg, which is above the usual tolerance; 2e-14 for a double
    /// pendulum.
    double rounding() const
    {
        double size = 0, mass = 0;
        for (int i = 0; i < model.bodies(); ++i) {
            size = std::max(size, x_n.body[i].r.cwiseAbs().maxCoeff());
            mass += model.mass().m[i];
        }
        return 0.05 * std::numeric_limits<double>::epsilon() * size * std::sqrt(model.bodies()) * mass;
    }

    /// λ, r̈, ω̄̇ of a node, out of the step that leaves it: complete() of the half-implicit schemes
    static void take_loads(State& node, const State& after)
    {
        node.lambda = after.lambda;
        for (size_t i = 0; i < node.body.size(); ++i) {
            node.body[i].rddot = after.body[i].rddot;
            node.body[i].omegadot_bar = after.body[i].omegadot_bar;
        }
    }

    /// Book-keeping of an accepted step; returns its iterations.
    int done(Attempt& attempt, int k)
    {
        attempt.accepted = true;
        ++steps;
        iterations += k;
        return k;
    }

    /// `x` is the last iterate: its worst constraint row is where to look.
    [[noreturn]] void no_convergence(const std::string& scheme, double correction, const State& x) const
    {
        std::ostringstream what;
        what.precision(2);
        what << scheme << ": correction " << correction << " after " << settings.max_iterations
             << " iterations";
        NoConvergence failure(what.str(), correction, settings.max_iterations);
        if (model.rows() > 0) {
            Eigen::VectorXd Phi(model.rows());
            model.phi(x, Phi);
            int largest = 0;
            failure.residual = Phi.cwiseAbs().maxCoeff(&largest);
            failure.largest = model.row_name(largest);
        }
        throw failure;
    }

    /// So far, with the factorisations of the matrix that the scheme solves with
    template <class Matrix>
    Statistics statistics_with(const Matrix& N) const
    {
        return {steps, iterations, N.factorizations(), N.refactorizations(), correction};
    }

    const System& model;
    const Settings settings;
    Loads loads;
    State x_n;
    Eigen::VectorXd z, e;   ///< the unknowns and their correction
    double correction = 0;  ///< norm of the last one
    std::vector<Mat3> J_bar_inverse;

private:
    long steps = 0, iterations = 0;
};

class SaddleStep : public NewtonStep {
public:
    SaddleStep(const System& model, const Settings& settings)
        : NewtonStep(model, settings), K(model, Metric::mass, settings.linear_solver), b(K.size())
    {
        z.resize(K.size());
        e.resize(K.size());
    }

    Statistics statistics() const override { return statistics_with(K); }
    const State* pivots() const override { return &K.pivots(); }
    void choose_pivots(const State& x) override { K.choose_pivots(x); }

protected:
    /// The k-th correction e of z in K z = b, Φ(x(z)) = 0, into e:
    ///
    ///     K e = (b - K z, -factor Φ)                                       Fang (2022), Eqs. 3.30, 3.31
    ///
    /// The rows of the bodies are linear in z: from the second correction on they hold, and only Φ is left.
    void correct(int k, const State& x, double factor)
    {
        if (k == 1) {
            K.multiply(z, e);
            e = b - e;
        }
        model.phi(x, K.constraint_part(e));
        K.constraint_part(e) *= -factor;
        if (k == 1)
            K.solve(e);
        else
            K.solve_constraints(e);
        z += e;
    }

    Saddle K;
    Eigen::VectorXd b;
};

}  // namespace hilda::lie
