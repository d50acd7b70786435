// SPDX-License-Identifier: GPL-3.0-or-later
/// A smooth implicit surface fitted to a triangle mesh.

#pragma once

#include "contact/mesh/triangle_mesh.hpp"
#include "contact/surface.hpp"

namespace hilda::contact {

/// At each vertex k a cubic patch z = f_k(x, y) is fitted to the surrounding vertices by weighted least
/// squares, in a frame with z along the vertex normal. The patches are blended by a partition of unity:
///
///     G(ᾱ) = Σ w_k Q_k / Σ w_k,   Q_k = z_k - f_k(x_k, y_k),   w_k = max(0, 1 - |ᾱ - v_k|²/ρ_k²)³
///
/// with (x_k, y_k, z_k) = E_kᵀ(ᾱ - v_k). w has two continuous derivatives, and so has G. With edge length e
/// the error of Q_k is O(e⁴). Since Σ ∇(w_k / Σ w) = 0, the error of the surface is O(e⁴), of its normal
/// O(e³), and of its curvature O(e²). The surface passes through the vertices to O(e⁴), not exactly.
///
/// The contact force on a sliding body depends on the curvature of the surface, so the second derivatives
/// must converge. Two alternatives are rejected for this reason. For flat facets with interpolated normals
/// the normal is not the gradient of any G. For parametric patches with common tangent planes (Nagata, PN
/// triangles) the curvature jumps at every edge, and G would be a distance that needs an iteration.
///
/// Only patches whose vertex is connected to the triangle closest to ᾱ by triangles within ρ_k contribute, so
/// that the two sides of a thin body do not influence each other. At distances above half an edge length from
/// the mesh, G is the signed distance to the triangles, which leads an iteration back to the mesh. G is
/// discontinuous at this limit.
class MeshSurface final : public Surface {
public:
    /// With `concave` contact is on the inside. InvalidInput if the mesh is too coarse for a smooth surface:
    /// the vertex normals of one patch differ by more than 80 degrees, as at a sharp edge, or the vertices do
    /// not determine a cubic.
    explicit MeshSurface(TriangleMesh mesh, bool concave = false);

    std::string name() const override { return "mesh"; }
    double value(const Vec3& a) const override { return derivatives(a).G; }
    Vec3 gradient(const Vec3& a) const override { return derivatives(a).gradient; }
    Mat3 hessian(const Vec3& a) const override { return derivatives(a).hessian; }
    Derivatives derivatives(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// Half the geometric mean of the sides of the bounding box [m]: (abc)^(1/3) for an ellipsoid aligned
    /// with the axes
    double size() const override { return length; }
    bool is_unbounded() const override { return false; }
    /// The triangles of the mesh
    PolygonMesh drawing(const DrawingExtent& extent) const override;

    const TriangleMesh mesh;
    const bool concave;

private:
    struct Patch {
        Vec3 v;                    // origin: the vertex [m]
        Mat3 E;                    // axes of the patch frame; z is the vertex normal
        double rho;                // support radius of the weight [m]
        std::array<double, 10> f;  // coefficients of 1, x, y, x², xy, y², x³, x²y, xy², y³

        /// Q_k, ∇Q_k and ∇²Q_k at ᾱ = a
        Derivatives at(const Vec3& a) const;
    };
    Patch fit_patch(int vertex, std::vector<bool>& seen) const;
    Derivatives distance_function(const Vec3& a, const TriangleMesh::Nearest& near) const;
    double half_edge(int triangle) const;

    double length;
    std::vector<Patch> patches;  // one for each vertex
    // the patches of triangle t are patch_list[first_patch[t]] .. patch_list[first_patch[t + 1] - 1]
    std::vector<int> first_patch, patch_list;
};

}  // namespace hilda::contact
