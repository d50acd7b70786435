// SPDX-License-Identifier: GPL-3.0-or-later
/// The inertia of the bodies of a system, the applied loads and their variation.

#pragma once

#include "lie/state.hpp"

#include <vector>

namespace hilda::lie {

/// Evaluation of loads that depend on positions and velocities. It sets the step up to which stiff springs
/// and dampers are stable.
enum class LoadEvaluation {
    at_step,       ///< explicit, with velocities that a step has computed
    extrapolated,  ///< explicit with extrapolated velocities, or an iteration without load derivatives
    implicit       ///< the Newton matrix contains the derivatives of the loads
};

/// Factor of the damping in the stability limit of a step: 2 for extrapolated velocities
constexpr double damping_factor(LoadEvaluation evaluation)
{
    return evaluation == LoadEvaluation::extrapolated ? 2 : 1;
}

/// Inertia of all bodies. It is constant.
struct Mass {
    std::vector<double> m;    ///< [kg], positive
    std::vector<Mat3> J_bar;  ///< [kg m²], body frame, about the centre of mass; symmetric positive definite
};

/// Applied loads on all bodies.
struct Loads {
    std::vector<Vec3> F;      ///< [N], global frame, at the centre of mass
    std::vector<Vec3> n_bar;  ///< [N m], body frame, without the gyroscopic term

    explicit Loads(int bodies) : F(bodies, Vec3::Zero()), n_bar(bodies, Vec3::Zero()) {}
    /// τ̄ = n̄ - ω̄ × J̄ ω̄ of body i                                                                 Eq.
    /// 2.13c
    Vec3 tau_bar(int i, const Mat3& J_bar, const Vec3& omega_bar) const
    {
        return n_bar[i] - omega_bar.cross(J_bar * omega_bar);
    }
    void set_zero()
    {
        for (Vec3& f : F) f.setZero();
        for (Vec3& n : n_bar) n.setZero();
    }
};

/// The variation of the loads: block d = ∂(F, n̄ of body `on`)/∂(δr, δθ̄, δṙ, δω̄ of body `by`)
struct LoadVariation {
    struct Block {
        int on = 0, by = 0;
        Eigen::Matrix<double, 6, 12> d = Eigen::Matrix<double, 6, 12>::Zero();
    };
    std::vector<Block> block;

    // workspace for implementations by finite differences
    State x;
    Loads plus{0}, minus{0};
};

}  // namespace hilda::lie
