// SPDX-License-Identifier: GPL-3.0-or-later
/// A scalar constraint row between two bodies. Joints and drivers are lists of blocks.

#pragma once

#include "dae/body.hpp"

#include <memory>
#include <vector>

namespace hilda::dae {

/// First variation of a row: δΦ = r_i · δr_i + pi_i · δπ̄_i + r_j · δr_j + pi_j · δπ̄_j           Eq. 3.6
///
/// r_i = Φ_riᵀ (global frame) and pi_i = Π̄_iᵀ (body frame of i); the same for body j. A virtual rotation δπ̄
/// changes the orientation by δA = A δπ̄~.
struct Variation {
    Vec3 r_i, pi_i, r_j, pi_j;

    static Variation zero() { return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; }
};

using Mat12 = Eigen::Matrix<double, 12, 12>;

/// Derivatives of γ: δγ = r · δr + theta · δθ + rdot · δṙ + omega · δω̄, summed over the bodies i and j
struct GammaDerivatives {
    struct OfBody {
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    } i, j;
};

/// A scalar row Φ(r, A, t) = 0 between the bodies i and j. Derive from Block to add a constraint.
///
/// The functions take the motions of the two bodies; the ground has the motion of a body at rest at the
/// origin.
class Block {
public:
    Block(int i, int j) : i(i), j(j) {}
    virtual ~Block() = default;

    /// Φ(r, A, t), in m, m² or 1 depending on the type
    virtual double phi(const Motion& bi, const Motion& bj, double t) const = 0;
    /// First variation Φ_r, Π̄
    virtual Variation variation(const Motion& bi, const Motion& bj, double t) const = 0;
    /// ν = -∂Φ/∂t: right side of the velocity constraint Φ_r ṙ + Π̄ ω̄ = ν                           Eq. 2.8
    virtual double nu(const Motion& bi, const Motion& bj, double t) const = 0;
    /// γ: right side of the acceleration constraint Φ_r r̈ + Π̄ ω̄̇ = γ                              Eq. 2.9
    virtual double gamma(const Motion& bi, const Motion& bj, double t) const = 0;

    /// Second variation ∂(r_i, pi_i, r_j, pi_j)/∂(δr_i, δθ_i, δr_j, δθ_j) with A ← A exp(δθ~). This default
    /// and the next two use central differences with a relative error of about 1e-9.
    virtual Mat12 second_variation(const Motion& bi, const Motion& bj, double t) const;
    /// ∂ν/∂(δr_i, δθ_i, δr_j, δθ_j)
    virtual Variation nu_variation(const Motion& bi, const Motion& bj, double t) const;
    /// Derivatives of γ by the positions and velocities of both bodies
    virtual GammaDerivatives gamma_variation(const Motion& bi, const Motion& bj, double t) const;

    /// Sparsity pattern of the first variation: bits 0 to 5 for (r_i, pi_i), bits 6 to 11 for (r_j, pi_j). A
    /// bit is clear if the derivative is zero in every state.
    virtual unsigned nonzero() const { return 0b111111111111; }
    /// Reason why the block cannot be used from a start in this position, in the form "what is wrong, got
    /// value". An empty string if it can.
    virtual std::string start_error(const Motion& /*bi*/, const Motion& /*bj*/, double /*t*/) const
    {
        return {};
    }

    int i, j;  ///< body numbers, or `ground`
};

/// The rows of a joint or driver
using Blocks = std::vector<std::unique_ptr<Block>>;

}  // namespace hilda::dae
