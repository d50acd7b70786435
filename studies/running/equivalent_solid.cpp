// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/equivalent_solid.hpp"

#include "contact/surfaces/sphere.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

contact::PolygonMesh equivalent_solid(const dae::Body& body)
{
    using lie::Mat3, lie::Vec3;
    constexpr double equal = 1e-9, thinnest = 0.02;  // relative to the largest moment, to the longest side
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(body.J_bar);
    const Vec3 J = principal.eigenvalues();
    if (J[2] - J[0] <= equal * J[2])
        return contact::tessellate(contact::Sphere(std::sqrt(2.5 * J[2] / body.m)), {});

    Mat3 axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    Vec3 side;
    for (int k = 0; k < 3; ++k) side[k] = std::sqrt(std::max(0., 6 * (J.sum() - 2 * J[k]) / body.m));
    side = side.cwiseMax(thinnest * side.maxCoeff());
    contact::PolygonMesh box;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
        box.point.push_back(axes * (0.5 * sign.cwiseProduct(side)));
    }
    box.polygon = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return box;
}

}  // namespace hilda::studies
