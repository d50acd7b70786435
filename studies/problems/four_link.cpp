// SPDX-License-Identifier: GPL-3.0-or-later
/// The spatial four-link mechanism with a rotor driven at half a revolution per second: Fang (2022), Table
/// 3.3.

#include "studies/framework/problem.hpp"

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"

namespace hilda::studies {

namespace {

struct Inertia {
    std::string rotor, link_2, link_3;  ///< keys "mass" and "inertia" of each body
};

Problem four_link(const std::string& name, const std::string& what, const std::string& note,
                  const Inertia& inertia)
{
    return {.name = name,
            .what = what,
            .model = "{\"hilda_model\": 1, \"name\": \"" + name + "\",\n  \"note\": \"" + note + R"json(",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "rotor", )json" +
                     inertia.rotor + R"json(, "shape": {"cylinder": [2, 0.1], "axis": "z"},
      "r": [0, 0, 0], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
      "omega": [0, 0, 3.141592653589793]},
    {"name": "link_2", )json" +
                     inertia.link_2 + R"json(, "shape": {"cylinder": [0.1, 12.2], "axis": "y"},
      "r": [-3.745557718914304, -4.25, 4.262365437828616],
      "A": [[ 0.7501572123794653,     0.6140258555597219, 0.24543106042068244],
            [-0.6612594705590589,     0.6967213114754098, 0.27805633733461],
            [-0.0002632698674116588, -0.3708795799719043, 0.9286809289787538]],
      "r_dot": [-5.266847522470136, -3.14159265358981, -2.8180737328162566],
      "omega": [0.4977376324560374, 1.9303386981341297, -0.9881360059689986]},
    {"name": "link_3", )json" +
                     inertia.link_3 + R"json(, "shape": {"cylinder": [0.1, 7.4], "axis": "y"},
      "r": [-5.745557718914304, -8.5, 3.2623654378286155],
      "A": [[0, 0.4717723564633253, 0.8817203886023283], [-1, 0, 0], [0, -0.8817203886023285, 0.4717723564633257]],
      "r_dot": [-5.266847522470134, 0, -2.818073732816258],
      "omega": [1.6144259810377577, 0, 0]}
  ],
  "constraints": [
    {"name": "revA-dp1-ki",    "type": "DP1", "body_i": "rotor",  "body_j": "ground", "a_bar_i": [1, 0, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revA-dp1-ji",    "type": "DP1", "body_i": "rotor",  "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [1, 0, 0]},
    {"name": "revA-CD-i",      "type": "CD",  "body_i": "rotor",  "body_j": "ground", "c": [1, 0, 0]},
    {"name": "revA-CD-j",      "type": "CD",  "body_i": "rotor",  "body_j": "ground", "c": [0, 1, 0]},
    {"name": "revA-CD-k",      "type": "CD",  "body_i": "rotor",  "body_j": "ground", "c": [0, 0, 1]},
    {"name": "revD-dp1-ii",    "type": "DP1", "body_i": "link_3", "body_j": "ground", "a_bar_i": [0, 0, 1], "a_bar_j": [0, 1, 0]},
    {"name": "revD-dp1-ij",    "type": "DP1", "body_i": "link_3", "body_j": "ground", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 1, 0]},
    {"name": "revD-CD-i",      "type": "CD",  "body_i": "link_3", "body_j": "ground", "c": [1, 0, 0], "s_bar_p_i": [0, 3.7, 0], "s_bar_q_j": [-4, -8.5, 0]},
    {"name": "revD-CD-j",      "type": "CD",  "body_i": "link_3", "body_j": "ground", "c": [0, 1, 0], "s_bar_p_i": [0, 3.7, 0], "s_bar_q_j": [-4, -8.5, 0]},
    {"name": "revD-CD-k",      "type": "CD",  "body_i": "link_3", "body_j": "ground", "c": [0, 0, 1], "s_bar_p_i": [0, 3.7, 0], "s_bar_q_j": [-4, -8.5, 0]},
    {"name": "spherical-CD-i", "type": "CD",  "body_i": "link_3", "body_j": "link_2", "c": [1, 0, 0], "s_bar_p_i": [0, -3.7, 0], "s_bar_q_j": [0, -6.1, 0]},
    {"name": "spherical-CD-j", "type": "CD",  "body_i": "link_3", "body_j": "link_2", "c": [0, 1, 0], "s_bar_p_i": [0, -3.7, 0], "s_bar_q_j": [0, -6.1, 0]},
    {"name": "spherical-CD-k", "type": "CD",  "body_i": "link_3", "body_j": "link_2", "c": [0, 0, 1], "s_bar_p_i": [0, -3.7, 0], "s_bar_q_j": [0, -6.1, 0]},
    {"name": "univ-CD-i",      "type": "CD",  "body_i": "rotor",  "body_j": "link_2", "c": [1, 0, 0], "s_bar_p_i": [-2, 0, 0], "s_bar_q_j": [0, 6.1, 0]},
    {"name": "univ-CD-j",      "type": "CD",  "body_i": "rotor",  "body_j": "link_2", "c": [0, 1, 0], "s_bar_p_i": [-2, 0, 0], "s_bar_q_j": [0, 6.1, 0]},
    {"name": "univ-CD-k",      "type": "CD",  "body_i": "rotor",  "body_j": "link_2", "c": [0, 0, 1], "s_bar_p_i": [-2, 0, 0], "s_bar_q_j": [0, 6.1, 0]},
    {"name": "univ-DP1",       "type": "DP1", "body_i": "rotor",  "body_j": "link_2", "a_bar_i": [0, -0.662, 0.75], "a_bar_j": [0, 0, 1]},
    {"name": "driving-kk",     "type": "DP1", "body_i": "rotor",  "body_j": "ground", "a_bar_i": [-1, 0, 0], "a_bar_j": [0, 1, 0], "f": "cos(pi*t + pi/2)"}
  ]
}
)json",
            .reference_name = "kinematic analysis at 1e-13",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& instants) {
                    return reference::reference_solution(*d.model, d.x, instants);
                },
            .observable = {.body = "link_2", .component = "vz"}};
}

const bool code = io::Registry<Problem>::add(four_link(
    "four_link",
    "spatial four-link, rotor driven at half a revolution per second, no degree of freedom (published code "
    "of Fang 2022)",
    "mass and inertia of the published code of Fang (2022); initial state projected onto the constraints",
    {.rotor = R"json("mass": 2, "inertia": [4, 2, 2])json",
     .link_2 = R"json("mass": 1, "inertia": [12.4, 0.1, 12.4])json",
     .link_3 = R"json("mass": 1, "inertia": [4.54, 0.01, 4.54])json"}));

const bool table = io::Registry<Problem>::add(four_link(
    "four_link_table33",
    "four_link with the densities and dimensions of the dissertation (Fang 2022, Table 3.3)",
    "Fang (2022), Table 3.3: 1500 kg/m3, disk of radius 2 m and thickness 0.1 m, rods as cylinders of radius "
    "0.1 m; initial state projected onto the constraints",
    {.rotor =
         R"json("mass": 1884.9555921538758, "inertia": [1884.9555921538758, 1884.9555921538758, 3769.9111843077517])json",
     .link_2 =
         R"json("mass": 574.9114556069321, "inertia": [7130.818421044648, 2.874557278034661, 7130.818421044648])json",
     .link_3 =
         R"json("mass": 348.7167845484671, "inertia": [1591.3109268228384, 1.7435839227423355, 1591.3109268228384])json"}));

}  // namespace

}  // namespace hilda::studies
