// SPDX-License-Identifier: GPL-3.0-or-later
/// A smooth surface through a triangle mesh: normal and curvature are those of one G.

#pragma once

#include "contact/mesh/triangle_mesh.hpp"
#include "contact/surface.hpp"

namespace hilda::contact {

/// At each vertex k a cubic patch z = f_k(x, y) in a frame whose z is the normal there, fitted to the vertices around it
/// by weighted least squares; and the patches blended by a partition of unity:
///
///     G(ᾱ) = Σ w_k Q_k / Σ w_k,   Q_k = z_k - f_k(x_k, y_k),   w_k = (1 - |ᾱ - v_k|²/ρ_k²)³ within ρ_k, else 0
///
/// with (x_k, y_k, z_k) = E_kᵀ(ᾱ - v_k). w has two continuous derivatives, and so has G. With edges of length e the
/// Q_k are wrong by O(e⁴), so that by Σ ∇(w_k / Σ w) = 0 the surface is wrong by O(e⁴), its normal by O(e³) and its
/// curvature by O(e²). It passes through the vertices to O(e⁴), and not exactly.
///
/// A rigid ball that slides over a surface feels its curvature: a force needs second derivatives that converge.
/// That rules out the flat facets with interpolated normals, whose normal is the gradient of nothing, and the
/// parametric patches that join with a common tangent plane (Nagata, PN triangles): their curvature jumps at
/// every edge, and G would be a distance to be found by iteration.
///
/// Of the patches only those count whose vertex is joined to the triangle nearest to ᾱ by triangles within ρ_k, so that
/// the two sides of a thin body do not feel each other. Further from the mesh than half an edge, G is the signed
/// distance to the triangles, which leads a search back; at that border it jumps.
class MeshSurface final : public Surface {
public:
    /// A hollow, touched from inside, where concave. InvalidInput where the mesh is too coarse to be smooth: where its
    /// normals turn by more than 80 degrees among the vertices of one patch, as at a sharp edge, or its vertices
    /// are too few for one.
    explicit MeshSurface(TriangleMesh mesh, bool concave = false);

    std::string name() const override { return "mesh"; }
    double value(const Vec3& a) const override { return derivatives(a).G; }
    Vec3 gradient(const Vec3& a) const override { return derivatives(a).gradient; }
    Mat3 hessian(const Vec3& a) const override { return derivatives(a).hessian; }
    Derivatives derivatives(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// Of the box around it half the mean side: (abc)^(1/3) for an ellipsoid along the axes
    double size() const override { return length; }

    const TriangleMesh mesh;
    const bool concave;

private:
    struct Patch {
        Vec3 v;                    // where it begins
        Mat3 E;                    // from its frame; z is the normal
        double rho;                // its reach
        std::array<double, 10> f;  // coefficients of 1, x, y, x², xy, y², x³, x²y, xy², y³

        /// Q_k, ∇Q_k, ∇²Q_k
        Derivatives at(const Vec3& a) const;
    };
    Patch fitted(int vertex, std::vector<bool>& seen) const;
    Derivatives distance(const Vec3& a, const TriangleMesh::Nearest& near) const;
    double half_edge(int triangle) const;

    double length;
    std::vector<Patch> patches;    // one for each vertex
    std::vector<int> first, list;  // those that count at triangle t: list[first[t]] up to list[first[t + 1]]
};

}  // namespace hilda::contact
