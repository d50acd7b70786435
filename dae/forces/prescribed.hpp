// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces and torques that are given functions of time.
#pragma once

#include "dae/force.hpp"
#include "dae/function_of_time.hpp"
#include "lie/check.hpp"

#include <array>

namespace hilda::dae {

enum class Frame { global, body };

/// The three components of a force or torque, expressions in t
class PrescribedVector {
public:
    explicit PrescribedVector(const std::array<io::Expression, 3>& c)
        : component{NodeFormula(c[0], 0), NodeFormula(c[1], 0), NodeFormula(c[2], 0)}
    {}

    /// At t, for a run that starts at `start`; see NodeFormula
    Vec3 value(double t, double start) const
    {
        return {component[0].value(t, start), component[1].value(t, start), component[2].value(t, start)};
    }
    const std::string& text(size_t k) const { return component[k].formula.text(); }
    std::vector<io::Expression> functions_of_time() const
    {
        std::vector<io::Expression> all;
        for (const NodeFormula& c : component)
            if (!c.formula.is_constant()) all.push_back(c.formula);
        return all;
    }

private:
    std::array<NodeFormula, 3> component;
};

/// A force F(t) [N] at a point of a body, given by its components in the global or the body frame.
///
/// The constructor throws lie::InvalidInput for the ground.
class PrescribedForce final : public Force {
public:
    int body;
    Vec3 point_bar;  ///< point of application [m], body frame
    Frame frame;
    PrescribedVector components;

    PrescribedForce(int body, const Vec3& point_bar, Frame frame,
                    const std::array<io::Expression, 3>& components)
        : body(body), point_bar(point_bar), frame(frame), components(components)
    {
        if (body < 0) lie::reject("prescribed force", "the body must not be the ground; body number", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 F = components.value(x.t, start_time);
        apply_force(body, frame == Frame::global ? F : Vec3(x.body[body].A * F), point_bar, x, out);
    }

    std::vector<io::Expression> functions_of_time() const override { return components.functions_of_time(); }
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
    PrescribedVector components;

    PrescribedTorque(int body, Frame frame, const std::array<io::Expression, 3>& components)
        : body(body), frame(frame), components(components)
    {
        if (body < 0) lie::reject("prescribed torque", "the body must not be the ground; body number", body);
    }

    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3 n = components.value(x.t, start_time);
        out.n_bar[body] += frame == Frame::body ? n : Vec3(x.body[body].A.transpose() * n);
    }

    std::vector<io::Expression> functions_of_time() const override { return components.functions_of_time(); }
    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::array<int, 2> bodies() const override { return {body, ground}; }
    int last_body() const override { return body; }
};

}  // namespace hilda::dae
