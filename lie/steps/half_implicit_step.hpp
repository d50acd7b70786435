// SPDX-License-Identifier: GPL-3.0-or-later
/// What the half-implicit schemes share: loads and multipliers at t_n, constraints at t_{n+1}, and K of t_n as the
/// Newton matrix.                                                                 Fang (2022), Secs. 3.5, 3.6

#pragma once

#include "lie/bounded_rows.hpp"
#include "lie/steps/newton_step.hpp"

namespace hilda::lie {

/// With the velocity v = (ṙ, ω̄) that the step starts from and w the weight that r̈_n has in the new one,
///
///     M v_{n+1} + w h Cᵀ λ_n = M (v - (w - 1) h r̈_{n-1}) + w h (F_n, τ̄_n),     z = (h v_{n+1}, w h² λ_n)
///
/// w = 1 is the scheme of first order (3.25), w = 3/2 that of second order (3.35). A scheme adds how positions
/// follow from z; there, δ(r, A, α) = δz / q to first order, with its q.
class HalfImplicitStep : public SaddleStep {
public:
    int step(State& x, double h) final
    {
        x_n = x;
        Attempt attempt(x, x_n);
        begin(h);
        within_bounds.all_stick(K);
        K.assemble(x_n, h);  // the Newton matrix, frozen at t_n (Eqs. 3.32, 3.51)
        set_known_part(h);
        predict(h);
        x.t = x_n.t + h;
        refreshed = false;
        int corrections = 0;
        for (int solved = 0; solved <= most_solved; ++solved) {
            corrections += solve(x, h);
            if (within_bounds(K, rows_of_node(), z, x)) {
                accept(x, h);
                return done(attempt, corrections);
            }
            if (refreshed) scale_compliance_as_K(C_n, h);
        }
        no_convergence(name, correction, x);
    }

    bool is_staggered() const override { return true; }
    void fill_node(State& node, const State& after) const override { take_loads(node, after); }

protected:
    using Vec6 = Eigen::Matrix<double, 6, 1>;

    HalfImplicitStep(const System& model, const Settings& settings, std::string name, double w, double q)
        : SaddleStep(model, settings), name(std::move(name)), w(w), q(q), C_n(model.pattern()),
          within_bounds(model.pattern())
    {}

    /// Readies what the scheme carries from step to step, out of x_n.history or at a start
    virtual void begin(double /*h*/) {}
    /// (ṙ, ω̄) of body i that the step starts from
    virtual Vec6 velocity(int i) const
    {
        Vec6 v;
        v << x_n.body[i].rdot, x_n.body[i].omega_bar;
        return v;
    }
    /// The node t_n as the loads see it
    virtual const State& node() const { return x_n; }
    /// r and A of x from x_n and z
    virtual void place(State& x) const = 0;
    /// Velocities of x and its history, out of z
    virtual void leave(State& x, double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].rdot = z.segment<3>(6 * i) / h;
            x.body[i].omega_bar = z.segment<3>(6 * i + 3) / h;
        }
    }
    /// h J̄ ω̄ + w h² τ̄_n of body i, with what of r̈_{n-1} the scheme takes
    virtual Vec3 known_moment(int i, double h) const
    {
        return h * (model.mass().J_bar[i] *
                    (velocity(i).tail<3>() - (w - 1) * h * x_n.body[i].omegadot_bar)) +
               w * h * h * tau_bar(i, node().body[i]);
    }
    /// The k-th correction of z, as in SaddleStep; k = 1 where more than Φ is left
    virtual void correct(int k, const State& x)
    {
        if (k == 1) set_linear_residual(rows_of_node());
        set_constraint_residual(k, x, q);
        if (k == 1)
            K.solve(e);
        else
            K.solve_constraints(e);
        z += e;
    }
    /// Those of t_n, along which the multipliers act, whatever K has been refreshed with
    const Rows& rows_of_node() const { return refreshed ? C_n : K.rows(); }

    const std::string name;
    const double w, q;

