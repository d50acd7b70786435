// SPDX-License-Identifier: GPL-3.0-or-later
/// The rp formulation: orientation by Euler parameters p.                         Fang (2022), Sec. 2.1.6

#pragma once

#include "lie/euler_parameters.hpp"

namespace hilda::reference {

/// The skew-symmetric matrix Q(w) with G(p)ᵀ w = Q(w) p, the derivative of G(p)ᵀ w by p
inline Eigen::Matrix4d Q(const lie::Vec3& w)
{
    Eigen::Matrix4d Q;
    Q << 0, -w.transpose(), w, -lie::tilde(w);
    return Q;
}

/// The Euler parameters p of one body as coordinates: |p| = 1, δπ̄ = 2G δp, ω̄ = 2G ṗ, and ω̄̇ = 2G p̈ since
/// Ġ ṗ = 0. G(a) b = -G(b) a.                                                               Eqs. 2.20 to 2.22
///
/// A(p) is the rotation of p/|p|. It is a rotation for every iterate p, and its variation is exactly
/// δπ̄ = 2G δp / |p|².
struct EulerParameters {
    static constexpr const char* formulation = "rp";
    static constexpr int size = 4;
    static constexpr bool unit_length = true;  ///< one additional constraint per body, (pᵀp - 1)/2 = 0
    static constexpr bool singular_somewhere = false;

    lie::Vec4 q;

    EulerParameters() = default;
    explicit EulerParameters(const lie::Mat3& A) : q(lie::euler_parameters(A)) {}

    lie::Mat3 A() const { return lie::rotation(lie::Vec4(q.normalized())); }
    /// T with δπ̄ = T δq and ω̄ = T q̇
    lie::Mat34 T() const { return 2 * lie::G(q); }
    lie::Vec3 Tdot_qdot(const lie::Vec4&) const { return lie::Vec3::Zero(); }

    /// ṗ for the angular velocity ω̄
    lie::Vec4 qdot(const lie::Vec3& omega_bar) const { return 0.5 * lie::G(q).transpose() * omega_bar; }
    /// p̈ for the angular acceleration ω̄̇, on the unit sphere: pᵀp̈ = -ṗᵀṗ
    lie::Vec4 qddot(const lie::Vec4& qdot, const lie::Vec3& omegadot_bar) const
    {
        return 0.5 * lie::G(q).transpose() * omegadot_bar - qdot.squaredNorm() * q;
    }
    /// Squared rotation angle of a small change δp
    double turn2(const lie::Vec4& dq) const { return 4 * dq.squaredNorm(); }
    /// Removes the deviation of |p| from 1 after a step.
    void settle() { q.normalize(); }
};

}  // namespace hilda::reference
