// SPDX-License-Identifier: GPL-3.0-or-later
/// Types force and torque of the model file.
#include "dae/forces/prescribed.hpp"

#include "dae/model_types.hpp"

#include <cmath>

namespace hilda::dae {

bool PrescribedForce::load_derivatives(const State& x, LoadDerivatives& out) const
{
    out.setZero();
    const Mat3& A = x.body[body].A;
    const Vec3 F = components.value(x.t, start_time);
    if (frame == Frame::global)
        out.block<3, 3>(3, 3) = lie::tilde(point_bar) * lie::tilde(A.transpose() * F);
    else
        out.block<3, 3>(0, 3) = -A * lie::tilde(F);
    return true;
}

bool PrescribedTorque::load_derivatives(const State& x, LoadDerivatives& out) const
{
    out.setZero();
    if (frame == Frame::global)
        out.block<3, 3>(3, 3) = lie::tilde(x.body[body].A.transpose() * components.value(x.t, start_time));
    return true;
}

namespace {

/// The body on which a prescribed force acts
int movable_body(ObjectReader& o, const BodyFinder& bodies, const std::string& type)
{
    const int b = bodies.body(o, "body",
                              {"Body on which it acts. It must not be the ground.", R"("slider")",
                               R"("not": {"const": "ground"})"});
    if (b == ground) o.fail("body", "a " + type + " must act on a movable body, got 'ground'");
    return b;
}

Frame frame(ObjectReader& o)
{
    return o.one_of("frame", {"global", "body"},
                    {"Frame of the components: the global frame or the frame of the body.", R"("global")"}) ==
                   "global"
               ? Frame::global
               : Frame::body;
}

/// Components of a force or torque, finite at t = 0
std::array<io::Expression, 3> components(ObjectReader& o, const About& about)
{
    std::array<io::Expression, 3> all = o.expressions("components", about);
    for (size_t k = 0; k < 3; ++k)
        if (const double value = all[k].value(0); !std::isfinite(value))
            o.fail("components", k,
                   "a component must be finite at t = 0, got " + described(all[k].text()) + " with " +
                       shortest(value));
    return all;
}

const TypeSchema schema_force = {
    .description = "Prescribed force on a point of a body.",
    .examples = {R"-("body": "slider", "frame": "global", "components": [0, "10*sin(t)", 0])-"}};

const bool registered_force = io::Registry<ForceType>::add(
    {.name = "force",
     .schema = schema_force,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&) -> std::unique_ptr<Force> {
         const int b = movable_body(o, bodies, "force");
         const Vec3 point_bar = o.vec3(
             "point_bar",
             {"Point of application relative to the centre of mass [m], in the body frame.", "[0, 0.1, 0]"},
             Vec3::Zero());
         const Frame f = frame(o);
         return std::make_unique<PrescribedForce>(
             b, point_bar, f,
             components(o, {"Components of the force [N], in the frame given by the key frame.",
                            R"-([0, "10*sin(t)", 0])-"}));
     }});

const TypeSchema schema_torque = {
    .description = "Prescribed torque on a body.",
    .examples = {R"("body": "crank", "frame": "body", "components": [0.5, 0, 0])"}};

const bool registered_torque = io::Registry<ForceType>::add(
    {.name = "torque",
     .schema = schema_torque,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&) -> std::unique_ptr<Force> {
         const int b = movable_body(o, bodies, "torque");
         const Frame f = frame(o);
         return std::make_unique<PrescribedTorque>(
             b, f,
             components(o, {"Components of the torque [N m], in the frame given by the key frame.",
                            R"-([0, 0, "0.5*cos(t)"])-"}));
     }});

}  // namespace

}  // namespace hilda::dae
