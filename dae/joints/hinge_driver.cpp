// SPDX-License-Identifier: GPL-3.0-or-later
/// Rotational driver.
#include "dae/joints.hpp"

#include "dae/constraints/driven_hinge.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

namespace hilda::dae {

Blocks hinge_driver(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const Driver& g,
                    const State& x)
{
    const Perpendicular p(axis_bar_i);
    const Vec3 axis = motion(x, i).A * unit(axis_bar_i);
    const double c = std::cos(g.f(x.t)), s = std::sin(g.f(x.t));
    const Vec3 towards = motion(x, i).A * (c * p.first + s * p.second);
    // w is perpendicular to the axis of body j, also if the initial data are not exact
    const Vec3 axis_j = motion(x, j).A * unit(axis_bar_j);
    if (!(axis.dot(axis_j) >= 0.9))
        lie::reject("hinge driver",
                    "the two axes must be parallel at the start and point in the same direction; "
                    "cosine of their angle",
                    axis.dot(axis_j));
    const Vec3 w = (towards - axis_j * axis_j.dot(towards)).normalized();
    Blocks blocks;
    add<DrivenHinge>(blocks, i, p.first, p.second, j, motion(x, j).A.transpose() * w, g);
    return blocks;
}

namespace {

const TypeSchema schema_hinge_driver = {
    .description =
        "Rotational driver, one row: body j rotates about the axis of body i by angle(t) - angle(0) "
        "relative to its initial orientation. The angle is counted through whole turns. Use it "
        "together with a joint that makes the axes parallel, such as revolute; the axes must be "
        "parallel at the start and point the same way.",
    .examples = {R"("body_i": "ground", "body_j": "crank", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0], "angle": "2*pi*t")"}};

const bool registered_hinge_driver = io::Registry<ConstraintType>::add(
    {.name = "hinge-driver",
     .schema = schema_hinge_driver,
     .read = [](ObjectReader& o, int i, int j, const State& x) -> ConstraintType::Constraints {
         const Axes axis(o);
         return hinge_driver(
             i, axis.i, j, axis.j,
             read_driver(o, "angle",
                         {"Prescribed angle [rad], positive by the right-hand rule about the axis of body i.",
                          R"("2*pi*t")"}),
             x);
     }});

}  // namespace

}  // namespace hilda::dae
