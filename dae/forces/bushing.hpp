// SPDX-License-Identifier: GPL-3.0-or-later
/// Bushing: a spring and damper with six components between two bodies.
#pragma once

#include "dae/force.hpp"

#include <algorithm>

namespace hilda::dae {

/// Linear spring and damper between point P of body i and point Q of body j, and between their orientations:
///
///     F = -A_i (K d + C ddot)     on body j at Q; -F on body i at the same point             [N]
///     n = -J_r(psi)^-T (K_r psi + C_r psidot)     on body j, in its frame; -n on body i       [N m]
///
/// d is the vector from P to Q in the frame of body i, and psi the rotation vector of A_j relative to A_i
/// since the start, exp(psi~) = R_0^T A_i^T A_j. The forces and torques of the springs are derivatives of the
/// potential (d^T K d + psi^T K_r psi)/2. add() throws lie::NumericalFailure "bushing_turned" for |psi| of 3
/// rad and more.
class Bushing final : public Force {
public:
    struct Coefficients {
        Vec3 stiffness = Vec3::Zero(), damping = Vec3::Zero();  ///< [N/m], [N s/m]
        Vec3 rotational_stiffness = Vec3::Zero(),
             rotational_damping = Vec3::Zero();  ///< [N m/rad], [N m s/rad]
    };

    /// psi is zero in the state `start`. Throws lie::InvalidInput for a negative coefficient.
    Bushing(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, const Coefficients& coefficients,
            const State& start);

    void add(const State& x, lie::Loads& out) const override;
    double potential_energy(const State& x) const override;
    bool may_be_implicit() const override { return true; }
    bool is_passive() const override { return true; }
    bool is_dissipative() const override;
    /// The three translations in the frame of body i, then the three components of psi
    int max_spring_rows() const override { return 6; }
    int spring_rows(const State& x, SpringRow* out) const override;
    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::vector<Quantity> quantities() const override;
    void values(const State& x, double* out) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }
    int last_body() const override { return std::max(i, j); }

private:
    struct Deflection {
        Vec3 d, psi;
    };
    Deflection deflection(const State& x) const;
    void add_translations(const State& x, LoadDerivatives& out) const;
    void add_rotations(const State& x, LoadDerivatives& out) const;

    const int i, j;
    const Vec3 s_bar_i, s_bar_j;
    const Mat3 R_0;
    const Coefficients coefficients;
};

}  // namespace hilda::dae
