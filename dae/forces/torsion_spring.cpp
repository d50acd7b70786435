// SPDX-License-Identifier: GPL-3.0-or-later
/// Type torsion-spring of the model file.
#include "dae/forces/torsion_spring.hpp"

#include "dae/model_types.hpp"

namespace hilda::dae {

namespace {

const TypeSchema schema_torsion_spring = {
    .description =
        "Torsional spring and damper about the common axis of two bodies. The torque k (theta - "
        "theta_0) + c thetadot acts on body i about the axis, the opposite torque on body j. theta "
        "is the rotation of body j relative to body i since the start, counted through whole turns. "
        "One step must rotate the bodies by less than three eighths of a turn.",
    .examples = {R"("body_i": "ground", "body_j": "crank", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0], "stiffness": 5, )"
                 R"("free_angle": 0)"}};

const bool registered_torsion_spring = io::Registry<ForceType>::add(
    {.name = "torsion-spring",
     .schema = schema_torsion_spring,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State& x) -> std::unique_ptr<Force> {
         const auto [i, j] = bodies.pair(o);
         const Axes axis(o);
         const double k = o.not_negative("stiffness", {"Stiffness k [N m/rad].", "5"}),
                      c = o.not_negative("damping", {"Damping coefficient c [N m s/rad].", "0.1"}, 0);
         return std::make_unique<TorsionSpring>(
             i, axis.i, j, axis.j, k, c,
             o.number("free_angle",
                      {"Free angle theta_0 [rad], measured from the initial orientation.", "0"}),
             x);
     }});

}  // namespace

}  // namespace hilda::dae
