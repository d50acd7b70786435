// SPDX-License-Identifier: GPL-3.0-or-later
/// Contacts that are constraints, with the contact points as unknowns: a ball in a bowl (Fang 2022, Sec. 5.5.1), an
/// ellipsoid that rocks, one that wobbles, a rattleback.

#include "studies/evolving_truth.hpp"
#include "studies/problem.hpp"

namespace hilda::studies {

namespace {

const bool planar = enrol(
    {.name = "ball_in_bowl",
     .what = "ball let go in an ellipsoidal bowl, swings in a plane without friction (Fang 2022, Sec. 5.5.1)",
     .model = R"({"hilda_model": 1, "name": "ball_in_bowl",
  "note": "semi-axes 4, 3 and 2 m, seen from inside; let go at the contact point 0, 1.5, -1.7321",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 1.320394697973225, -1.265422544940186]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"}}
  ]
}
)",
     .truth_name = evolving_truth_name,
     .truth = evolving_truth,
     .watched = {.body = "ball", .component = "ry"}});

const bool xy =
    enrol({.name = "ball_in_bowl_xy",
           .what = "ball let go in the same bowl where it leaves the plane (Fang 2022, Sec. 5.5.1)",
           .model = R"({"hilda_model": 1, "name": "ball_in_bowl_xy",
  "note": "semi-axes 4, 3 and 2 m, seen from inside; let go at the contact point 1, 1.5, -1.6583",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0.9307364355190585, 1.315297161384156, -1.1988698851259592]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"}}
  ]
}
)",
           .truth_name = evolving_truth_name,
           .truth = evolving_truth,
           .watched = {.body = "ball", .component = "ry"}});

const bool rolling = enrol({.name = "rolling_ball_in_bowl",
                            .what = "ball that rolls in the bowl of ball_in_bowl without slipping",
                            .model = R"({"hilda_model": 1, "name": "rolling_ball_in_bowl",
  "note": "semi-axes 4, 3 and 2 m, seen from inside; let go at the contact point 0, 1.5, -1.7321",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 1.320394697973225, -1.265422544940186]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"}, "friction": {"law": "rolling"}}
  ]
}
)",
                            .truth_name = evolving_truth_name,
                            .truth = evolving_truth,
                            .watched = {.body = "ball", .component = "ry"}});

const bool rolling_xy = enrol({.name = "rolling_ball_in_bowl_xy",
                               .what = "ball that rolls in the bowl of ball_in_bowl_xy, and pivots",
                               .model = R"({"hilda_model": 1, "name": "rolling_ball_in_bowl_xy",
  "note": "semi-axes 4, 3 and 2 m, seen from inside; let go at the contact point 1, 1.5, -1.6583",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0.9307364355190585, 1.315297161384156, -1.1988698851259592]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"}, "friction": {"law": "rolling"}}
  ]
}
)",
                               .truth_name = evolving_truth_name,
                               .truth = evolving_truth,
                               .watched = {.body = "ball", .component = "ry"}});

const bool braked =
    enrol({.name = "braked_ball_in_bowl",
           .what = "ball that rolls in the same bowl by friction, and comes to rest (Fang 2022, Sec. 5.5.2)",
           .model = R"({"hilda_model": 1, "name": "braked_ball_in_bowl",
  "note": "Table 5.1; homogeneous; let go at the contact point 0, 1.5, -1.7321; stands steps up to 3.26e-3 s, without eta_r 4.64e-3 s",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 1.320394697973225, -1.265422544940186]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"},
      "friction": {"law": "slide-roll-spin", "mu_s": 0.25, "mu_k": 0.2, "K_E": 1e4, "D_slide": 100, "eta_r": 0.1}}
  ]
}
)",
           .truth_name = evolving_truth_name,
           .truth = evolving_truth,
           .watched = {.body = "ball", .component = "ry"}});

