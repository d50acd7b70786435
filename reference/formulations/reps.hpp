// SPDX-License-Identifier: GPL-3.0-or-later
/// The rε formulation: orientation by Euler angles ε = (θ, φ, ψ).           Fang (2022), Eq. 2.1b, Sec. 2.1.6

#pragma once

#include "lie/euler_angles.hpp"

#include <algorithm>

namespace hilda::reference {

/// The Euler angles ε of one body as coordinates, for a frame fixed in the body: A = R(ε) Cᵀ, where C is one
/// of the three cyclic permutations of the axes. δπ̄ = C B(ε) δε and ω̄ = C B ε̇.
///
/// The angles are singular for sin φ = 0: the third axis of the frame is then parallel to the global z axis.
/// One of three orthogonal axes makes an angle of at least acos(1/√3) = 0.955 rad with any line, so one of
/// the three frames is always at least that far from its singular set.
struct EulerAngles {
    static constexpr const char* formulation = "reps";
    static constexpr int size = 3;
    static constexpr bool unit_length = false;
    static constexpr bool singular_somewhere = true;

    lie::Vec3 q;
    int frame = 0;  ///< 0, 1 or 2: the axes of the frame are the body axes (1,2,3), (2,3,1) or (3,1,2)

    EulerAngles() = default;
    explicit EulerAngles(const lie::Mat3& A, int frame = 0)
        : q(lie::euler_angles(lie::Mat3(A * C(frame)))), frame(frame)
    {}

    static lie::Mat3 C(int frame)
    {
        lie::Mat3 C = lie::Mat3::Zero();
        for (int k = 0; k < 3; ++k) C((k + frame) % 3, k) = 1;
        return C;
    }

    lie::Mat3 A() const { return lie::rotation(q) * C(frame).transpose(); }
    lie::Mat3 T() const { return C(frame) * lie::B(q); }
    /// C Ḃ ε̇
    lie::Vec3 Tdot_qdot(const lie::Vec3& qdot) const
    {
        const double s_phi = std::sin(q[1]), c_phi = std::cos(q[1]);
        const double s_psi = std::sin(q[2]), c_psi = std::cos(q[2]);
        const double theta_phi = qdot[0] * qdot[1], theta_psi = qdot[0] * qdot[2],
                     phi_psi = qdot[1] * qdot[2];
        return C(frame) * lie::Vec3(c_phi * s_psi * theta_phi + s_phi * c_psi * theta_psi - s_psi * phi_psi,
                                    c_phi * c_psi * theta_phi - s_phi * s_psi * theta_psi - c_psi * phi_psi,
                                    -s_phi * theta_phi);
    }

    /// ε̇ = B⁻¹ Cᵀ ω̄; det B = -sin φ
    lie::Vec3 qdot(const lie::Vec3& omega_bar) const
    {
        const lie::Vec3 w = C(frame).transpose() * omega_bar;
        const double s_psi = std::sin(q[2]), c_psi = std::cos(q[2]);
        const double thetadot = (s_psi * w[0] + c_psi * w[1]) / std::sin(q[1]);
        return {thetadot, c_psi * w[0] - s_psi * w[1], w[2] - std::cos(q[1]) * thetadot};
    }
    lie::Vec3 qddot(const lie::Vec3& qdot, const lie::Vec3& omegadot_bar) const
    {
        return this->qdot(omegadot_bar - Tdot_qdot(qdot));
    }
    double turn2(const lie::Vec3& dq) const { return (lie::B(q) * dq).squaredNorm(); }
    void settle() {}

    double distance_to_singular_set() const { return lie::distance_to_singular_set(q); }
    /// Whether φ is outside 0 < φ < π: the step has passed the singular set.
    bool crossed_singular_set() const { return !(q[1] > 0 && q[1] < 3.14159265358979323846); }

    /// The same orientation in the frame that is farthest from its singular set
    EulerAngles in_best_frame() const
    {
        const lie::Mat3 A = this->A();
        EulerAngles best = *this;
        for (int f = 0; f < 3; ++f)
            if (const EulerAngles other(A, f);
                other.distance_to_singular_set() > best.distance_to_singular_set())
                best = other;
        return best;
    }

    /// Difference of the angles from an earlier orientation to this one, each in [-π, π]
    lie::Vec3 since(const EulerAngles& before) const
    {
        lie::Vec3 d = q - EulerAngles(before.A(), frame).q;
        constexpr double turn = 2 * 3.14159265358979323846;
        for (double& angle : d) angle = std::remainder(angle, turn);
        return d;
    }
};

}  // namespace hilda::reference
