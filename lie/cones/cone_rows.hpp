// SPDX-License-Identifier: GPL-3.0-or-later
/// Unilateral contact points with Coulomb friction: one cone each.

#pragma once

#include "lie/so3.hpp"

#include <cstdint>
#include <vector>

namespace hilda::lie {

struct State;

/// The contact points of a state. At each of them body i touches body j or the ground, and
///
///     u = C_i (ṙ_i, ω̄_i) + C_j (ṙ_j, ω̄_j)      velocity of i relative to j in the axes (n, t_1, t_2)
///
/// with the unit normal n into body i. The impulse p of the contact point acts as C_iᵀ p and C_jᵀ p on the
/// bodies, and satisfies Signorini's condition and Coulomb's law with the Coulomb cone K_μ = {|p_t| ≤ μ p_n}:
///
///     p ∈ K_μ,   u + (μ |u_t| + β) n ∈ K_μ*,   p · (u + (μ |u_t| + β) n) = 0                 De Saxcé (1992)
///
/// where β is set by the scheme from the gap and the coefficient of restitution.
struct ConeRows {
    using Mat36 = Eigen::Matrix<double, 3, 6>;

    struct Cone {
        std::uint64_t key = 0;  ///< the same contact point has the same key in all states
        int i = -1, j = -1;     ///< body numbers; -1 denotes the ground
        Mat36 C_i = Mat36::Zero(), C_j = Mat36::Zero();  ///< zero for the ground
        Mat3 axes = Mat3::Identity();                    ///< n, t_1, t_2 as columns, global frame
        double gap = 0;                                  ///< [m], negative for an overlap
        double mu_s = 0, mu_k = 0;  ///< coefficients of friction of a contact point that sticks, that slips
        double restitution = 0;     ///< Newton's coefficient in [0, 1]
        double size = 0;            ///< smaller size of the two bodies [m], the scale of overlaps

        /// u_n for the velocities of a state [m/s]
        double normal_velocity(const State& x) const;
    };

    bool has(std::uint64_t key) const;
    /// Adds the contact points of another list that are not in this one.
    void add_unlisted(const ConeRows& other);

    std::vector<Cone> cone;  ///< in ascending order of the keys
};

/// The force of a contact point in the last step: its impulse over the length of the step
struct ConeForce {
    std::uint64_t key = 0;
    Vec3 F = Vec3::Zero();  ///< on body i [N], global frame
    double slips = 0;       ///< 1 if the contact point slips, 0 if it sticks
};

}  // namespace hilda::lie
