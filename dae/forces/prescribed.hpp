// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces and torques that are given functions of time.
#pragma once

#include "dae/force.hpp"
#include "io/expression.hpp"
#include "lie/check.hpp"

#include <array>

namespace hilda::dae {

enum class Frame { global, body };

/// The vector of three expressions in t
inline Vec3 value_at(const std::array<io::Expression, 3>& components, double t)
{
    return {components[0].value(t), components[1].value(t), components[2].value(t)};
}

/// A force F(t) [N] at a point of a body, given by its components in the global or the body frame.
///
/// The constructor throws lie::InvalidInput for the ground.
class PrescribedForce final : public Force {
public:
    int body;
    Vec3 point_bar;  ///< point of application [m], body frame
    Frame frame;
    std::array<io::Expression, 3> components;  ///< in t

    PrescribedForce(int body, const Vec3& point_bar, Frame frame, std::array<io::Expression, 3> components)
        : body(body), point_bar(point_bar), frame(frame), components(std::move(components))
    {
        if (body < 0) lie::reject("prescribed force", "the body must not be the ground; body number", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 F = value_at(components, x.t);
        apply_force(body, frame == Frame::global ? F : Vec3(x.body[body].A * F), point_bar, x, out);
    }

    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::array<int, 2> bodies() const override { return {body, ground}; }
    int last_body() const override { return body; }
};

/// A torque n(t) [N m] on a body, given by its components in the global or the body frame.
///
/// The constructor throws lie::InvalidInput for the ground.
class PrescribedTorque final : public Force {
public:
    int body;
    Frame frame;
    std::array<io::Expression, 3> components;  ///< in t

    PrescribedTorque(int body, Frame frame, std::array<io::Expression, 3> components)
        : body(body), frame(frame), components(std::move(components))
    {
        if (body < 0) lie::reject("prescribed torque", "the body must not be the ground; body number", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 n = value_at(components, x.t);
        out.n_bar[body] += frame == Frame::body ? n : Vec3(x.body[body].A.transpose() * n);
    }

    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::array<int, 2> bodies() const override { return {body, ground}; }
    int last_body() const override { return body; }
};

}  // namespace hilda::dae
