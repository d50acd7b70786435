// SPDX-License-Identifier: GPL-3.0-or-later
/// Explicit Runge-Kutta methods on the Lie group, by their tableau.

#pragma once

#include "lie/steps/local_coordinate_step.hpp"
#include "lie/steps/tableau.hpp"
#include "lie/steps/tree_step.hpp"

namespace hilda::lie {

/// One step of a tableau in the variables of Coordinates: LocalCoordinateStep with projection, or TreeStep.
/// As an integrator it takes steps of the given length.
template <class Coordinates>
class ExplicitStep : public Coordinates {
public:
    ExplicitStep(const System& model, const Settings& settings, const Tableau& tableau);

    int step(State& x, double h) override;

protected:
    using Attempt = typename Coordinates::Attempt;
    using Coordinates::x_n, Coordinates::model;

    /// Sets x to the end of a step of the length h from x_n: stages, projection, accelerations, and the slope
    /// there. Returns the number of Newton steps of the projection. x has the discrete state and the internal
    /// states of x_n.
    int advance(State& x, double h);

    /// The norms of the error estimates of the last step, combined to one number: h |Σ e_i k_i|. The
    /// components are divided by `scale`.
    double error(double h, const Eigen::VectorXd& scale);

    /// Sets x to the state at x_n.t + s h of the last step by the continuous extension, projected.
    void interpolate(State& x, double s, double h);
    /// Computes the stages that only interpolate() needs. x is workspace.
    void add_stages(State& x, double h);

    // Interface of AdaptiveStep
    const std::string& scheme_name() const { return tableau.name; }
    /// The error estimate behaves like h to this power.
    int control_order() const { return tableau.order; }
    /// One attempt from x_n to `end`, and the norm of its error estimate
    int attempt(State& end, double h, double rtol, double atol, bool again, Eigen::VectorXd& tolerance,
                double& norm);
    /// Calls block(numbers, count) for the stages of the last step.
    template <class Block>
    void transfer_stages(const Block& block)
    {
        block(slope.data(), slope.size());
    }

    const Tableau& tableau;
    Eigen::MatrixXd slope;  ///< column i: the derivative of the variables at stage i

private:
    void set_stage(int i, State& x, double h);
    /// change = h Σ weights_i slope_i
    void combine(double h, const std::vector<double>& weights);

    Eigen::VectorXd change;
    std::vector<double> weights;
};

extern template class ExplicitStep<LocalCoordinateStep>;
extern template class ExplicitStep<TreeStep>;

using RungeKuttaStep = ExplicitStep<LocalCoordinateStep>;
using TreeRungeKuttaStep = ExplicitStep<TreeStep>;

}  // namespace hilda::lie
