// SPDX-License-Identifier: GPL-3.0-or-later
/// Elimination of the algebraic variables from the saddle system, group by group.
///
/// Let λ be the multipliers of the rows of a group, B = (Φ_r, Π̄) of these rows and D = ∂Φ/∂α. The part of
/// the group in the saddle system is
///
///     M x + Bᵀ λ = f,    B x + D α = g,    Dᵀ λ = p
///
/// With the QR factorisation D = Q (R; 0), Q = (Q_1, Z), where the columns of Z span the null space of Dᵀ, it
/// becomes
///
///     λ = Q_1 R⁻ᵀ p + Z μ,    M x + (Zᵀ B)ᵀ μ = f - Bᵀ Q_1 R⁻ᵀ p,   Zᵀ B x = Zᵀ g,    α = R⁻¹ Q_1ᵀ (g - B x)
///
/// An evolving contact has seven rows and six algebraic variables; one row remains, with the normal force as
/// its multiplier. The solution is that of the full system. Inactive rows are removed.

#pragma once

#include "lie/rows.hpp"

namespace hilda::lie {

class Elimination {
public:
    /// Removes the rows k with inactive[k], and the groups whose last row is inactive.
    explicit Elimination(const Rows& pattern, const std::vector<char>& inactive);

    /// The remaining rows: Zᵀ B of each group; rows that belong to no group unchanged, with their compliance.
    const Rows& reduced() const { return remaining; }

    /// Eliminates with these values. Throws SingularMatrix if the rows of a group do not determine its
    /// algebraic variables.
    void factor(const Rows& full);

    /// The right side (f, g) of the reduced system from (f, g, p) of the full one. only_g: f = 0 and p = 0;
    /// they are not read.
    void reduce(const Rows& full, const Eigen::VectorXd& whole, bool only_g, Eigen::VectorXd& reduced);
    /// The solution (x, λ, α) of the full system from (x, μ) of the reduced one. `whole` holds (f, g, p) on
    /// entry.
    void expand(const Rows& full, const Eigen::VectorXd& reduced, Eigen::VectorXd& whole) const;

private:
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
    using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;
    /// The rows of one group, or consecutive rows that belong to no group (count = 0)
    struct Group {
        int first, rows, count;  ///< in the full system
        int reduced_first;       ///< first row in the reduced system
        int alpha;               ///< first algebraic variable, counted group by group
        int algebraic;           ///< index in Rows::algebraic
        Small QR, Z;   ///< QR: R in the upper triangle, Householder vectors below (first component 1)
        Few beta;      ///< factors of the reflections I - β v vᵀ
        Few lambda_p;  ///< Q_1 R⁻ᵀ p
    };

    static void reflect(const Group& g, Few& v, bool transpose);  ///< v ← Q v or Qᵀ v

    /// Inactive rows, and the algebraic variables of their group
    struct InactiveRows {
        int first, rows, alpha, count;
    };

    Rows remaining;
    std::vector<Group> group;
    std::vector<InactiveRows> inactive_rows;  ///< the corrections of their multipliers and variables are zero
    std::vector<int> regularised;             ///< indices in Rows::regularised of the rows that remain
    int bodies = 0;
};

}  // namespace hilda::lie
