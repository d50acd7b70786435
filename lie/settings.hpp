// SPDX-License-Identifier: GPL-3.0-or-later
/// Settings of the integrators.

#pragma once

#include "lie/solver/linear_solver.hpp"

#include <limits>
#include <map>
#include <string>

namespace hilda::lie {

/// Settings of an integrator. Each scheme uses those that apply to it.
struct Settings {
    /// Newton's method stops when the norm of the correction is below this tolerance. Half-implicit schemes
    /// measure (Δr, Δθ̄, Δλ̂) in m, rad and kg m; fully implicit schemes measure h² (Δr̈, Δω̄̇, Δλ), in the
    /// same units. NewtonStep::converged defines the norm.
    double tolerance = 1e-10;
    int max_iterations = 30;
    LinearSolver linear_solver = LinearSolver::automatic;
    double rho_infinity = 0.8;   ///< generalised-α: spectral radius for infinite frequency, from 0 to 1
    bool reparametrise = false;  ///< Euler angles: change to another body frame near their singularity
    double rtol = 1e-10;         ///< adaptive schemes: relative error tolerance of a step
    double atol = 0;      ///< adaptive schemes: absolute error tolerance [m, m/s; 1, 1/s]; 0: equal to rtol
    double max_step = 0;  ///< adaptive schemes: longest internal step [s]; 0: no limit
    double longest_step() const { return max_step > 0 ? max_step : std::numeric_limits<double>::infinity(); }
    /// Whether each step computes the multipliers, if the scheme can do without them. Otherwise they are
    /// those of Integrator::set_multipliers().
    bool multipliers = true;
    /// Adaptive schemes call this function between their internal steps and throw Interrupted if it returns
    /// true.
    bool (*stop)() = nullptr;
    /// Values of the options that schemes declare (Scheme::options), by name: --damping. Scheme::make() adds
    /// the default values of those that are missing.
    std::map<std::string, double> of_scheme = {};
};

}  // namespace hilda::lie
