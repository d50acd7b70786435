// SPDX-License-Identifier: GPL-3.0-or-later
/// A bar with a revolute joint about x and a driven oscillation.

#include "studies/framework/problem.hpp"

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"

namespace hilda::studies {

namespace {

const bool registered_single_pendulum = io::Registry<Problem>::add(
    {.name = "single_pendulum",
     .what = "bar with a driven oscillation about x, no degree of freedom (published code of Fang 2022)",
     .model = R"json({"hilda_model": 1, "name": "single_pendulum",
  "note": "bar of 4 m, section 0.05 m, 7800 kg/m3; driver of the published code of Fang (2022)",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "bar", "mass": 78, "inertia": [0.0325, 104.01625, 104.01625],
      "r": [0, 1.4142135623730951, -1.4142135623730951],
      "A": [[0, 0, 1], [0.7071067811865476, 0.7071067811865476, 0], [-0.7071067811865476, 0.7071067811865476, 0]]}
  ],
  "constraints": [
    {"name": "revJoint_DP1_1", "type": "DP1", "body_i": "bar", "body_j": "ground", "a_bar_i": [1, 0, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_DP1_2", "type": "DP1", "body_i": "bar", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_CD_1",  "type": "CD",  "body_i": "bar", "body_j": "ground", "c": [1, 0, 0], "s_bar_p_i": [-2, 0, 0]},
    {"name": "revJoint_CD_2",  "type": "CD",  "body_i": "bar", "body_j": "ground", "c": [0, 1, 0], "s_bar_p_i": [-2, 0, 0]},
    {"name": "revJoint_CD_3",  "type": "CD",  "body_i": "bar", "body_j": "ground", "c": [0, 0, 1], "s_bar_p_i": [-2, 0, 0]},
    {"name": "DP1-drive", "type": "DP1", "body_i": "bar", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 0, -1],
      "f": "cos(pi/2 + pi/4*cos(2*t))"}
  ]
}
)json",
     .reference_name = "kinematic analysis at 1e-13",
     .reference_solution =
         [](dae::Description& d, const std::vector<double>& instants) {
             return reference::reference_solution(*d.model, d.x, instants);
         },
     .observable = {}});

}  // namespace

}  // namespace hilda::studies
