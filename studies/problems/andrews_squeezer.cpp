// SPDX-License-Identifier: GPL-3.0-or-later
/// Andrews' squeezer mechanism: seven bodies in a plane with three closed loops, driven by a constant torque,
/// with one spring and without gravity. Data: Hairer and Wanner, Solving Ordinary Differential Equations II,
/// Sec. VII.7.
///
/// The model is spatial: ten revolute joints with parallel axes. Their redundant rows are detected and
/// dropped at the start.

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "studies/framework/problem.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hilda::studies {
namespace {

struct Point {
    double x = 0, y = 0;
};

Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
Point turned(double angle, Point a)
{
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * a.x - s * a.y, s * a.x + c * a.y};
}

/// A body. Body frame: the frame of the textbook at angle zero, rotated by `angle`, with the origin at the
/// centre of mass
struct Link {
    const char* name;
    double mass, inertia, angle;
    Point r;

    Point in_body(Point global) const { return turned(-angle, global - r); }
};

std::string point(Point p) { return fmt::format("[{}, {}, 0]", p.x, p.y); }

std::string revolute(const std::string& name, const Link& i, const Link& j, Point at)
{
    return fmt::format(
        R"(    {{"name": "{}", "type": "revolute", "body_i": "{}", "s_bar_p_i": {}, "axis_bar_i": [0, 0, 1],
     "body_j": "{}", "s_bar_q_j": {}, "axis_bar_j": [0, 0, 1]}})",
        name, i.name, point(i.in_body(at)), j.name, point(j.in_body(at)));
}

std::string model()
{
    const double beta = -0.0617138900142764496, Theta = 0, gamma = 0.455279819163070380,
                 phi = 0.222668390165885885, delta = 0.487364979543842550, Omega = -0.222668390165885885,
                 epsilon = 1.23054744454982119;
    const double d = 28e-3, da = 115e-4, e = 2e-2, ea = 1421e-5, fa = 1421e-5, rr = 7e-3, ra = 92e-5,
                 sa = 1874e-5, sb = 1043e-5, sc = 18e-3, sd = 2e-2, ta = 2308e-5, tb = 916e-5, u = 4e-2,
                 ua = 1228e-5, ub = 449e-5, zf = 2e-2, zt = 4e-2;
    const Point O{0, 0}, A{-0.06934, -0.00227}, B{-0.03635, 0.03273}, C{0.014, 0.072};

    const Point crank_pin = turned(beta, {rr, 0});
    const Point E = A + turned(delta, {zt, 0}), H = A + turned(epsilon, {0, -u});
    const Point P = crank_pin - turned(beta + Theta, {d, 0});  // common point of K2, K3, K4 and K6
    const Point D = B + turned(gamma, {sd, -sc});

    const Link ground{"ground", 0, 0, 0, O};
    const Link K1{"K1", 0.04325, 2.194e-6, beta, turned(beta, {ra, 0})};
    const Link K2{"K2", 0.00365, 4.410e-7, beta + Theta, crank_pin - turned(beta + Theta, {da, 0})};
    const Link K3{"K3", 0.02373, 5.255e-6, gamma, B + turned(gamma, {sb, -sa})};
    const Link K4{"K4", 0.00706, 5.667e-7, phi + delta, E + turned(phi + delta, {0, -(e - ea)})};
    const Link K5{"K5", 0.07050, 1.169e-5, delta, A + turned(delta, {ta, tb})};
    const Link K6{"K6", 0.00706, 5.667e-7, Omega + epsilon, H + turned(Omega + epsilon, {zf - fa, 0})};
    const Link K7{"K7", 0.05498, 1.912e-5, epsilon, A + turned(epsilon, {-ub, -ua})};

    std::string bodies;
    for (const Link* k : {&K1, &K2, &K3, &K4, &K5, &K6, &K7})
        bodies += fmt::format(
            R"({}    {{"name": "{}", "mass": {}, "inertia": [{}, {}, {}], "r": {}, "axis_angle": [0, 0, 1, {}]}})",
            bodies.empty() ? "" : ",\n", k->name, k->mass, k->inertia, k->inertia, k->inertia, point(k->r),
            k->angle);
    std::string joints;
    for (const std::string& joint :
         {revolute("O", ground, K1, O), revolute("crank", K1, K2, crank_pin), revolute("P-K3", K2, K3, P),
          revolute("B", ground, K3, B), revolute("P-K4", K2, K4, P), revolute("E", K4, K5, E),
          revolute("A-K5", ground, K5, A), revolute("P-K6", K2, K6, P), revolute("H", K6, K7, H),
          revolute("A-K7", ground, K7, A)})
        joints += (joints.empty() ? "" : ",\n") + joint;
    return fmt::format(R"({{
  "hilda_model": 1,
  "name": "andrews_squeezer",
  "note": "Hairer and Wanner, Solving ODEs II, Sec. VII.7; moments of inertia about the axes in the plane set equal to that about the normal",
  "gravity": [0, 0, 0],
  "end": 0.03,
  "bodies": [
{}
  ],
  "constraints": [
{}
  ],
  "forces": [
    {{"name": "drive", "type": "torque", "body": "K1", "frame": "body", "components": [0, 0, 0.033]}},
    {{"name": "spring", "type": "spring-damper", "body_i": "ground", "body_j": "K3", "s_bar_p_i": {}, "s_bar_q_j": {},
     "stiffness": 4530, "free_length": 0.07785}}
  ]
}}
)",
                       bodies, joints, point(C), point(K3.in_body(D)));
}

const bool registered_andrews_squeezer = io::Registry<Problem>::add(
    Problem{.name = "andrews_squeezer",
            .what = "Andrews' squeezer, seven bodies and three loops; Hairer and Wanner II, VII.7",
            .model = model(),
            .reference_name = "index-1 equations (GSL rk8pd, 1e-13)",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& t) {
                    return reference::reference_solution(*d.model, d.x, t);
                },
            .observable = {.body = "K1", .component = "ry"}});

}  // namespace
}  // namespace hilda::studies
