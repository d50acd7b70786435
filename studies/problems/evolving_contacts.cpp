// SPDX-License-Identifier: GPL-3.0-or-later
/// Models with contact constraints, whose contact points are unknowns: a ball in a bowl (Fang 2022, Sec.
/// 5.5), a rocking and a wobbling ellipsoid, a rattleback.

#include "studies/framework/problem.hpp"
#include "studies/problems/evolving_reference.hpp"

namespace hilda::studies {

namespace {

/// The ball of Fang (2022), Sec. 5.5, released from rest in an ellipsoidal bowl with semi-axes 4, 3 and 2 m
struct BallInBowl {
    std::string name, what, contact_point, r, friction = {}, note = {};
};

bool register_problem(const BallInBowl& ball)
{
    const std::string friction = ball.friction.empty() ? "" : R"(,
      "friction": )" + ball.friction;
    return io::Registry<Problem>::add({.name = ball.name,
                                       .what = ball.what,
                                       .model = R"({"hilda_model": 1, "name": ")" + ball.name + R"(",
  "note": "bowl with semi-axes 4, 3 and 2 m; ball released at the contact point )" +
                                                ball.contact_point + ball.note + R"(",
  "gravity": [0, 0, -9.81], "end": 10,
  "bodies": [
    {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [)" +
                                                ball.r + R"(]}
  ],
  "contacts": [
    {"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
      "surface_i": {"type": "sphere", "radius": 0.5},
      "surface_j": {"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true},
      "normal": {"type": "constraint"})" + friction +
                                                R"(}
  ]
}
)",
                                       .reference_name = evolving_reference_name,
                                       .reference_solution = evolving_reference,
                                       .observable = {.body = "ball", .component = "ry"}});
}

const std::string planar_point = "0, 1.5, -1.7321", planar_r = "0, 1.320394697973225, -1.265422544940186",
                  xy_point = "1, 1.5, -1.6583",
                  xy_r = "0.9307364355190585, 1.315297161384156, -1.1988698851259592",
                  rolling = R"({"law": "rolling"})";

const bool planar = register_problem(
    {.name = "ball_in_bowl",
     .what = "ball released in an ellipsoidal bowl, planar motion without friction (Fang 2022, Sec. 5.5.1)",
     .contact_point = planar_point,
     .r = planar_r});

const bool xy = register_problem(
    {.name = "ball_in_bowl_xy",
     .what = "ball released in the same bowl, spatial motion without friction (Fang 2022, Sec. 5.5.1)",
     .contact_point = xy_point,
     .r = xy_r});

const bool rolling_planar =
    register_problem({.name = "rolling_ball_in_bowl",
                      .what = "ball that rolls without slip in the bowl of ball_in_bowl",
                      .contact_point = planar_point,
                      .r = planar_r,
                      .friction = rolling});

const bool rolling_xy =
    register_problem({.name = "rolling_ball_in_bowl_xy",
                      .what = "ball that rolls without slip, and spins, in the bowl of ball_in_bowl_xy",
                      .contact_point = xy_point,
                      .r = xy_r,
                      .friction = rolling});

const bool braked = register_problem(
    {.name = "braked_ball_in_bowl",
     .what = "ball that rolls in the same bowl with sliding and rolling friction, and stops (Fang 2022, Sec. "
             "5.5.2)",
     .contact_point = planar_point,
     .r = planar_r,
     .friction =
         R"({"law": "slide-roll-spin", "mu_s": 0.25, "mu_k": 0.2, "K_E": 1e4, "D_slide": 100, "eta_r": 0.1, )"
         R"("start": "unstretched"})",
     .note = "; Table 5.1, homogeneous; stable for steps up to 3.26e-3 s, without eta_r up to 4.64e-3 s"});

/// An ellipsoid on the plane z = 0
struct OnTheFloor {
    std::string name, what, note, end, body, body_keys, semi_axes, observable, friction = {};
};

bool register_problem(const OnTheFloor& e)
{
    const std::string friction = e.friction.empty() ? "" : R"(, "friction": )" + e.friction;
    return io::Registry<Problem>::add({.name = e.name,
                                       .what = e.what,
                                       .model = R"({"hilda_model": 1, "name": ")" + e.name + R"(",
  "note": ")" + e.note + R"(",
  "gravity": [0, 0, -9.81], "end": )" + e.end + R"(,
  "bodies": [
    {"name": ")" + e.body + R"(", )" + e.body_keys +
                                                R"(}
  ],
  "contacts": [
    {"name": ")" + e.body + R"(-floor", "body_i": ")" +
                                                e.body + R"(", "body_j": "ground",
      "surface_i": {"type": "ellipsoid", "semi_axes": )" +
                                                e.semi_axes + R"(}, "surface_j": {"type": "plane"},
      "normal": {"type": "constraint"})" + friction +
                                                R"(}
  ]
}
)",
                                       .reference_name = evolving_reference_name,
                                       .reference_solution = evolving_reference,
                                       .observable = {.body = e.body, .component = e.observable}});
}

const bool rocking = register_problem(
    {.name = "rocking_ellipsoid",
     .what = "ellipsoid that rocks on a frictionless floor, with a period of 0.7120300728 s",
     .note = "homogeneous, semi-axes 0.3, 0.25 and 0.15 m, released at an inclination of 0.6 rad",
     .end = "2",
     .body = "ellipsoid",
     .body_keys = R"("mass": 2, "inertia": [0.034, 0.045, 0.061], "r": [0, 0, 0.187757409735186],
      "axis_angle": [1, 0, 0, 0.6])",
     .semi_axes = "[0.3, 0.25, 0.15]",
     .observable = "rz"});

const bool wobbling = register_problem(
    {.name = "wobbling_ellipsoid",
     .what = "ellipsoid that spins, wobbles and drifts on a frictionless floor",
     .note = "homogeneous, semi-axes 0.3, 0.25 and 0.15 m; horizontal momentum and vertical angular momentum "
             "are conserved",
     .end = "2",
     .body = "ellipsoid",
     .body_keys = R"("mass": 2, "inertia": [0.034, 0.045, 0.061], "r": [0, 0, 0.1909334496674758],
      "p": [0.9565680814220291, 0.2463700839976002, 0.1478220503985601, 0.04927401679952004],
      "r_dot": [0.3, 0, 0.16523035228314287], "omega": [1, 2, 4])",
     .semi_axes = "[0.3, 0.25, 0.15]",
     .observable = "rz"});

const bool rattle = register_problem(
    {.name = "rattleback",
     .what = "celt that rolls without slip: its spin becomes a rattling motion and reverses",
     .note = "semi-axes 0.2, 0.05 and 0.04 m; the principal axes of inertia are rotated by 0.1 "
             "rad about z; initially tilted by 0.011 rad",
     .end = "4",
     .body = "celt",
     .body_keys = R"("mass": 1,
      "inertia": [[0.000894750333095344, -0.0007450099904814797, 0],
                  [-0.0007450099904814797, 0.008245249666904658, 0], [0, 0, 0.0085]],
      "r": [0, 0, 0.04004825013736783], "p": [0.9999843750406902, 0.002499986979187012, 0.004999973958374024, 0],
      "r_dot": [0.000937053248201022, 0.02996288062474045, 0.00014044972276224167], "omega": [0, 0, -3])",
     .semi_axes = "[0.2, 0.05, 0.04]",
     .observable = "wz",
     .friction = rolling});

}  // namespace

}  // namespace hilda::studies
