// SPDX-License-Identifier: GPL-3.0-or-later
/// Bricard's mechanism: five rods and the ground in a closed loop with six revolute joints. Benchmark A04 of
/// the library of González, Dopico, González and Cuadrado (2006).
///
/// The rods of 1 m are edges of a cube at the start, and each joint axis is perpendicular to the two edges
/// that meet there. By Grübler's count the mechanism has no freedom. Its geometry makes one of the 30 rows
/// redundant, which leaves one. The redundant combination of rows changes during the motion: a row that is
/// redundant at the start does not remain so. All rows are therefore kept.

#include "dae/model_file.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "studies/framework/problem.hpp"
#include "studies/problems/components.hpp"

#include <fmt/format.h>

#include <array>

namespace hilda::studies {
namespace {

using lie::Vec3;

std::string bricard_model()
{
    constexpr int rods = 5;
    const std::array<Vec3, rods + 1> corner = {Vec3(0, 0, 0),  Vec3(1, 0, 0),  Vec3(1, -1, 0),
                                               Vec3(1, -1, 1), Vec3(0, -1, 1), Vec3(0, 0, 1)};
    const std::array<Vec3, 3> axis = {Vec3::UnitY(), Vec3::UnitZ(),
                                      Vec3::UnitX()};  // of three joints in turn
    const auto middle = [&](int k) -> Vec3 { return 0.5 * (corner[k] + corner[k + 1]); };

    std::string bodies, joints;
    for (int k = 0; k < rods; ++k) {
        const Vec3 along = corner[k + 1] - corner[k];
        Vec3 J;
        for (int c = 0; c < 3; ++c) J[c] = along[c] != 0 ? 0.01 / 6 : 1.01 / 12;
        bodies += fmt::format(R"({}    {{"name": "rod_{}", "mass": 1, "inertia": {}, "r": {}}})",
                              k == 0 ? "" : ",\n", k + 1, components(J), components(middle(k)));
    }
    for (int k = 0; k <= rods; ++k) {
        const std::string i = k == 0 ? "ground" : fmt::format("rod_{}", k),
                          j = k == rods ? "ground" : fmt::format("rod_{}", k + 1);
        const Vec3 at_i = k == 0 ? corner[k] : corner[k] - middle(k - 1),
                   at_j = k == rods ? corner[k] : corner[k] - middle(k);
        joints += fmt::format(
            R"({}    {{"name": "joint_{}", "type": "revolute", "body_i": "{}", "s_bar_p_i": {}, "axis_bar_i": {},
     "body_j": "{}", "s_bar_q_j": {}, "axis_bar_j": {}}})",
            k == 0 ? "" : ",\n", k + 1, i, components(at_i), components(axis[k % 3]), j, components(at_j),
            components(axis[k % 3]));
    }
    return fmt::format(R"({{
  "hilda_model": 1,
  "name": "bricard",
  "note": "Gonzalez, Dopico, Gonzalez, Cuadrado (2006), A04: rods of 1 m and 1 kg, section 0.1 m, along edges of a cube, at rest; body frames parallel to the global frame",
  "gravity": [0, -9.81, 0],
  "end": 10,
  "redundant": "keep",
  "bodies": [
{}
  ],
  "constraints": [
{}
  ]
}}
)",
                       bodies, joints);
}

const bool registered_bricard = io::Registry<Problem>::add(
    Problem{.name = "bricard",
            .what = "Bricard's mechanism, five rods and six revolute joints, one redundant row that changes; "
                    "benchmark A04 of Gonzalez et al. (2006)",
            .model = bricard_model(),
            .reference_name = "index-1 equations with all rows (GSL rk8pd, 1e-13)",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& t) {
                    return reference::reference_solution(*d.model, d.x, t);
                },
            .observable = {.body = "rod_3", .component = "ry"}});

}  // namespace
}  // namespace hilda::studies
