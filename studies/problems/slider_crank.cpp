// SPDX-License-Identifier: GPL-3.0-or-later
/// The spatial slider-crank with a crank driven at one revolution per second: Fang (2022), Table 3.4.

#include "studies/framework/problem.hpp"

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"

namespace hilda::studies {

namespace {

const bool registered_slider_crank = io::Registry<Problem>::add(
    {.name = "slider_crank",
     .what = "spatial slider-crank, crank driven at one revolution per second, no degree of "
             "freedom (Fang 2022, Table 3.4)",
     .model = R"json({"hilda_model": 1, "name": "slider_crank",
  "note": "Fang (2022), Table 3.4, crank mass 0.12; initial state projected onto the constraints; the D row trans_D keeps the end of the rod on the slider",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "crank", "mass": 0.12, "inertia": [1e-4, 1e-5, 1e-4], "shape": {"box": [0.02, 0.16, 0.02]},
      "r": [0, 0.1, 0.12], "A": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
      "omega": [-6.283185307179586, 0, 0]},
    {"name": "rod", "mass": 0.5, "inertia": [4e-3, 4e-4, 4e-3], "shape": {"box": [0.3, 0.02, 0.02]},
      "r": [0.1, 0.05, 0.1],
      "A": [[ 0.6666666666666666,  0,                   0.7453559924999299],
            [-0.3333333333333333,  0.8944271909999159, 0.29814239699997196],
            [-0.6666666666666666, -0.4472135954999579, 0.5962847939999439]],
      "r_dot": [-0.1256637061435917, 0.25132741228718345, 0],
      "omega": [-1.3404128655316495, 1.1239703569665, -1.498627142622026]},
    {"name": "slider", "mass": 2, "inertia": [1e-4, 1e-4, 1e-4], "shape": {"box": [0.04, 0.04, 0.06]},
      "r": [0.2, 0, 0], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
      "r_dot": [-0.25132741228718345, 0, 0]}
  ],
  "constraints": [
    {"name": "rev_A_CD_1",       "type": "CD",  "body_i": "ground", "body_j": "crank", "c": [1, 0, 0], "s_bar_p_i": [0, 0.1, 0.12]},
    {"name": "rev_A_CD_2",       "type": "CD",  "body_i": "ground", "body_j": "crank", "c": [0, 1, 0], "s_bar_p_i": [0, 0.1, 0.12]},
    {"name": "rev_A_CD_3",       "type": "CD",  "body_i": "ground", "body_j": "crank", "c": [0, 0, 1], "s_bar_p_i": [0, 0.1, 0.12]},
    {"name": "rev_A_DP1_1",      "type": "DP1", "body_i": "ground", "body_j": "crank", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "rev_A_DP1_2",      "type": "DP1", "body_i": "ground", "body_j": "crank", "a_bar_i": [0, 0, 1], "a_bar_j": [1, 0, 0]},
    {"name": "sphere_B_CD_1",    "type": "CD",  "body_i": "rod", "body_j": "crank", "c": [1, 0, 0], "s_bar_p_i": [-0.15, 0, 0], "s_bar_q_j": [0, 0.08, 0]},
    {"name": "sphere_B_CD_2",    "type": "CD",  "body_i": "rod", "body_j": "crank", "c": [0, 1, 0], "s_bar_p_i": [-0.15, 0, 0], "s_bar_q_j": [0, 0.08, 0]},
    {"name": "sphere_B_CD_3",    "type": "CD",  "body_i": "rod", "body_j": "crank", "c": [0, 0, 1], "s_bar_p_i": [-0.15, 0, 0], "s_bar_q_j": [0, 0.08, 0]},
    {"name": "rev_cyl_C_DP1_1",  "type": "DP1", "body_i": "rod", "body_j": "slider", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 0, 1]},
    {"name": "rev_cyl_C_DP2_1",  "type": "DP2", "body_i": "rod", "body_j": "slider", "a_bar_i": [0, 1, 0], "s_bar_p_i": [0.15, 0, 0]},
    {"name": "rev_cyl_C_DP2_2",  "type": "DP2", "body_i": "rod", "body_j": "slider", "a_bar_i": [0, 0, 1], "s_bar_p_i": [0.15, 0, 0]},
    {"name": "trans_D_DP1_1",    "type": "DP1", "body_i": "slider", "body_j": "ground", "a_bar_i": [-1, 0, 0], "a_bar_j": [1, 0, 0]},
    {"name": "trans_D_DP1_2",    "type": "DP1", "body_i": "slider", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "trans_D_DP2_1",    "type": "DP2", "body_i": "slider", "body_j": "ground", "a_bar_i": [-1, 0, 0], "s_bar_q_j": [0.2, 0, 0]},
    {"name": "trans_C_DP2_2",    "type": "DP2", "body_i": "slider", "body_j": "ground", "a_bar_i": [0, 1, 0], "s_bar_q_j": [0.2, 0, 0]},
    {"name": "trans_D_DP1_3",    "type": "DP1", "body_i": "slider", "body_j": "ground", "a_bar_i": [-1, 0, 0], "a_bar_j": [0, 1, 0]},
    {"name": "trans_D",          "type": "D",   "body_i": "rod", "body_j": "slider", "s_bar_p_i": [0.15, 0, 0], "s_bar_q_j": [0, 0, 1], "f": "1"},
    {"name": "driver",           "type": "DP1", "body_i": "ground", "body_j": "crank", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 1, 0], "f": "cos(-2*pi*t + pi/2)"}
  ]
}
)json",
     .reference_name = "kinematic analysis at 1e-13",
     .reference_solution =
         [](dae::Description& d, const std::vector<double>& instants) {
             return reference::reference_solution(*d.model, d.x, instants);
         },
     .observable = {.body = "slider", .component = "vx"}});

}  // namespace

}  // namespace hilda::studies
