// SPDX-License-Identifier: GPL-3.0-or-later
/// Projection of positions and velocities onto the constraints. The changes are the shortest ones in the
/// metric of the mass.
///
/// The functions below the two projections are their parts, for steps that combine them otherwise. K is the
/// saddle matrix of the system. The vectors b, dz and v have the order of its unknowns.

#pragma once

#include "lie/state.hpp"

namespace hilda::lie {

struct Rows;
class Saddle;
class System;

/// Projects r, A and α onto Φ(r, A, α, t) = 0 by Newton's method, K (δr, δθ̄, δα, ·) = (0, -Φ).
///
/// Returns the number of steps. The tolerance [m or rad] applies to System::position_error(). Far from the
/// origin it is at least 8 eps max |r|, the rounding error of a position. The steps are damped, so that
/// distant positions converge. On return K is factored at the last but one position. Throws NoConvergence
/// after 50 steps, and NonFinite if a residual is not finite.
int project_positions(const System& system, Saddle& K, State& x, double tolerance = 1e-13);

/// Projects ṙ and ω̄ onto Φ_r ṙ + Π̄ ω̄ = ν by K (v, ·) = (M v, ν). The change is that of an ideal inelastic
/// impact. On return K is factored at x.
void project_velocities(const System& system, Saddle& K, State& x);

/// b = (0, -Φ(x)), the right side of a Newton step
void set_position_residual(const System& system, const Saddle& K, const State& x, Eigen::VectorXd& b);
/// α += fraction δα, where `change` lists the algebraic variables group by group
void move_algebraic(const Rows& C, State& x, const Eigen::Ref<const Eigen::VectorXd>& change,
                    double fraction = 1);
/// Moves x by `fraction` of the change dz: r += δr, A ← A exp(δθ̄~), α += δα
void move(const Saddle& K, State& x, Eigen::VectorXd& dz, double fraction = 1);

/// Writes M (ṙ, ω̄) of all bodies to the components of the bodies in b.
void set_momenta(const System& system, const State& x, Eigen::VectorXd& b);
/// Sets ṙ and ω̄ of x from K (v, ·) = (p, ν), where b holds the momenta p of the bodies on entry, v and the
/// impulses of the rows on return. K is factored at x.
void solve_velocities(const System& system, Saddle& K, State& x, Eigen::VectorXd& b, bool refined = false);
/// Sets ṙ and ω̄ of x from the components of the bodies in v.
void set_velocities(State& x, const Eigen::VectorXd& v);

}  // namespace hilda::lie
