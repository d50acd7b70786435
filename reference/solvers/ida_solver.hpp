// SPDX-License-Identifier: GPL-3.0-or-later
/// SUNDIALS IDA (variable-order BDF with error control) for the equations of motion in Euler parameters.

#pragma once

#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "reference/solvers/rank_monitor.hpp"
#include "reference/solvers/rp_equations.hpp"

namespace hilda::reference {

/// Integrator with adaptive internal steps, for the equations of RpEquations.
///
/// Accuracy: the local error of an internal step is below a tenth of rtol |y| + atol. The error after a few
/// seconds is about 100 rtol. Below rtol = 2e-13 rounding dominates and the error does not decrease further.
///
/// Nodes: IDA steps past a node and interpolates. Positions and velocities of a node are those of IDA, with
/// the constraint drift that the tolerance permits. Accelerations and multipliers of a node are computed from
/// the positions and velocities by the saddle system (Fang (2022), Eq. 2.17), because IDA does not control
/// the error of its own multipliers.
///
/// Discrete states (branches of drivers, turn counts) are updated after each internal step, on a copy
/// projected onto the constraints. IDA restarts if the update changes the equations, or if advance() gets a
/// state that is not the one the last call returned.
///
/// Throws lie::InvalidInput if rtol or an atol other than 0 is below 1e-14, or if the state has continuous
/// internal states (friction histories);
/// lie::NumericalFailure "ida_failed" with the message of IDA if IDA fails; lie::NonFinite with the name of
/// the equation if a residual is not finite; lie::Interrupted if settings.stop() returns true. Exceptions of
/// the system are rethrown. After an exception x is unchanged.
class IdaSolver final : public lie::Integrator, public RankMonitor {
public:
    /// Uses rtol, atol and stop of the settings; atol = 0 means atol = rtol. Units of atol: m, m/s and 1/s
    /// for r, ṙ and ṗ. The system must outlive the solver.
    explicit IdaSolver(const lie::System& system, const lie::Settings& settings = {},
                       RpForm form = RpForm::ggl);
    ~IdaSolver() override;

    int step(lie::State& x, double h) override { return advance(x, x.t + h); }
    /// Integrates x to t_end > x.t [s]. Returns the number of Newton iterations.
    int advance(lie::State& x, double t_end);

    bool chooses_internal_steps() const override { return true; }
    const lie::System& system() const override { return mechanism; }
    /// Counts of IDA: internal steps, Newton iterations, factorisations of the Jacobian
    lie::Statistics statistics() const override;
    /// Of the forms of index 1, which pass a configuration where the rows lose rank without an error, and may
    /// leave it on another branch. The form RpForm::ggl does not converge there.
    Smallest smallest_condition() const override;

private:
    class Ida;

    const lie::System& mechanism;
    const lie::Settings settings;
    const RpForm form;
    std::unique_ptr<Ida> ida;  ///< created by the first call of advance()
};

/// States at the given instants by IdaSolver in the form RpForm::ggl, with accelerations and multipliers.
///
/// @param x         initial state, made consistent by dae::start()
/// @param instants  [s], ascending, none before x.t
///
/// Unlike index1(), it accepts a fully driven system and any lie::System. Throws lie::InvalidInput for
/// instants out of order, and the exceptions of IdaSolver.
lie::Trajectory ida(const lie::System& system, const lie::State& x, const std::vector<double>& instants,
                    double rtol = 1e-12, double atol = 0);

}  // namespace hilda::reference
