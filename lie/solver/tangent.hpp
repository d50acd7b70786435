// SPDX-License-Identifier: GPL-3.0-or-later
/// The derivatives of the equations of motion, and Newton matrices that contain them.

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/solver/multifrontal_lu.hpp"

#include <vector>

namespace hilda::lie {

class System;

/// The derivatives of M v̇ + Cᵀ λ - Q(q, v, t) and of C v - ν in one state, v = (ṙ, ω̄), C = (Φ_r, Π̄):
///
///     K_t = Σ λ_k H_k - ∂Q/∂(δr, δθ̄)       geometric and load stiffness; H_k: second variation of row k
///     D   = -∂Q/∂v = G - ∂(F, n̄)/∂v        damping of the loads;  G = ω̄̃ J̄ - (J̄ ω̄)~ for the rotations
///     V   = Σ vᵀ H - ∂ν/∂(δr, δθ̄)          for each row
///
/// A force that gives no derivatives (dae::Force::bodies) does not contribute.
class Tangent {
public:
    /// The derivatives of the equations of body `on` by the motion of body `by`
    struct Block {
        int on = 0, by = 0;
        Mat6 K = Mat6::Zero(), D = Mat6::Zero();
    };
    using Row = Eigen::Matrix<double, 1, 6>;

    explicit Tangent(const System& system);

    /// Sets all but V in the state x, with the multipliers of x.
    void evaluate(const State& x);
    /// The same, and V
    void evaluate_with_velocities(const State& x);

    /// y += K_t x for a vector with six components per body
    template <class X, class Y>
    void add_stiffness(const X& x, Y& y) const
    {
        for (const Block& b : block)
            y.template segment<6>(6 * b.on).noalias() += b.K * x.template segment<6>(6 * b.by);
    }
    /// (V x)_k
    template <class X>
    typename X::Scalar velocity_variation(int k, const X& x) const
    {
        typename X::Scalar sum(0);
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c) sum += V[n][c] * x[6 * C.entry[n].body + c];
        return sum;
    }

    const System& system;
    Rows C;                    ///< in the state x
    std::vector<Block> block;  ///< first those of each body with itself
    std::vector<Row> V;        ///< of each entry of C

private:
    SecondVariation H;
    Rows d_nu;
    LoadVariation d_load;
    std::vector<int> second_at, load_at;  ///< the index in `block` of each block of H and d_load
};

/// The Newton matrix
///
///     | M + d D + k K_t P     Cᵀ |
///     | C_P                   0  |,     δ(r, θ̄) = P δz
///
/// where z are the unknowns of the motion, P = p for the translations and P_b for the rotation of body b. C_P
/// is C P for position constraints, and C + V P for velocity constraints with z = v. The row of an inactive
/// constraint has a one on the diagonal.
///
/// The bodies are eliminated in an order of minimum degree, and each row directly after the last of its
/// bodies. The pivots are then the diagonal entries in a fixed order: those of a body are near its inertia,
/// and those of a row near C M⁻¹ Cᵀ. The factors depend on the present values only, not on earlier ones.
template <class Scalar>
class TangentMatrix {
public:
    enum class Constraints { position, velocity };
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

    TangentMatrix(const Tangent& tangent, Constraints constraints);

    /// Sets the values from the tangent and from `rotation`.
    void assemble(Scalar d, Scalar k, Scalar p);
    void factor() { N.factor(); }
    void solve(Vector& b) { N.solve(b); }

    const MultifrontalLu<Scalar>& matrix() const { return N; }

    std::vector<Matrix3> rotation;  ///< P of the rotation of each body

private:
    const Tangent& tangent;
    const Constraints constraints;
    MultifrontalLu<Scalar> N;
    // handles of the blocks of N
    std::vector<int> block_at, row_at, column_at, inactive_at;
};

extern template class TangentMatrix<double>;
extern template class TangentMatrix<std::complex<double>>;

}  // namespace hilda::lie
