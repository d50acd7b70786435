// SPDX-License-Identifier: GPL-3.0-or-later
/// Errors of a trajectory with respect to a reference solution.

#pragma once

#include "lie/trajectory.hpp"
#include "studies/framework/problem.hpp"

#include <array>

namespace hilda::dae {
class Model;
}

namespace hilda::studies {

/// The error norms of a convergence study. The norm of a state difference is the Euclidean norm over all
/// bodies, with the Frobenius norm for A.
///
///     r, A, v, omega      rms of the norm of the difference over the instants [m, -, m/s, rad/s]
///     Q                   rms of |ΔQ| / |Q|, Q: resultant constraint forces and torques of all bodies, over
///                         the instants before the end (a half-implicit scheme provides the loads of a node
///                         one step later)
///     r_end … omega_end   error of the observed body at the end
///     observable          sqrt(Σ (z - z_ref)² / n) of the observed scalar z over all nodes that are rows of the
///                         reference solution; the norm of Fang (2022), Sec. 3.8.1
namespace norm {

enum : int { r, A, v, omega, Q, r_end, A_end, v_end, omega_end, observable, count };
inline constexpr std::array<const char*, count> names = {
    "r", "A", "v", "omega", "Q", "r_end", "A_end", "v_end", "omega_end", "observable"};

}  // namespace norm

struct Errors {
    std::array<double, norm::count> value{};
    int instants = 0;  ///< number of instants at which r, A, v, omega were compared
};

/// Norms of the difference of two states over all bodies
struct Difference {
    double r = 0, A = 0, v = 0, omega = 0;
};
Difference difference(const lie::State& x, const lie::State& reference_solution);

/// A component rx … rz, vx … vz, wx … wz of a body: position, velocity (global), angular velocity (body
/// frame)
double component(const lie::State& x, int body, const std::string& name);

/// Rows of a reference solution. The root mean squares of r, A, v, omega and Q use each `stride`-th row after
/// the first.
struct Instants {
    double dt = 0.01;  ///< time between rows [s]
    int stride = 10;
    long count = 300;  ///< number of rows after t = 0
};

/// Errors of `run`, whose row k is the state at row at[k] of the reference solution. Only rows that the run
/// contains are compared. lie::InvalidInput for an unknown body or component of the observable.
Errors errors(const dae::Model& model, const lie::Trajectory& run, const std::vector<long>& at,
              const lie::Trajectory& reference_solution, const Instants& instants,
              const Observable& observable);

/// Norms of the reference solution itself, as a scale for rounding errors
Errors sizes(const dae::Model& model, const lie::Trajectory& reference_solution, const Instants& instants,
             const Observable& observable);

}  // namespace hilda::studies
