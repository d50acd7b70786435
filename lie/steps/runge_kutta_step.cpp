// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/runge_kutta_step.hpp"

#include "lie/steps/projection.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/system.hpp"

#include <cmath>

namespace hilda::lie {

RungeKuttaStep::RungeKuttaStep(const System& model, const Settings& settings, const Tableau& tableau)
    : LocalCoordinateStep(model, settings), tableau(tableau),
      slope(Eigen::MatrixXd::Zero(12 * bodies, tableau.all_stages())), change(12 * bodies),
      weights(static_cast<size_t>(tableau.all_stages()))
{}

int RungeKuttaStep::step(State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    return done(attempt, advance(x, h));
}

int RungeKuttaStep::advance(State& x, double h)
{
    // The first stage is the node; its accelerations are known.
    theta.setZero();
    set_slope(x_n, slope.col(0));
    const int end = tableau.stages();
    for (int i = 1; i < end; ++i) set_stage(i, x, h);
    combine(h, tableau.a[static_cast<size_t>(end)]);
    place(x, change);
    x.t = x_n.t + h;
    model.update_alpha(x);
    const int k = finish(x, tableau.name);
    set_slope(x, slope.col(end));
    return k;
}

int RungeKuttaStep::attempt(State& end, double h, double rtol, double atol, bool /*again*/,
                            Eigen::VectorXd& tolerance, double& norm)
{
    const int k = advance(end, h);
    set_tolerances(x_n, end, rtol, atol, tolerance);
    norm = error(h, tolerance);
    return k;
}

double RungeKuttaStep::error(double h, const Eigen::VectorXd& scale)
{
    const auto mean_square = [&](const std::vector<double>& row) {
        combine(h, row);
        return change.cwiseQuotient(scale).squaredNorm() / static_cast<double>(change.size());
    };
    const double square = mean_square(tableau.error[0]);
    if (tableau.error.size() == 1) return std::sqrt(square);
    // err = err_5²/√(err_5² + 0.01 err_3²), which decreases with h⁸          Hairer et al. (1993), Sec. II.10
    const double both = square + 0.01 * mean_square(tableau.error[1]);
    return both > 0 ? square / std::sqrt(both) : 0;
}

void RungeKuttaStep::interpolate(State& x, double s, double h)
{
    tableau.interpolation(s, weights);
    combine(h, weights);
    place(x, change);
    x.t = x_n.t + s * h;
    model.update_alpha(x);
    assemble_once(x);
    finish(x, tableau.name);
}

void RungeKuttaStep::add_stages(State& x, double h)
{
    for (int i = tableau.stages() + 1; i < tableau.all_stages(); ++i) set_stage(i, x, h);
}

void RungeKuttaStep::set_stage(int i, State& x, double h)
{
    combine(h, tableau.a[static_cast<size_t>(i)]);
    place(x, change);
    x.t = x_n.t + tableau.c[static_cast<size_t>(i)] * h;
    model.update_alpha(x);
    set_accelerations(x);
    set_slope(x, slope.col(i));
}

void RungeKuttaStep::combine(double h, const std::vector<double>& row)
{
    change.setZero();
    for (size_t j = 0; j < row.size(); ++j)
        if (row[j] != 0) change += row[j] * slope.col(static_cast<Eigen::Index>(j));
    change *= h;
}

}  // namespace hilda::lie
