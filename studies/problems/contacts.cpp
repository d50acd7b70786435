// SPDX-License-Identifier: GPL-3.0-or-later
/// Models with compliant contacts: a ball that slides until it rolls, a bouncing ellipsoid, an edge mill. The
/// internal state variables of friction are updated by each step, not by a differential equation. The
/// reference solution is therefore a run with small steps.

#include "dae/model_file.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/problem.hpp"
#include "studies/problems/evolving_reference.hpp"

namespace hilda::studies {

namespace {

constexpr double fine = 2e-6;  // [s]

lie::Trajectory reference_solution(dae::Description& d, const std::vector<double>& instants)
{
    return run_with_small_steps(d, instants, lie::scheme("rA-rattle"), fine);
}

constexpr const char* reference_name = "rA-rattle at h = 2e-6 s";

const bool ball = io::Registry<Problem>::add(
    {.name = "rolling_ball",
     .what = "ball thrown on a floor: slides for 0.3 s, then rolls (Fang 2022, Sec. 4.4)",
     .model = R"({"hilda_model": 1, "name": "rolling_ball",
  "note": "ball of 5 kg and radius 0.2 m, initially in static equilibrium on the floor; a rigid ball would roll after 2 v / 7 mu_k g = 0.29 s",
  "gravity": [0, 0, -9.81], "end": 1,
  "bodies": [
    {"name": "ball", "mass": 5, "inertia": [0.08, 0.08, 0.08], "r": [0, 0, 0.19975475], "r_dot": [2, 0, 0], "omega": [0, 0, 1]}
  ],
  "contacts": [
    {"name": "ball-floor", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.2}, "surface_j": {"type": "plane"},
      "normal": {"type": "hooke", "stiffness": 2e5, "restitution": 0.5},
      "friction": {"mu_s": 0.25, "mu_k": 0.2, "K_E": 2e4, "zeta": 0.5, "eta_r": 0.05, "eta_psi": 0.05}}
  ]
}
)",
     .reference_name = reference_name,
     .reference_solution = reference_solution,
     .observable = {.body = "ball", .component = "vx"}});

const bool ellipsoid =
    io::Registry<Problem>::add({.name = "bouncing_ellipsoid",
                                .what = "inclined ellipsoid dropped on a floor, Hertz contact with "
                                        "friction; smooth enough for steps of 1e-4 s",
                                .model = R"({"hilda_model": 1, "name": "bouncing_ellipsoid",
  "note": "homogeneous, semi-axes 0.12, 0.1 and 0.08 m, released about 0.1 m above the floor",
  "gravity": [0, 0, -9.81], "end": 0.6,
  "bodies": [
    {"name": "egg", "mass": 1, "inertia": [0.00328, 0.00416, 0.00488], "r": [0, 0, 0.2],
      "axis_angle": [0.6, 0.8, 0, 0.5], "r_dot": [0.3, 0, 0], "omega": [1, 2, 0]}
  ],
  "contacts": [
    {"name": "egg-floor", "body_i": "egg", "body_j": "ground",
      "surface_i": {"type": "ellipsoid", "semi_axes": [0.12, 0.1, 0.08]}, "surface_j": {"type": "plane"},
      "normal": {"type": "hertz", "E_star": 3e6, "restitution": 0.8},
      "friction": {"mu_s": 0.3, "K_E": 1e4, "zeta": 0.3}}
  ]
}
)",
                                .reference_name = reference_name,
                                .reference_solution = reference_solution,
                                .observable = {.body = "egg", .component = "rz"}});

const bool mill =
    io::Registry<Problem>::add({.name = "edge_mill",
                                .what = "edge mill: ball that rolls on the floor at the end of a "
                                        "rotating, pitching arm; its spin increases the normal force",
                                .model = R"({"hilda_model": 1, "name": "edge_mill",
  "note": "the arm rotates about the vertical and pitches in a universal joint, the ball rotates about the axis of the arm; initially rolling at 1 rad/s",
  "gravity": [0, 0, -9.81], "end": 2,
  "bodies": [
    {"name": "arm", "mass": 1, "inertia": [0.001, 0.02, 0.02], "r": [0.25, 0, 0.2], "r_dot": [0, 0.25, 0], "omega": [0, 0, 1]},
    {"name": "ball", "mass": 5, "inertia": [0.08, 0.08, 0.08], "r": [0.5, 0, 0.2], "r_dot": [0, 0.5, 0], "omega": [-2.5, 0, 1]}
  ],
  "constraints": [
    {"name": "pivot", "type": "universal", "body_i": "arm", "body_j": "ground",
      "s_bar_p_i": [-0.25, 0, 0], "s_bar_q_j": [0, 0, 0.2], "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 0, 1]},
    {"name": "axle", "type": "revolute", "body_i": "ball", "body_j": "arm",
      "s_bar_q_j": [0.25, 0, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}
  ],
  "contacts": [
    {"name": "ball-floor", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.2}, "surface_j": {"type": "plane", "position": [0, 0, 2.69775e-4]},
      "normal": {"type": "hooke", "stiffness": 2e5, "restitution": 0.5},
      "friction": {"mu_s": 0.3, "mu_k": 0.25, "K_E": 2e4, "zeta": 0.5, "eta_r": 0.01, "eta_psi": 0.01}}
  ]
}
)",
                                .reference_name = reference_name,
                                .reference_solution = reference_solution,
                                .observable = {.body = "ball", .component = "ry"}});

}  // namespace

}  // namespace hilda::studies
