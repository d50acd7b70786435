// SPDX-License-Identifier: GPL-3.0-or-later
/// Volume, centroid and second moments of polyhedra.

#pragma once

#include "lie/so3.hpp"

#include <vector>

namespace hilda::dae {

/// Integrals over a solid
struct SolidMoments {
    double volume = 0;                       ///< [m³]
    lie::Vec3 centroid = lie::Vec3::Zero();  ///< [m]
    lie::Mat3 second = lie::Mat3::Zero();    ///< ∫ a aᵀ dV [m⁵], a from the centroid

    /// Inertia about the centroid of a homogeneous body of this mass [kg m²]:
    ///     m/V (trace(S) I - S),   S = ∫ a aᵀ dV
    /// Elements below 1e-14 of its trace are zero.
    lie::Mat3 inertia(double mass) const;
};

/// The moments of a polyhedron with plane faces, each as the numbers of its corners, counterclockwise seen
/// from outside. The faces are split into triangles (p, q, s), and each of these and the mean c of the points
/// are a tetrahedron. With p, q, s from c and e = p + q + s:
///
///     V = p · (q × s) / 6,    ∫ a dV = V e / 4,    ∫ a aᵀ dV = V (e eᵀ + p pᵀ + q qᵀ + s sᵀ) / 20
SolidMoments moments(const std::vector<lie::Vec3>& points, const std::vector<std::vector<int>>& faces);

}  // namespace hilda::dae
