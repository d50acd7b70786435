// SPDX-License-Identifier: GPL-3.0-or-later
/// A fully implicit step of the rp equations: Newton's method with the full matrix, evaluated and factored once
/// an iteration.                                                                    Fang (2022), Fig. 2.1

#pragma once

#include "lie/steps/newton_step.hpp"
#include "reference/formulations/rp_step_equations.hpp"

namespace hilda::reference {

/// A scheme says which formula takes the step. The state carries p and ṗ of each body beside A and ω̄ (they keep
/// p from changing its sign, and the part of ṗ along p), and what the scheme adds.
class RpImplicit : public lie::NewtonStep {
public:
    RpImplicit(const lie::System& model, const lie::Settings& settings, std::string name)
        : NewtonStep(model, settings), name(std::move(name)), equations(model), q_n(7 * model.bodies()),
          qdot_n(7 * model.bodies())
    {
        formula.q = formula.qdot = q_n;
        z.resize(equations.size()), e.resize(equations.size());
    }

    int step(lie::State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        const bool at_start = x_n.history.size() != 8 * model.bodies() + more();
        recall(at_start);
        set_formula(h, at_start);
        predict();
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            equations.place(formula, z, x);
            equations.residual(formula, z, x, e);
            equations.assemble(formula, z, x);
            equations.N.factor();
            equations.N.solve(e);
            z -= e;
            if (converged(k, h * h * length_of_motion(e), e.segment(equations.at_lambda(), model.rows()),
                          h * h)) {
                equations.place(formula, z, x);
                save_step(x, h);
                return done(attempt, k);
            }
        }
        no_convergence(name, correction, x);
    }

    lie::Statistics statistics() const override { return statistics_with(equations.N); }

protected:
    /// q*, q̇*, g_q, g_v out of q_n, q̇_n and what the scheme has added to the history of x_n
    virtual void set_formula(double h, bool at_start) = 0;
    /// What is carried besides p_n, ṗ_n, after them: its length, and its values after an accepted step from
    /// q_n, q̇_n
    virtual int more() const { return 0; }
    virtual void save_more(double /*h*/, Eigen::Ref<Eigen::VectorXd> /*out*/) const {}

    const std::string name;
    RpStepEquations equations;
    RpFormula formula;
    Eigen::VectorXd q_n, qdot_n;  ///< (r, p) and (ṙ, ṗ) of the node the step leaves

private:
    void recall(bool at_start)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const lie::Motion& body = x_n.body[i];
            lie::Vec4 p, pdot;
            if (at_start) {
                const EulerParameters coordinates(body.A);
                p = coordinates.q, pdot = coordinates.qdot(body.omega_bar);
            } else
                p = x_n.history.segment<4>(8 * i), pdot = x_n.history.segment<4>(8 * i + 4);
            q_n.segment<7>(7 * i) << body.r, p;
            qdot_n.segment<7>(7 * i) << body.rdot, pdot;
        }
    }

    /// Guess with the accelerations and multipliers of t_n, those of p turned from the node's
    void predict()
    {
        for (int i = 0; i < model.bodies(); ++i) {
            EulerParameters coordinates;
            coordinates.q = q_n.segment<4>(7 * i + 3);
            z.segment<7>(7 * i) << x_n.body[i].rddot,
                coordinates.qddot(qdot_n.segment<4>(7 * i + 3), x_n.body[i].omegadot_bar);
            z[equations.at_norm() + i] = 0;
        }
        z.segment(equations.at_lambda(), model.rows()) = x_n.lambda;
    }

    /// Of a correction: p̈ counts twice, as the angular acceleration that it is
    double length_of_motion(const Eigen::VectorXd& dz) const
    {
        double sum = dz.head(7 * model.bodies()).squaredNorm();
        for (int i = 0; i < model.bodies(); ++i) sum += 3 * dz.segment<4>(7 * i + 3).squaredNorm();
        return std::sqrt(sum);
    }

    void save_step(lie::State& x, double h)
    {
        const int bodies = model.bodies();
        x.history.resize(8 * bodies + more());
        for (int i = 0; i < bodies; ++i)
            x.history.segment<8>(8 * i) << equations.p(i).normalized(), equations.pdot(i);
        save_more(h, x.history.tail(more()));
    }
};

}  // namespace hilda::reference
