// SPDX-License-Identifier: GPL-3.0-or-later
/// A fully implicit step of the rp equations: Newton's method with the full matrix, evaluated and factored once
/// an iteration.                                                                    Fang (2022), Fig. 2.1

#pragma once

#include "lie/newton_step.hpp"
#include "reference/formulations/rp_equations.hpp"

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
        const bool at_start = x.history.size() == 0;
        recall(x, at_start);
        set_formula(x, h, at_start);
        predict(x);
        next = x;
        next.t = x.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            equations.place(formula, z, next);
            equations.residual(formula, z, next, e);
            equations.assemble(formula, z, next);
            equations.N.factor();
            equations.N.solve(e);
            z -= e;
            correction = h * h * correction_norm(squared_length(e));
            if (correction < settings.tolerance) {
                equations.place(formula, z, next);
                remember(h);
                std::swap(x, next);
                return done(k);
            }
        }
        no_convergence(name, correction, next);
    }

    lie::Statistics statistics() const override
    {
        lie::Statistics s = NewtonStep::statistics();
        s.factorizations = equations.N.factorizations();
        s.refactorizations = equations.N.refactorizations();
        return s;
    }

protected:
    /// q*, q̇*, g_q, g_v out of q_n, q̇_n and what the scheme has added to the history of x
    virtual void set_formula(const lie::State& x, double h, bool at_start) = 0;
    /// What is carried besides p_n, ṗ_n, after them: its length, and its values after an accepted step from
    /// q_n, q̇_n
    virtual int more() const { return 0; }
    virtual void remember_more(double /*h*/, Eigen::Ref<Eigen::VectorXd> /*out*/) const {}

    const std::string name;
    RpEquations equations;
    RpFormula formula;
    Eigen::VectorXd q_n, qdot_n;  ///< (r, p) and (ṙ, ṗ) of the node the step leaves

private:
    void recall(const lie::State& x, bool at_start)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const lie::Motion& body = x.body[i];
            lie::Vec4 p, pdot;
            if (at_start) {
                const EulerParameters coordinates(body.A);
                p = coordinates.q, pdot = coordinates.qdot(body.omega_bar);
            } else
                p = x.history.segment<4>(8 * i), pdot = x.history.segment<4>(8 * i + 4);
            q_n.segment<7>(7 * i) << body.r, p;
            qdot_n.segment<7>(7 * i) << body.rdot, pdot;
        }
    }

    /// Guess with the accelerations and multipliers of t_n, those of p turned from the node's
    void predict(const lie::State& x)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            EulerParameters coordinates;
            coordinates.q = q_n.segment<4>(7 * i + 3);
            z.segment<7>(7 * i) << x.body[i].rddot,
                coordinates.qddot(qdot_n.segment<4>(7 * i + 3), x.body[i].omegadot_bar);
            z[equations.at_norm() + i] = 0;
        }
        z.segment(equations.at_lambda(), model.rows()) = x.lambda;
    }

    /// Of a correction: p̈ counts twice, as the angular acceleration that it is
    double squared_length(const Eigen::VectorXd& dz) const
    {
        double sum = dz.squaredNorm();
        for (int i = 0; i < model.bodies(); ++i) sum += 3 * dz.segment<4>(7 * i + 3).squaredNorm();
        return sum;
    }

    void remember(double h)
    {
        const int bodies = model.bodies();
        next.history.resize(8 * bodies + more());
        for (int i = 0; i < bodies; ++i)
            next.history.segment<8>(8 * i) << equations.p(i).normalized(), equations.pdot(i);
        remember_more(h, next.history.tail(more()));
    }

    lie::State next;
};

}  // namespace hilda::reference
