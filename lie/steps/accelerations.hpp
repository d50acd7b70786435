// SPDX-License-Identifier: GPL-3.0-or-later
/// Accelerations and multipliers of a state from the saddle system
///
///     K (r̈, ω̄̇, λ) = (F, τ̄, γ),     τ̄ = n̄ - ω̄ × J̄ ω̄                        Fang (2022), Eqs. 2.9, 2.17

#pragma once

#include "lie/loads.hpp"

namespace hilda::lie {

class Saddle;
class System;

/// Computes r̈, ω̄̇ and λ of x. Positions and velocities must satisfy the constraints. For starts and
/// restarts.
///
/// Regularised rows have the compliance of a step of 1 s here. Their γ is replaced by γ - C v/τ with τ = 1e-6
/// s, so that friction opposes the sliding velocity. Throws NumericalFailure "start_not_converged" if their
/// bounds and the normal forces do not become consistent, and NonFinite for a load that is not finite.
void solve_accelerations(const System& system, Saddle& K, State& x);

/// The same in a step, for systems without regularised rows. K is factored at x; `loads` and `b` receive the
/// loads and the solution.
void solve_accelerations(const System& system, Saddle& K, State& x, Loads& loads, Eigen::VectorXd& b);

/// b = (F, τ̄, 0, γ) in the state x. `loads` receives F and n̄.
void set_load_terms(const System& system, const Saddle& K, const State& x, Loads& loads, Eigen::VectorXd& b);

}  // namespace hilda::lie
