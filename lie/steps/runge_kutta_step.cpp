// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/runge_kutta_step.hpp"

#include "lie/steps/projection.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/system.hpp"

#include <cmath>

namespace hilda::lie {

template <class Coordinates>
ExplicitStep<Coordinates>::ExplicitStep(const System& model, const Settings& settings, const Tableau& tableau)
    : Coordinates(model, settings), tableau(tableau),
      slope(Eigen::MatrixXd::Zero(this->variables(), tableau.all_stages())), change(this->variables()),
      weights(static_cast<size_t>(tableau.all_stages()))
{}

template <class Coordinates>
int ExplicitStep<Coordinates>::step(State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    return this->done(attempt, advance(x, h));
}

template <class Coordinates>
int ExplicitStep<Coordinates>::advance(State& x, double h)
{
    // The first stage is the node; its accelerations are known.
    this->begin_stages();
    this->set_slope(x_n, slope.col(0));
    const int end = tableau.stages();
    for (int i = 1; i < end; ++i) set_stage(i, x, h);
    combine(h, tableau.a[static_cast<size_t>(end)]);
    this->place(x, change);
    x.t = x_n.t + h;
    model.update_alpha(x);
    const int k = this->finish(x, tableau.name);
    this->set_slope(x, slope.col(end));
    return k;
}

template <class Coordinates>
int ExplicitStep<Coordinates>::attempt(State& end, double h, double rtol, double atol, bool /*again*/,
                                       Eigen::VectorXd& tolerance, double& norm)
{
    const int k = advance(end, h);
    set_tolerances(x_n, end, rtol, atol, tolerance);
    norm = error(h, tolerance);
    return k;
}

template <class Coordinates>
double ExplicitStep<Coordinates>::error(double h, const Eigen::VectorXd& scale)
{
    const auto mean_square = [&](const std::vector<double>& row) {
        combine(h, row);
        return this->square_over(scale, change) / static_cast<double>(scale.size());
    };
    const double square = mean_square(tableau.error[0]);
    if (tableau.error.size() == 1) return std::sqrt(square);
    // err = err_5²/√(err_5² + 0.01 err_3²), which decreases with h⁸          Hairer et al. (1993), Sec. II.10
    const double both = square + 0.01 * mean_square(tableau.error[1]);
    return both > 0 ? square / std::sqrt(both) : 0;
}

template <class Coordinates>
void ExplicitStep<Coordinates>::interpolate(State& x, double s, double h)
{
    tableau.interpolation(s, weights);
    this->begin_stages();
    combine(h, weights);
    this->place(x, change);
    x.t = x_n.t + s * h;
    model.update_alpha(x);
    this->assemble_once(x);
    this->finish(x, tableau.name);
}

template <class Coordinates>
void ExplicitStep<Coordinates>::add_stages(State& x, double h)
{
    this->begin_stages();
    for (int i = tableau.stages() + 1; i < tableau.all_stages(); ++i) set_stage(i, x, h);
}

template <class Coordinates>
void ExplicitStep<Coordinates>::set_stage(int i, State& x, double h)
{
    combine(h, tableau.a[static_cast<size_t>(i)]);
    this->place(x, change);
    x.t = x_n.t + tableau.c[static_cast<size_t>(i)] * h;
    model.update_alpha(x);
    this->set_accelerations(x);
    this->set_slope(x, slope.col(i));
}

template <class Coordinates>
void ExplicitStep<Coordinates>::combine(double h, const std::vector<double>& row)
{
    change.setZero();
    for (size_t j = 0; j < row.size(); ++j)
        if (row[j] != 0) change += row[j] * slope.col(static_cast<Eigen::Index>(j));
    change *= h;
}

template class ExplicitStep<LocalCoordinateStep>;
template class ExplicitStep<TreeStep>;

}  // namespace hilda::lie