const bool rocking = enrol({.name = "rocking_ellipsoid",
                            .what = "ellipsoid that rocks on a smooth floor, with a period of 0.7120300728 s",
                            .model = R"({"hilda_model": 1, "name": "rocking_ellipsoid",
  "note": "homogeneous, semi-axes 0.3, 0.25 and 0.15 m, let go 0.6 rad from upright",
  "gravity": [0, 0, -9.81], "end": 2,
  "bodies": [
    {"name": "ellipsoid", "mass": 2, "inertia": [0.034, 0.045, 0.061], "r": [0, 0, 0.187757409735186],
      "axis_angle": [1, 0, 0, 0.6]}
  ],
  "contacts": [
    {"name": "ellipsoid-floor", "body_i": "ellipsoid", "body_j": "ground",
      "surface_i": {"type": "ellipsoid", "semi_axes": [0.3, 0.25, 0.15]}, "surface_j": {"type": "plane"},
      "normal": {"type": "constraint"}}
  ]
}
)",
                            .truth_name = evolving_truth_name,
                            .truth = evolving_truth,
                            .watched = {.body = "ellipsoid", .component = "rz"}});

const bool wobbling = enrol({.name = "wobbling_ellipsoid",
                             .what = "ellipsoid that spins, wobbles and drifts on a smooth floor",
                             .model = R"({"hilda_model": 1, "name": "wobbling_ellipsoid",
  "note": "homogeneous, semi-axes 0.3, 0.25 and 0.15 m; momentum along the floor and about the vertical stays",
  "gravity": [0, 0, -9.81], "end": 2,
  "bodies": [
    {"name": "ellipsoid", "mass": 2, "inertia": [0.034, 0.045, 0.061], "r": [0, 0, 0.1909334496674758],
      "p": [0.95656808142202909, 0.24637008399760019, 0.14782205039856011, 0.049274016799520037],
      "r_dot": [0.3, 0, 0.16523035228314287], "omega": [1, 2, 4]}
  ],
  "contacts": [
    {"name": "ellipsoid-floor", "body_i": "ellipsoid", "body_j": "ground",
      "surface_i": {"type": "ellipsoid", "semi_axes": [0.3, 0.25, 0.15]}, "surface_j": {"type": "plane"},
      "normal": {"type": "constraint"}}
  ]
}
)",
                             .truth_name = evolving_truth_name,
                             .truth = evolving_truth,
                             .watched = {.body = "ellipsoid", .component = "rz"}});

const bool rattle = enrol({.name = "rattleback",
                           .what = "celt that rolls: spun one way it begins to rattle and turns round",
                           .model = R"({"hilda_model": 1, "name": "rattleback",
  "note": "semi-axes 0.2, 0.05 and 0.04 m; the axes of inertia are turned by 0.1 rad about z; tilted by 0.011 rad",
  "gravity": [0, 0, -9.81], "end": 4,
  "bodies": [
    {"name": "celt", "mass": 1,
      "inertia": [[0.000894750333095344, -0.0007450099904814797, 0],
                  [-0.0007450099904814797, 0.008245249666904658, 0], [0, 0, 0.0085]],
      "r": [0, 0, 0.040048250137367833], "p": [0.99998437504069015, 0.0024999869791870119, 0.0049999739583740238, 0],
      "r_dot": [0.00093705324820102199, 0.029962880624740451, 0.00014044972276224167], "omega": [0, 0, -3]}
  ],
  "contacts": [
    {"name": "celt-floor", "body_i": "celt", "body_j": "ground",
      "surface_i": {"type": "ellipsoid", "semi_axes": [0.2, 0.05, 0.04]}, "surface_j": {"type": "plane"},
      "normal": {"type": "constraint"}, "friction": {"law": "rolling"}}
  ]
}
)",
                           .truth_name = evolving_truth_name,
                           .truth = evolving_truth,
                           .watched = {.body = "celt", .component = "wz"}});

}  // namespace

}  // namespace hilda::studies