private:
    /// Newton's iteration from the z that is there; returns how many corrections it took
    int solve(State& x, double h)
    {
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x);
            place_algebraic(x, 1 / q);
            if (k > patience) refresh(x, h);
            correct(refreshed ? 1 : k, x);
            if (converged(k, length(), K.constraint_part(e), 1 / w)) return k;
        }
        no_convergence(name, correction, x);
    }

    void set_known_part(double h)
    {
        model.loads(node(), loads);
        for (int i = 0; i < model.bodies(); ++i) {
            b.segment<3>(6 * i) =
                h * model.mass().m[i] * (velocity(i).head<3>() - (w - 1) * h * x_n.body[i].rddot) +
                w * h * h * loads.F[i];
            b.segment<3>(6 * i + 3) = known_moment(i, h);
        }
        K.constraint_part(b).setZero();
        K.algebraic_part(b).setZero();
        if (K.rows().velocity_rows > 0) hold_mean_velocity(h);
        for (const Rows::Regularised& c : K.rows().regularised)
            K.constraint_part(b).segment<2>(c.first) = -h * c.K * c.mobility(h) * c.S;
    }

    /// C_n (v + v_{n+1}) = 2 ν for the rows that hold velocities: second order where v and v_{n+1} are half a step
    /// before and after t_n
    void hold_mean_velocity(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) z.segment<6>(6 * i) = h * velocity(i);
        model.nu(x_n, K.constraint_part(e));
        const Rows& C = K.rows();
        for (int k = C.position_rows(); k < C.rows(); ++k)
            K.constraint_part(b)[k] = 2 * h * K.constraint_part(e)[k] - C.dot(k, z);
    }

    /// Guess with the accelerations and multipliers of the step before                               Eq. 3.34
    void predict(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            z.segment<6>(6 * i) = h * velocity(i);
            z.segment<3>(6 * i) += h * h * body.rddot;
            z.segment<3>(6 * i + 3) += h * h * body.omegadot_bar;
        }
        K.constraint_part(z) = w * h * h * x_n.lambda;
        K.algebraic_part(z).setZero();
    }

    /// Length of the correction in r, θ̄ and α: the unknowns of Eqs. 3.27 and 3.43
    double length()
    {
        double sum = K.algebraic_part(e).squaredNorm() / (q * q);
        for (int i = 0; i < model.bodies(); ++i)
            sum += e.segment<3>(6 * i).squaredNorm() / (q * q) + e.segment<3>(6 * i + 3).squaredNorm();
        return std::sqrt(sum);
    }

    /// The rows change too fast for K of t_n: from here on it is that of each iterate.
    void refresh(const State& x, double h)
    {
        if (!refreshed) C_n = K.rows();
        refreshed = true;
        K.assemble(x, h);
    }

    /// The rows of t_n, as much softer than they are as those of K
    void scale_compliance_as_K(Rows& C, double h) const
    {
        for (size_t n = 0; n < C.regularised.size(); ++n) C.regularised[n].p = K.rows().regularised[n].p;
        C.regularise(h);
    }

    void accept(State& x, double h)
    {
        place(x);
        place_algebraic(x, 1 / q);
        x.lambda = K.constraint_part(z) / (w * h * h);
        b.setZero();
        rows_of_node().add_transpose(1, x.lambda, b);
        for (int i = 0; i < model.bodies(); ++i) {
            Motion& body = x.body[i];
            body.A = orthonormalised(body.A);
            body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / model.mass().m[i];  // Eqs. 3.24, 3.39
            body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, node().body[i]) - b.segment<3>(6 * i + 3));
        }
        leave(x, h);
    }

    static constexpr int patience = 10;     ///< corrections with K of t_n
    static constexpr int most_solved = 50;  ///< until all that gives way is within its bound
    bool refreshed = false;
    Rows C_n;
    BoundedRows within_bounds;
};

}  // namespace hilda::lie
