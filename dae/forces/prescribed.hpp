// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dae/expression.hpp"
#include "dae/force.hpp"
#include "lie/check.hpp"

#include <array>

namespace hilda::dae {

enum class Frame { global, body };

/// A constant or prescribed force F(t) [N] on a point of a body, its components in the global or the body
/// frame.
class PrescribedForce final : public Force {
public:
    int body;
    Vec3 point_bar;
    Frame frame;
    std::array<Expression, 3> components;  ///< in t

    PrescribedForce(int body, const Vec3& point_bar, Frame frame, std::array<Expression, 3> components)
        : body(body), point_bar(point_bar), frame(frame), components(std::move(components))
    {
        if (body < 0) lie::reject("prescribed force", "it must act on a body, not on the ground", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 F(components[0].value(x.t), components[1].value(x.t), components[2].value(x.t));
        push(body, frame == Frame::global ? F : Vec3(x.body[body].A * F), point_bar, x, out);
    }

    std::array<int, 2> bodies() const override { return {body, ground}; }
    int last_body() const override { return body; }
};

/// A constant or prescribed torque n(t) [N m] on a body, its components in the global or the body frame.
class PrescribedTorque final : public Force {
public:
    int body;
    Frame frame;
    std::array<Expression, 3> components;  ///< in t

    PrescribedTorque(int body, Frame frame, std::array<Expression, 3> components)
        : body(body), frame(frame), components(std::move(components))
    {
        if (body < 0) lie::reject("prescribed torque", "it must act on a body, not on the ground", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 n(components[0].value(x.t), components[1].value(x.t), components[2].value(x.t));
        out.n_bar[body] += frame == Frame::body ? n : Vec3(x.body[body].A.transpose() * n);
    }

    std::array<int, 2> bodies() const override { return {body, ground}; }
    int last_body() const override { return body; }
};

}  // namespace hilda::dae
