// SPDX-License-Identifier: GPL-3.0-or-later
/// A fully implicit step of the rp equations. Newton's method evaluates and factors the exact matrix in each
/// iteration.
///                                                                                  Fang (2022), Fig. 2.1

#pragma once

#include "lie/steps/newton_step.hpp"
#include "reference/formulations/rp_step_equations.hpp"

#include <string>

namespace hilda::reference {

/// Base class of the schemes; a derived class defines the time-stepping formula.
///
/// State::history holds p and ṗ of each body, and then the data of the derived class. p and ṗ are stored
/// because A and ω̄ do not determine the sign of p and the component of ṗ along p.
class RpImplicit : public lie::NewtonStep {
public:
    RpImplicit(const lie::System& model, const lie::Settings& settings, std::string name);

    int step(lie::State& x, double h) override;

    lie::Statistics statistics() const override;

protected:
    /// Sets q*, q̇*, g_q and g_v from q_n, q̇_n, q̈_n and the scheme's data in x_n.history.
    virtual void set_formula(double h, bool at_start) = 0;
    /// Sets the formula of an acceleration that is linear in time, for the first step of schemes of order 2:
    /// q̇_1 = q̇_0 + (h/2)(q̈_0 + q̈_1), q_1 = q_0 + h q̇_0 + h² (q̈_0/3 + q̈_1/6).
    void set_linear_acceleration(double h);
    /// Whether the scheme's data begin with another step than h: the scheme then starts again.
    bool step_differs(double h) const { return x_n.history[x_n.history.size() - more()] != h; }
    /// Size of the scheme's data in the history
    virtual int more() const { return 0; }
    /// Writes the scheme's data after an accepted step from q_n, q̇_n.
    virtual void save_more(double /*h*/, Eigen::Ref<Eigen::VectorXd> /*out*/) const {}

    const std::string name;
    RpStepEquations equations;
    RpFormula formula;
    Eigen::VectorXd q_n, qdot_n, qddot_n;  ///< q = (r, p) and its derivatives at the beginning of the step

private:
    void restore(bool at_start);
    void predict();
    double length_of_motion(const Eigen::VectorXd& dz) const;
    void save_step(lie::State& x, double h);
};

}  // namespace hilda::reference
