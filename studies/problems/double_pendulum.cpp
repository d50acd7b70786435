// SPDX-License-Identifier: GPL-3.0-or-later
/// The planar double pendulum: two bars on revolute joints about x.        Fang (2022), Table 3.2, Fig. 3.4

#include "studies/framework/problem.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "reference/motions/closed_form.hpp"
#include "reference/solvers/reference_solution.hpp"

namespace hilda::studies {

namespace {

constexpr double length_1 = 4, length_2 = 2;  // [m]

/// Reference solution in the two angles. Masses, moments of inertia, gravity and the planar initial state are
/// those of the model, so that changes by --set are included; the lengths are fixed.
lie::Trajectory two_angles(dae::Description& d, const std::vector<double>& instants)
{
    return reference::reference_solution(*d.model, d.x, instants, [&](const std::vector<double>& times) {
        reference::PlanarChain chain{
            .bar = {{.length = length_1}, {.length = length_2}}, .gravity = d.model->gravity, .t_0 = d.x.t};
        for (size_t b = 0; b < 2; ++b) {
            const lie::Motion& body = d.x.body[b];
            chain.bar[b].m = d.model->mass().m[b];
            chain.bar[b].J = d.model->mass().J_bar[b](2, 2);
            chain.bar[b].theta = std::atan2(body.A(1, 0), -body.A(2, 0));
            chain.bar[b].thetadot = body.omega_bar.z();
        }
        return chain.at(times);
    });
}

const std::string joints = R"(
  "constraints": [
    {"name": "revJoint_DP1_1",   "type": "DP1", "body_i": "bar_1", "body_j": "ground", "a_bar_i": [1, 0, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_DP1_2",   "type": "DP1", "body_i": "bar_1", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_CD_1",    "type": "CD",  "body_i": "bar_1", "body_j": "ground", "c": [1, 0, 0], "s_bar_p_i": [-2, 0, 0]},
    {"name": "revJoint_CD_2",    "type": "CD",  "body_i": "bar_1", "body_j": "ground", "c": [0, 1, 0], "s_bar_p_i": [-2, 0, 0]},
    {"name": "revJoint_CD_3",    "type": "CD",  "body_i": "bar_1", "body_j": "ground", "c": [0, 0, 1], "s_bar_p_i": [-2, 0, 0]},
    {"name": "revJoint_DP1_1_2", "type": "DP1", "body_i": "bar_2", "body_j": "ground", "a_bar_i": [1, 0, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_DP1_2_2", "type": "DP1", "body_i": "bar_2", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revJoint_CD_1_2",  "type": "CD",  "body_i": "bar_1", "body_j": "bar_2", "c": [1, 0, 0], "s_bar_p_i": [2, 0, 0], "s_bar_q_j": [-1, 0, 0]},
    {"name": "revJoint_CD_2_2",  "type": "CD",  "body_i": "bar_1", "body_j": "bar_2", "c": [0, 1, 0], "s_bar_p_i": [2, 0, 0], "s_bar_q_j": [-1, 0, 0]},
    {"name": "revJoint_CD_3_2",  "type": "CD",  "body_i": "bar_1", "body_j": "bar_2", "c": [0, 0, 1], "s_bar_p_i": [2, 0, 0], "s_bar_q_j": [-1, 0, 0]}
  ])";

Problem double_pendulum(const std::string& name, const std::string& what, const std::string& head_and_bodies,
                        const std::string& forces = "")
{
    return {.name = name,
            .what = what,
            .model = "{\"hilda_model\": 1, \"name\": \"" + name + "\"," + head_and_bodies + joints + forces +
                     "\n}\n",
            .reference_name = "two-angle equations (rk8pd, 1e-13)",
            .reference_solution = two_angles,
            .observable = {}};
}

const std::string bars_at_rest = R"(
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "bar_1", "mass": 312, "inertia": [0.52, 416.26, 416.26], "r": [0, 2, 0],  "A": [[0, 0, 1], [1, 0, 0], [0, 1, 0]]},
    {"name": "bar_2", "mass": 156, "inertia": [0.26, 52.13, 52.13],   "r": [0, 4, -1], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}
  ],)";

const bool thick = io::Registry<Problem>::add(double_pendulum(
    "double_pendulum", "planar double pendulum from rest, bars of section 0.1 m (Fang 2022, Table 3.2)", R"(
  "note": "Fang (2022), Table 3.2: bars of 4 m and 2 m, section 0.1 m, 7800 kg/m3",)" + bars_at_rest));

const bool thin = io::Registry<Problem>::add(
    double_pendulum("double_pendulum_w005",
                    "planar double pendulum from rest, bars of section 0.05 m (the published code)", R"(
  "note": "section 0.05 m, as in the published code of Fang (2022); the dissertation's Table 3.2 says 0.1 m",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "bar_1", "mass": 78, "inertia": [0.0325, 104.01625, 104.01625],   "r": [0, 2, 0],  "A": [[0, 0, 1], [1, 0, 0], [0, 1, 0]]},
    {"name": "bar_2", "mass": 39, "inertia": [0.01625, 13.008125, 13.008125], "r": [0, 4, -1], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}
  ],)"));

const bool moving = io::Registry<Problem>::add(
    double_pendulum("double_pendulum_moving",
                    "planar double pendulum with initial angular velocities; not in the dissertation", R"(
  "note": "double_pendulum with initial angular velocities: bar 1 1 rad/s, bar 2 -2 rad/s",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "bar_1", "mass": 312, "inertia": [0.52, 416.26, 416.26], "r": [0, 2, 0],  "A": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
      "r_dot": [0, 0, 2], "omega": [0, 0, 1]},
    {"name": "bar_2", "mass": 156, "inertia": [0.26, 52.13, 52.13],   "r": [0, 4, -1], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
      "r_dot": [0, -2, 4], "omega": [0, 0, -2]}
  ],)"));

/// The strut between the ground and the end of bar 2 leaves one slow motion, that of a four-bar linkage, and
/// an oscillation of its length. At the start its preload, which does not depend on the stiffness, is the
/// load of a rigid strut, so that the oscillation is small.
Problem with_strut()
{
    Problem p = double_pendulum("double_pendulum_strut",
                                "planar double pendulum whose end is held by a stiff spring-damper", R"(
  "note": "double_pendulum with a strut from the ground to the end of bar 2",)" + bars_at_rest,
                                R"(,
  "forces": [
    {"name": "strut", "type": "spring-damper", "body_i": "ground", "s_bar_p_i": [0, 6, 0], "body_j": "bar_2", "s_bar_q_j": [1, 0, 0],
     "stiffness": 1e8, "damping": 0, "free_length": 2.8284271247461903,
     "force": 721.7567345870075, "implicit": true}
  ])");
    p.reference_name = "index-1 equations (GSL rk8pd, 1e-13)";
    p.reference_solution = [](dae::Description& d, const std::vector<double>& t) {
        return reference::reference_solution(*d.model, d.x, t);
    };
    return p;
}

const bool strut = io::Registry<Problem>::add(with_strut());

}  // namespace

}  // namespace hilda::studies
