// SPDX-License-Identifier: GPL-3.0-or-later
/// A problem of a plug-in: a physical pendulum, with the default reference solution.

#include "studies/framework/problem.hpp"

namespace hilda::studies {

namespace {

const bool registered = io::Registry<Problem>::add(
    {.name = "plugin_pendulum", .what = "bar on a revolute joint, released at 90 degrees", .model = R"json({
  "hilda_model": 1, "name": "plugin_pendulum", "gravity": [0, 0, -9.81], "end": 1,
  "bodies": [{"name": "bar", "mass": 2, "inertia": [0.7, 0.1, 0.7], "r": [0, 1, 0],
              "A": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
  "constraints": [{"name": "hinge", "type": "revolute", "body_i": "bar", "body_j": "ground", "s_bar_p_i": [0, -1, 0],
                   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}]
}
)json"});

}  // namespace

}  // namespace hilda::studies
