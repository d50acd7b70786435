// SPDX-License-Identifier: GPL-3.0-or-later
/// The variations of the constraint rows and of the springs of a system, as sparse blocks.

#pragma once

#include "lie/so3.hpp"

#include <span>
#include <vector>

namespace hilda::lie {

/// The first variation δΦ = Φ_r δr + Π̄ δθ̄ + Φ_α δα of all rows, with A ← A exp(δθ̄~), as sparse blocks.
///
/// Row k has the entries start[k] … start[k+1]-1. An entry holds the six derivatives for one body. The
/// pattern (start, body, nonzero) is fixed; only the values depend on the state and, for the compliances, on
/// the step.
struct Rows {
    struct Entry {
        int body = 0;
        unsigned nonzero = 0b111111;  ///< bit c is clear if component c of (r, pi) is zero in every state
        Vec3 r = Vec3::Zero();        ///< ∂Φ_k/∂r of the body, global frame
        Vec3 pi = Vec3::Zero();       ///< Π̄ of row k for the body, body frame
    };

    /// The algebraic variables first_alpha … first_alpha + count - 1 of State::alpha. They enter the rows
    /// first … first + rows - 1 and no others. count < rows ≤ 8. The groups are in ascending order of their
    /// rows.
    struct AlgebraicGroup {
        int first = 0, rows = 0, first_alpha = 0, count = 0;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8> D;  ///< ∂Φ/∂α, rows × count
    };

    std::vector<int> start{0};
    std::vector<Entry> entry;
    std::vector<AlgebraicGroup> algebraic;
    /// The regularised rows, ascending. Row regularised[n] has the diagonal entry -compliance[n] in the
    /// saddle matrix. They are nonholonomic rows. Those of friction come first and are unilateral; those of
    /// implicit springs are the last `springs` rows.
    std::vector<int> regularised;
    std::vector<double> compliance;  ///< [1/kg]
    int springs = 0;
    int velocity_rows = 0;  ///< number of nonholonomic rows, the last ones
    /// The rows that are inactive in some states, ascending. The saddle system gives an inactive row the
    /// correction zero. The multiplier of a row must be set to zero when the row becomes inactive.
    std::vector<int> unilateral;

    /// Sets the compliances, one for each regularised row of friction. Without compliances these rows are
    /// made inactive: their derivatives are set to zero.
    void regularise(std::span<const double> compliances);
    /// Sets the derivatives of a row to zero.
    void clear(int k)
    {
        for (int n = start[k]; n < start[k + 1]; ++n) entry[n].r.setZero(), entry[n].pi.setZero();
    }
    /// Adds the rows of springs to the pattern, as regularised nonholonomic rows.
    void append_springs(const Rows& pattern);
    /// Sets the derivatives and the compliances of the rows of springs.
    void set_springs(const Rows& values, std::span<const double> compliances);
    bool is_regularised(int k) const;
    /// Whether row k is inactive, i.e. all its derivatives are zero. The last row of an algebraic group
    /// represents the whole group; Φ_α is checked for this row only.
    bool is_inactive(int k) const;

    int rows() const { return static_cast<int>(start.size()) - 1; }
    int position_rows() const { return rows() - velocity_rows; }
    /// Total number over all groups
    int algebraic_variables() const
    {
        int sum = 0;
        for (const AlgebraicGroup& group : algebraic) sum += group.count;
        return sum;
    }

    /// q += factor (Φ_rᵀ λ, Π̄ᵀ λ), six components per body.
    template <class Lambda, class Q>
    void add_transpose(double factor, const Lambda& lambda, Q& q) const
    {
        for (int k = 0; k < rows(); ++k) {
            const double l = factor * lambda[k];
            for (int n = start[k]; n < start[k + 1]; ++n) {
                q.template segment<3>(6 * entry[n].body) += l * entry[n].r;
                q.template segment<3>(6 * entry[n].body + 3) += l * entry[n].pi;
            }
        }
    }

    /// q += factor Φ_αᵀ λ, group by group.
    template <class Lambda, class Q>
    void add_algebraic_transpose(double factor, const Lambda& lambda, Q&& q) const
    {
        int at = 0;
        for (const AlgebraicGroup& group : algebraic) {
            for (int c = 0; c < group.count; ++c)
                for (int k = 0; k < group.rows; ++k)
                    q[at + c] += factor * group.D(k, c) * lambda[group.first + k];
            at += group.count;
        }
    }

    /// (Φ_r r + Π̄ θ)_k for q = (r, θ), six components per body.
    template <class Q>
    double dot(int k, const Q& q) const
    {
        double sum = 0;
        for (int n = start[k]; n < start[k + 1]; ++n)
            sum += entry[n].r.dot(q.template segment<3>(6 * entry[n].body)) +
                   entry[n].pi.dot(q.template segment<3>(6 * entry[n].body + 3));
        return sum;
    }
};

/// The deflections S of springs and dampers, and the derivatives of their loads, which a scheme may evaluate
/// implicitly.
///
/// Row n has the derivatives C of the deflection: Ṡ = C v, S̈ = C v̇ + γ with v = (ṙ, ω̄). Its load f in the
/// direction of the deflection acts on the bodies as -Cᵀ f and is part of System::loads(). A row without load
/// has zero derivatives in C.
struct Springs {
    Rows rows;
    std::vector<double> stiffness;  ///< ∂f/∂S [N/m], or [N m/rad] for a rotation
    std::vector<double> damping;    ///< ∂f/∂Ṡ [N s/m], or [N m s/rad]
    std::vector<double> gamma;      ///< γ [m/s²], or [rad/s²]
};

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// The second variation of all rows: the derivatives of the blocks (Φ_rᵀ, Π̄ᵀ) with respect to the poses.
///
/// at(k, a, b) is ∂(r, pi of entry a)/∂(δr, δθ̄ of the body of entry b), both entries of row k counted from
/// start[k] of the pattern, with A ← A exp(δθ̄~).
struct SecondVariation {
    explicit SecondVariation(const Rows& pattern);

    Mat6& at(int k, int a, int b) { return block[first[k] + a * entries[k] + b]; }
    const Mat6& at(int k, int a, int b) const { return block[first[k] + a * entries[k] + b]; }

    std::vector<int> first, entries;  ///< of each row: its first block, its number of entries
    std::vector<Mat6> block;
};

/// The variation of γ of each row, by the entries of the pattern: δγ = Σ r · δr + theta · δθ̄ + rdot · δṙ +
/// omega · δω̄
struct GammaVariation {
    struct Entry {
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    };
    explicit GammaVariation(const Rows& pattern) : entry(pattern.entry.size()) {}

    std::vector<Entry> entry;
};

}  // namespace hilda::lie
