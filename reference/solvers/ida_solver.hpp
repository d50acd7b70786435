// SPDX-License-Identifier: GPL-3.0-or-later
/// The reference solver: SUNDIALS IDA (variable-order BDF with error control) on the rp equations.

#pragma once

#include "lie/trajectory.hpp"
#include "reference/solvers/rp_equations.hpp"

namespace hilda::reference {

/// An integrator that chooses its own steps, by rtol and atol: the error of each is below a tenth of rtol |y| +
/// atol, so that a run of some seconds ends within about 100 rtol. Below rtol = 2e-13 nothing more is won.
///
/// IDA goes past the nodes it is asked for and interpolates there; positions and velocities of a node are IDA's
/// own, with the drift that its tolerances leave, accelerations and multipliers are solved for from them (Eq.
/// 2.17): those that IDA carries are not controlled. What the system remembers is updated after each of IDA's
/// steps, on a copy that lies on the constraints. Where that changes the equations (a driver is swapped), and
/// where the state given is not the one that was left, IDA starts anew.
///
/// Throws lie::InvalidInput for rtol below 1e-14, lie::NumericalFailure "ida_failed" with IDA's own words when
/// it gives up, lie::NonFinite naming the equation, and whatever the system throws.
class IdaSolver final : public lie::Integrator {
public:
    /// Takes rtol and atol from the settings. The system must outlive the solver.
    explicit IdaSolver(const lie::System& system, const lie::Settings& settings = {},
                       RpForm form = RpForm::ggl);
    ~IdaSolver() override;

    int step(lie::State& x, double h) override { return advance(x, x.t + h); }
    /// Takes x to t_end > x.t and returns the number of Newton iterations.
    int advance(lie::State& x, double t_end);

    const lie::System& system() const override { return of; }
    /// IDA's own counts: of its steps, Newton iterations and set-ups of the linear solver
    lie::Statistics statistics() const override;

private:
    class Ida;

    const lie::System& of;
    const lie::Settings settings;
    const RpForm form;
    std::unique_ptr<Ida> ida;  ///< made for the first state
};

/// States at these instants [s], ascending, none before x.t, with accelerations and multipliers; x is a state
/// that dae::start() has readied. Unlike index1() it also takes a system whose every motion is driven.
lie::Trajectory ida(const lie::System& system, const lie::State& x, const std::vector<double>& instants,
                    double rtol = 1e-12, double atol = 0);

}  // namespace hilda::reference
