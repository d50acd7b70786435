// SPDX-License-Identifier: GPL-3.0-or-later
/// Stiff flyball governor: a shaft with a slider and two rods with point masses. Stiff spring-dampers take
/// the place of the coupler rods. Benchmark A05 of the library of González, Dopico, González and Cuadrado
/// (2006).
///
/// The y axis is vertical. The rods hang at 30 degrees below the horizontal from two hinges on the shaft, 0.1
/// m apart, and the springs connect their middles with the sides of the slider. All bodies rotate at 2 π
/// rad/s.

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "studies/framework/problem.hpp"
#include "studies/problems/components.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace hilda::studies {
namespace {

using lie::Mat3;
using lie::Vec3;

/// A rod with its point mass; the x axis of the body points from the hinge to the point mass.
struct Rod {
    double mass = 0, centre = 0;  ///< [kg]; [m] from the hinge
    Vec3 J_bar = Vec3::Zero();

    /// A prism of 1 m and section 0.01 m, 3000 kg/m³, and a point mass of 5 kg at its end
    Rod()
    {
        constexpr double bar = 0.3, point = 5, width = 0.01;
        mass = bar + point;
        centre = (bar * 0.5 + point) / mass;
        const double across = bar * (1 + width * width) / 12 + bar * (centre - 0.5) * (centre - 0.5) +
                              point * (1 - centre) * (1 - centre);
        J_bar = {bar * width * width / 6, across, across};
    }
};

std::string governor_model()
{
    constexpr double omega = 2 * std::numbers::pi, alpha = std::numbers::pi / 6, half_width = 0.05;
    const Rod rod;
    std::string rods, hinges, springs;
    for (const auto& [name, side] : {std::pair("rod_1", 1.), std::pair("rod_2", -1.)}) {
        // Rod 2 is rod 1 rotated by π about the shaft.
        const Vec3 x_axis(side * std::cos(alpha), -std::sin(alpha), 0), z_axis(0, 0, side);
        Mat3 A;
        A << x_axis, z_axis.cross(x_axis), z_axis;
        const Vec3 hinge(side * half_width, 1, 0), r = hinge + rod.centre * x_axis;
        rods +=
            fmt::format(R"(,
    {{"name": "{}", "mass": {}, "inertia": {}, "r": {}, "A": [{}, {}, {}],
     "r_dot": {}, "omega": {}}})",
                        name, rod.mass, components(rod.J_bar), components(r), components(A.row(0)),
                        components(A.row(1)), components(A.row(2)), components(Vec3(0, omega, 0).cross(r)),
                        components(A.transpose() * Vec3(0, omega, 0)));
        hinges += fmt::format(R"(,
    {{"name": "hinge of {}", "type": "revolute", "body_i": "shaft", "s_bar_p_i": {}, "axis_bar_i": [0, 0, 1],
     "body_j": "{}", "s_bar_q_j": {}, "axis_bar_j": [0, 0, {}]}})",
                              name, components({side * half_width, 0.5, 0}), name,
                              components({-rod.centre, 0, 0}), side);
        springs += fmt::format(
            R"({}    {{"name": "spring of {}", "type": "spring-damper", "body_i": "slider", "s_bar_p_i": {},
     "body_j": "{}", "s_bar_q_j": {}, "stiffness": 8e5, "damping": 4e4, "free_length": 0.5, "implicit": true}})",
            springs.empty() ? "" : ",\n", name, components({side * half_width, 0, 0}), name,
            components({0.5 - rod.centre, 0, 0}));
    }
    return fmt::format(R"({{
  "hilda_model": 1,
  "name": "flyball_governor",
  "note": "Gonzalez, Dopico, Gonzalez, Cuadrado (2006), A05: prisms of 3000 kg/m3, shaft and rods 1 m x 0.01 m x 0.01 m, slider 0.1 m, point masses of 5 kg at the ends of the rods, which are part of these bodies",
  "gravity": [0, -9.81, 0],
  "end": 10,
  "bodies": [
    {{"name": "shaft", "mass": 0.3, "inertia": [0.0250025, 5e-6, 0.0250025], "r": [0, 0.5, 0], "omega": [0, {0}, 0]}},
    {{"name": "slider", "mass": 3, "inertia": [0.005, 0.005, 0.005], "r": [0, 0.5, 0], "omega": [0, {0}, 0]}}{1}
  ],
  "constraints": [
    {{"name": "bearing", "type": "revolute", "body_i": "ground", "axis_bar_i": [0, 1, 0],
     "body_j": "shaft", "s_bar_q_j": [0, -0.5, 0], "axis_bar_j": [0, 1, 0]}},
    {{"name": "guide", "type": "translational", "body_i": "shaft", "axis_bar_i": [0, 1, 0],
     "body_j": "slider", "axis_bar_j": [0, 1, 0]}}{2}
  ],
  "forces": [
{3}
  ]
}}
)",
                       omega, rods, hinges, springs);
}

const bool registered_flyball_governor = io::Registry<Problem>::add(
    Problem{.name = "flyball_governor",
            .what = "flyball governor with stiff spring-dampers; benchmark A05 of Gonzalez et al. (2006)",
            .model = governor_model(),
            .reference_name = "index-1 equations (GSL rk8pd, 1e-13)",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& t) {
                    return reference::reference_solution(*d.model, d.x, t);
                },
            .observable = {.body = "slider", .component = "ry"}});

}  // namespace
}  // namespace hilda::studies
