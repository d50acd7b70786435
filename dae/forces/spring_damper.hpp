// SPDX-License-Identifier: GPL-3.0-or-later
/// Translational spring-damper-actuator.
#pragma once

#include "dae/force.hpp"
#include "dae/function_of_time.hpp"
#include "lie/check.hpp"

#include <optional>
#include <utility>

namespace hilda::dae {

/// Spring, damper and actuator between point P of body i and point Q of body j:
///
///     f = k (l - l_0) + c ldot + F(l, ldot, t)   [N]                            Haug (1989), Sec. 11.2
///
/// l = |d_ij| is the distance of the points and ldot its rate. f acts along d_ij; a positive f pulls the
/// bodies together.
///
/// add() throws lie::NonFinite if the two points coincide, because the direction of the force is then
/// undefined.
class SpringDamper final : public Force {
public:
    int i, j;
    Vec3 s_bar_i, s_bar_j;
    double stiffness = 0, damping = 0, free_length = 0;  ///< k [N/m], c [N s/m], l_0 [m]
    std::optional<NodeFormula> law;                      ///< F in the variables l, ldot, t

    /// `F` is an expression in the variables l, ldot, t.
    SpringDamper(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, double stiffness, double damping,
                 double free_length, const std::optional<io::Expression>& F = {})
        : i(i), j(j), s_bar_i(s_bar_i), s_bar_j(s_bar_j), stiffness(stiffness), damping(damping),
          free_length(free_length)
    {
        if (F) set_law(*F);
    }
    void set_law(const io::Expression& F);

    void add(const State& x, lie::Loads& out) const override
    {
        const Stretch at = stretch(x);
        apply_force(i, at.f * at.along, s_bar_i, x, out);
        apply_force(j, -at.f * at.along, s_bar_j, x, out);
    }

    /// k (l - l_0)²/2: the linear spring only
    double potential_energy(const State& x) const override
    {
        const double extension = distance(x).norm() - free_length;
        return 0.5 * stiffness * extension * extension;
    }
    bool may_be_implicit() const override { return true; }
    bool is_passive() const override { return damping >= 0 && !law; }
    bool is_dissipative() const override { return damping != 0 || law; }

    int switches() const override { return static_cast<int>(switching_functions.size()); }
    void switching(const State& x, double* out) const override;
    std::vector<io::Expression> functions_of_time() const override;

    std::vector<Quantity> quantities() const override
    {
        return {{"length", "m", "distance of the two points"},
                {"rate", "m/s", "rate of the distance, positive while it grows"},
                {"force", "N",
                 "force of the spring, damper and actuator, positive if it pulls the bodies together"}};
    }
    void values(const State& x, double* out) const override
    {
        const Stretch at = stretch(x);
        out[0] = at.l, out[1] = at.ldot, out[2] = at.f;
    }

    /// Along the line from P to Q, with the derivatives of F in the state x. None while the points coincide.
    int max_spring_rows() const override { return 1; }
    int spring_rows(const State& x, SpringRow* out) const override;
    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }
    int last_body() const override { return std::max(i, j); }

private:
    /// d_ij from P to Q, global frame [m]
    Vec3 distance(const State& x) const
    {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        return bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i;
    }
    struct Stretch {
        Vec3 along;         ///< unit vector from P to Q, global frame
        double l, ldot, f;  ///< [m], [m/s], [N]
    };
    /// ∂f/∂l and ∂f/∂ldot; those of F by differences on the side of `at`
    std::pair<double, double> coefficients(const Stretch& at, double t) const;
    Stretch stretch(const State& x) const
    {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        const Vec3 d = distance(x), ddot = velocity_at(bj, bj.A * s_bar_j) - velocity_at(bi, bi.A * s_bar_i);
        const double l = d.norm();
        if (!(l > 0))
            throw lie::NonFinite(
                "force '" + name +
                "': the two points of the spring coincide, so that its force has no direction");
        const Vec3 along = d / l;
        const double ldot = along.dot(ddot);
        double f = stiffness * (l - free_length) + damping * ldot;
        if (law) {
            const double variables[] = {l, ldot, x.t};
            f += law->value(variables, start_time);
        }
        return {along, l, ldot, f};
    }

    std::vector<io::Expression> switching_functions;  ///< of the law, in l, ldot, t
};

}  // namespace hilda::dae
