// SPDX-License-Identifier: GPL-3.0-or-later
/// Screw joint, and rack and pinion.                                          Haug (1989), Sec. 9.4
#include "dae/constraints/rotation_to_translation.hpp"
#include "dae/joints.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

#include <numbers>

namespace hilda::dae {

namespace {

/// The row with theta = 0 and Phi = 0 in the initial data x. The axes must be parallel and point in the same
/// direction.
Blocks coupled(const char* name, int i, const Vec3& s_bar_i, const Vec3& e_bar, const Vec3& axis_bar_i, int j,
               const Vec3& s_bar_j, const Vec3& axis_bar_j, double rho, const State& x)
{
    const Mat3 A_i = motion(x, i).A, A_j = motion(x, j).A;
    const double cosine = (A_i * unit(axis_bar_i)).dot(A_j * unit(axis_bar_j));
    if (!(cosine > 0.999))
        lie::reject(
            name,
            "the two axes must be parallel at the start and point in the same direction; cosine of their "
            "angle",
            cosine);
    const Perpendicular p(axis_bar_i);
    RotationToTranslation row(i, s_bar_i, e_bar, {p.first, p.second}, j, s_bar_j,
                              A_j.transpose() * (A_i * p.first), rho);
    row.C = row.phi({motion(x, i), motion(x, j), x.t});
    return single_row(std::move(row));
}

}  // namespace

Blocks screw(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
             const Vec3& axis_bar_j, double pitch, const State& x)
{
    Blocks rows = cylindrical(i, s_bar_i, axis_bar_i, j, s_bar_j, axis_bar_j);
    for (auto& row : coupled("screw joint", i, s_bar_i, unit(axis_bar_i), axis_bar_i, j, s_bar_j, axis_bar_j,
                             pitch / (2 * std::numbers::pi), x))
        rows.push_back(std::move(row));
    return rows;
}

Blocks rack_and_pinion(int i, const Vec3& s_bar_i, const Vec3& direction_bar_i, const Vec3& axis_bar_i, int j,
                       const Vec3& s_bar_j, const Vec3& axis_bar_j, double radius, const State& x)
{
    const double cosine = unit(direction_bar_i).dot(unit(axis_bar_i));
    if (!(std::abs(cosine) < 1e-6))
        lie::reject(
            "rack and pinion",
            "the direction of the rack must be perpendicular to the axis of the pinion; cosine of their "
            "angle",
            cosine);
    return coupled("rack and pinion", i, s_bar_i, unit(direction_bar_i), axis_bar_i, j, s_bar_j, axis_bar_j,
                   radius, x);
}

namespace {

const TypeSchema screw_schema = {
    .description =
        "Screw joint, 5 rows: the axis through P and the axis through Q are collinear, and body j moves "
        "along the axis by the pitch for each turn relative to body i. The angle is counted through "
        "whole turns. One step must turn the screw by less than half a turn.",
    .examples = {R"("body_i": "ground", "body_j": "nut", "axis_bar_i": [0, 0, 1], )"
                 R"("axis_bar_j": [0, 0, 1], "pitch": 0.01)"}};

const bool screw_registered = io::Registry<ConstraintType>::add(
    {.name = "screw",
     .schema = screw_schema,
     .read = [](ObjectReader& o, int i, int j, const State& x) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         return screw(
             i, s.i, axis.i, j, s.j, axis.j,
             o.number("pitch", {"Displacement for one turn [m], positive for a right-handed screw.", "0.01"}),
             x);
     }});

const TypeSchema rack_schema = {
    .description =
        "Rack and pinion, one row: the pinion (body j, centre Q) rolls without slip on the rack (body i). "
        "A rotation of the pinion relative to the rack, positive about the axis, moves Q along "
        "direction_bar_i by the radius times the angle. Add joints that guide rack and pinion. The angle "
        "is counted through whole turns. One step must rotate the pinion by less than half a turn.",
    .examples = {R"("body_i": "rack", "body_j": "pinion", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0], )"
                 R"("direction_bar_i": [0, 1, 0], "radius": 0.05)"}};

const bool rack_registered = io::Registry<ConstraintType>::add(
    {.name = "rack-and-pinion",
     .schema = rack_schema,
     .read = [](ObjectReader& o, int i, int j, const State& x) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         const Vec3 direction = o.direction(
             "direction_bar_i",
             {"Direction of the rack [-], in the frame of body i, perpendicular to the axis.", "[0, 1, 0]"});
         return rack_and_pinion(i, s.i, direction, axis.i, j, s.j, axis.j,
                                o.positive("radius", {"Pitch radius of the pinion [m].", "0.05"}), x);
     }});

}  // namespace

}  // namespace hilda::dae
