// SPDX-License-Identifier: GPL-3.0-or-later
/// How far a trajectory is from the truth.

#pragma once

#include "dae/model.hpp"
#include "lie/trajectory.hpp"
#include "studies/framework/problem.hpp"

#include <array>

namespace hilda::studies {

/// The norms of a convergence study. "Stacked" is the Euclidean norm over all bodies, A by its Frobenius norm.
///
///     r, A, v, omega      root mean square over the instants of the stacked difference [m, -, m/s, rad/s]
///     Q                   the same of |ΔQ| / |Q|, Q the resultant constraint forces and torques of all bodies
///                         stacked, over the instants before the end (a half-implicit scheme knows a node's
///                         loads one step late)
///     r_end … omega_end   of the watched body at the end
///     watched             sqrt(Σ (z - z_ref)² / n) of the watched scalar, the norm of Fang (2022), Sec. 3.8.1,
///                         over every node that is also an instant of the truth
namespace norm {

enum : int { r, A, v, omega, Q, r_end, A_end, v_end, omega_end, observable, count };
inline constexpr std::array<const char*, count> names = {"r",     "A",     "v",     "omega",     "Q",
                                                         "r_end", "A_end", "v_end", "omega_end", "watched"};

}  // namespace norm

struct Errors {
    std::array<double, norm::count> value{};
    int instants = 0;  ///< at which r, A, v, omega were compared
};

/// How far one state is from another: stacked, as above
struct Difference {
    double r = 0, A = 0, v = 0, omega = 0;
};
Difference difference(const lie::State& x, const lie::State& reference_solution);

/// A component rx … wz of a body
double component(const lie::State& x, int body, const std::string& name);

/// What the rms norms are compared at: every `stride`-th of the truth's rows after the first.
struct Instants {
    double dt = 0.01;  ///< between rows of the truth [s]
    int stride = 10;
    long count = 300;  ///< rows after the one at t = 0
};

/// Compares `run`, whose row k is the state at the instant number at[k], with the truth. Only instants that
/// the run has are compared.
Errors errors(const dae::Model& model, const lie::Trajectory& run, const std::vector<long>& at,
              const lie::Trajectory& reference_solution, const Instants& instants,
              const Observable& observable);

/// The size of each quantity in the truth, in the same norm: what rounding is measured against.
Errors sizes(const dae::Model& model, const lie::Trajectory& reference_solution, const Instants& instants,
             const Observable& observable);

}  // namespace hilda::studies
