// SPDX-License-Identifier: GPL-3.0-or-later
/// What steps share that solve by Newton's method: the loads, the norm, the failure, the book-keeping; and,
/// in SaddleStep, the saddle matrix frozen at t_n as the Newton matrix of the rA schemes.

#pragma once

#include "lie/integrator.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hilda::lie {

class NewtonStep : public Integrator {
public:
    NewtonStep(const System& model, const Settings& settings)
        : model(model), settings(settings), loads(model.bodies())
    {
        for (const Mat3& J_bar : model.mass().J_bar) J_bar_inverse.push_back(J_bar.inverse());
        weigh_rows();
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

    /// Whether the k-th correction ends the iteration: `motion` is its length in (Δr, Δθ) over all bodies, and
    /// `factor` times `multipliers` is Δλ̂.
    ///
    /// The length of both together is Euclidean, as in Fang (2022), for a mechanism; beyond four bodies it is the
    /// root mean square over groups of four, so that a chain of a thousand stops at the same accuracy of each body.
    /// A multiplier that moves by less than what rounding makes of it does not count, nor does a motion by less than
    /// four ulp of the largest coordinate: a heavy body or a far one then does not keep the others from ending, and
    /// what is light and near still has to.
    template <class Multipliers>
    bool converged(int k, double motion, const Multipliers& multipliers, double factor)
    {
        if (k == 1) {
            ulp = 0;
            for (const Motion& body : x_n.body) ulp = std::max(ulp, body.r.cwiseAbs().maxCoeff());
            ulp *= std::numeric_limits<double>::epsilon();
        }
        double sum = motion * motion;
        for (Eigen::Index row = 0; row < multipliers.size(); ++row) {
            const double change = factor * multipliers[row];
            if (!(std::abs(change) < ulp * hanging[row])) sum += change * change;
        }
        const double before = correction;
        correction = std::sqrt(sum / std::max(1.0, model.bodies() / 4.0));
        if (correction < std::max(settings.tolerance, 4 * ulp)) return true;
        return k > 2 && correction > 0.5 * before && correction < 1e3 * ulp;  // no longer shrinks
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

    /// Implicit schemes have roots that differ by whole turns. One that turns a body by half a turn or more in a step is
    /// none that was looked for.
    void refuse_whole_turns(const State& x, double h, const std::string& scheme) const
    {
        constexpr double half_turn = 3.14159265358979323846;
        for (int i = 0; i < model.bodies(); ++i)
            if (const double turn = h * x.body[i].omega_bar.norm(); !(turn < half_turn)) {
                std::ostringstream what;
                what.precision(3);
                what << scheme << ": " << model.body_name(i) << " turns by " << turn
                     << " rad in a step, half a turn or more: a smaller step is needed";
                throw NumericalFailure("newton_diverged", what.str());
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
    /// What an ulp or two of Φ can make of a multiplier: as much times the masses that hang together with its row.
    void weigh_rows()
    {
        const Rows& C = model.pattern();
        std::vector<int> group(model.bodies());  // of bodies that rows join, by its first body
        std::iota(group.begin(), group.end(), 0);
        const auto first = [&](int b) {
            while (group[b] != b) b = group[b] = group[group[b]];
            return b;
        };
        for (int k = 0; k < C.rows(); ++k)
            for (int n = C.start[k] + 1; n < C.start[k + 1]; ++n)
                group[first(C.entry[n].body)] = first(C.entry[n - 1].body);
        std::vector<double> mass(model.bodies());
        for (int b = 0; b < model.bodies(); ++b) mass[first(b)] += model.mass().m[b];
        hanging.setZero(C.rows());
        for (int k = 0; k < C.rows(); ++k)
            if (C.start[k] < C.start[k + 1]) hanging[k] = 4 * mass[first(C.entry[C.start[k]].body)];
        for (const Rows::AlgebraicGroup& some :
             C.algebraic) {  // rows without a body have the forces of the others
            auto of_rows = hanging.segment(some.first, some.rows);
            of_rows.setConstant(of_rows.maxCoeff());
        }
    }

    long steps = 0, iterations = 0;
    Eigen::VectorXd hanging;  ///< see weigh_rows
    double ulp = 0;           ///< of the largest coordinate
};

class SaddleStep : public NewtonStep {
public:
    SaddleStep(const System& model, const Settings& settings)
        : NewtonStep(model, settings), K(model, Metric::mass, settings.linear_solver), b(K.size()),
          of_velocities(model.pattern().velocity_rows)
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
    /// The rows of the bodies, of massless unknowns and of velocities are linear in z: from the second correction on
    /// they hold, and only Φ is left.
    void correct(int k, const State& x, double factor)
    {
        if (k == 1) set_linear_residual();
        set_constraint_residual(k, x, factor);
        if (k == 1)
            K.solve(e);
        else
            K.solve_constraints(e);
        z += e;
    }

    /// e = b - K z
    void set_linear_residual() { set_linear_residual(K.rows()); }
    void set_linear_residual(const Rows& C)
    {
        K.multiply(C, z, e);
        e = b - e;
        of_velocities = velocity_part(e);
    }

    /// -factor Φ into e, and for the rows of velocities what set_linear_residual() found, or 0 from k = 2 on
    void set_constraint_residual(int k, const State& x, double factor)
    {
        model.phi(x, K.constraint_part(e));
        K.constraint_part(e) *= -factor;
        if (k == 1) velocity_part(e) = of_velocities;
    }

    /// (Δr, Δθ) of a correction
    auto motion_part(const Eigen::VectorXd& z) const { return z.head(6 * model.bodies()); }
    /// Its length, with the massless unknowns
    double length_of_motion(Eigen::VectorXd& e) const
    {
        return std::sqrt(motion_part(e).squaredNorm() + K.algebraic_part(e).squaredNorm());
    }
    /// The rows that hold velocities, last of the constraints
    Eigen::VectorBlock<Eigen::VectorXd> velocity_part(Eigen::VectorXd& z) const
    {
        return z.segment(6 * model.bodies() + model.rows() - of_velocities.size(), of_velocities.size());
    }

    /// The massless unknowns of x moved by these, which stand group by group
    template <class Step>
    void move_algebraic(State& x, const Step& by) const
    {
        Eigen::Index at = 0;
        for (const Rows::AlgebraicGroup& group : K.rows().algebraic) {
            x.alpha.segment(group.first_alpha, group.count) += by.segment(at, group.count);
            at += group.count;
        }
    }
    /// Those of x_n, moved by a factor times those of z
    void place_algebraic(State& x, double factor)
    {
        x.alpha = x_n.alpha;
        if (K.rows().algebraic.empty()) return;
        move_algebraic(x, factor * K.algebraic_part(z));
    }

    Saddle K;
    Eigen::VectorXd b;

private:
    Eigen::VectorXd of_velocities;
};

}  // namespace hilda::lie
