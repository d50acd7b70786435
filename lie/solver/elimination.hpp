// SPDX-License-Identifier: GPL-3.0-or-later
/// Elimination of massless unknowns, group by group, before the saddle system is solved.
///
/// Let λ be the multipliers of the rows of a group, B their derivatives with respect to the bodies and D = ∂Φ/∂α.
/// The group's part of the saddle system,
///
///     M x + Bᵀ λ = f,    B x + D α = g,    Dᵀ λ = p
///
/// becomes with D = Q (R; 0), Q = (Q_1, Z), which spans the null space of Dᵀ by Z,
///
///     λ = Q_1 R⁻ᵀ p + Z μ,    M x + (Zᵀ B)ᵀ μ = f - Bᵀ Q_1 R⁻ᵀ p,    Zᵀ B x = Zᵀ g,    α = R⁻¹ Q_1ᵀ (g - B x)
///
/// A contact that evolves has seven rows and six unknowns, so that one row and one multiplier are left of it, the
/// normal force. The iterates are those of the whole system. Of empty rows nothing is left.

#pragma once

#include "lie/system.hpp"

namespace hilda::lie {

class Elimination {
public:
    /// The rows with empty[k] hold nothing; of a group its last one tells.
    explicit Elimination(const Rows& pattern, const std::vector<char>& inactive);

    /// The rows that are left. Rows of no group stay as they are, with their softness; of a group Zᵀ B; and what is not empty.
    const Rows& reduced() const { return left; }

    /// Eliminates with these values. SingularMatrix where the rows of a group do not determine its unknowns.
    void factor(const Rows& full);

    /// From (f, g, p) of the whole system to (f, g) of the reduced one. `only_g`: f and p are zero, whatever stands
    /// there.
    void reduce(const Rows& full, const Eigen::VectorXd& whole, bool only_g, Eigen::VectorXd& reduced);
    /// From (x, μ) of the reduced system to (x, λ, α) of the whole one, over its right side (f, g, p)
    void expand(const Rows& full, const Eigen::VectorXd& reduced, Eigen::VectorXd& whole) const;

private:
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
    using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;
    /// Rows of one group, or a run of rows of none (count 0)
    struct Group {
        int first, rows, count;  ///< in the whole system
        int reduced_first;       ///< in the reduced one
        int alpha;               ///< among the massless unknowns of the system
        int algebraic;           ///< number in Rows::massless
        Small QR, Z;             ///< Householder vectors below the diagonal, their heads 1; R above
        Few beta;
        Few of_p;  ///< Q_1 R⁻ᵀ p
    };

    static void reflect(const Group& g, Few& v, bool transpose);  ///< v ← Q v or Qᵀ v

    struct LeftOut {
        int first, rows, alpha, count;
    };

    Rows left;
    std::vector<Group> group;
    std::vector<LeftOut> left_out;  ///< what is empty: its multipliers and unknowns stay as they are
    std::vector<int> regularised;   ///< of the rows that give way, those that are left
    int bodies = 0;
};

}  // namespace hilda::lie
