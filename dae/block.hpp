// SPDX-License-Identifier: GPL-3.0-or-later
/// A scalar constraint row between two bodies. Joints and drivers are lists of blocks.

#pragma once

#include "dae/constraint.hpp"
#include "dae/constraints/point_rows.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace hilda::dae {

class Driver;

/// A scalar row Φ(r, A, t) = 0 between the bodies i and j. Derive from Block to add a constraint.
///
/// A block is a constraint of one position row without algebraic variables. The functions without a row
/// number are those to override. The arguments contain the motions of the two bodies; the ground has the
/// motion of a body at rest at the origin. A block may have internal states, for example to count
/// revolutions. The model removes redundant blocks from the equations.
class Block : public Constraint {
public:
    using Constraint::Constraint;

    /// Φ(r, A, t), in m, m² or 1 depending on the type
    virtual double phi(const Arguments& x) const = 0;
    /// First variation Φ_r, Π̄
    virtual Variation variation(const Arguments& x) const = 0;
    /// ν = -∂Φ/∂t: right side of the velocity constraint Φ_r ṙ + Π̄ ω̄ = ν                           Eq. 2.8
    virtual double nu(const Arguments& /*x*/) const { return 0; }
    /// γ: right side of the acceleration constraint Φ_r r̈ + Π̄ ω̄̇ = γ                              Eq. 2.9
    virtual double gamma(const Arguments& x) const = 0;

    /// Second variation ∂(r_i, pi_i, r_j, pi_j)/∂(δr_i, δθ_i, δr_j, δθ_j) with A ← A exp(δθ~). This default
    /// and the next two use central differences with a relative error of about 1e-9.
    virtual Mat12 second_variation(const Arguments& x) const { return Constraint::second_variation(x, 0); }
    /// ∂ν/∂(δr_i, δθ_i, δr_j, δθ_j)
    virtual Variation nu_variation(const Arguments& x) const { return Constraint::nu_variation(x, 0); }
    /// Derivatives of γ by the positions and velocities of both bodies
    virtual GammaDerivatives gamma_variation(const Arguments& x) const
    {
        return Constraint::gamma_variation(x, 0);
    }

    /// The function of time f(t) that the row prescribes; nullptr if there is none. The load -λ of the row
    /// and ḟ are conjugate: their product is the power of the driver on the bodies.
    virtual const Driver* prescribed() const { return nullptr; }

    /// For a row that keeps a coordinate of two points at a constant difference: the model evaluates such
    /// rows together.
    virtual std::optional<PointRow> point_row() const { return {}; }

    /// Sparsity pattern of the first variation: bits 0 to 5 for (r_i, pi_i), bits 6 to 11 for (r_j, pi_j). A
    /// bit is clear if the derivative is zero in every state.
    virtual unsigned nonzero() const { return 0b111111111111; }

    // The functions of a general constraint
    Size size() const final { return {.position_rows = 1}; }
    void phi(const Arguments& x, double* out) const final { *out = phi(x); }
    void variation(const Arguments& x, Derivatives& out) const final;
    void nu(const Arguments& x, double* out) const final { *out = nu(x); }
    void gamma(const Arguments& x, double* out) const final { *out = gamma(x); }
    Mat12 second_variation(const Arguments& x, int) const final { return second_variation(x); }
    Variation nu_variation(const Arguments& x, int) const final { return nu_variation(x); }
    GammaDerivatives gamma_variation(const Arguments& x, int) const final { return gamma_variation(x); }
    unsigned nonzero(int) const final { return nonzero(); }
};

/// The rows of a joint or driver
using Blocks = std::vector<std::unique_ptr<Block>>;

}  // namespace hilda::dae
