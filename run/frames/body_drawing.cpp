// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/body_drawing.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/polytope.hpp"
#include "contact/surfaces/sphere.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace hilda::run {

namespace {

using contact::PolygonMesh;
using lie::Mat3, lie::Vec3;

/// A box with its sides along the columns of `axes`, a rotation matrix
PolygonMesh box(const Vec3& side, const Mat3& axes)
{
    PolygonMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
        mesh.point.push_back(axes * (0.5 * sign.cwiseProduct(side)));
    }
    mesh.polygon = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return mesh;
}

/// A frustum about coordinate axis `axis` with these radii at its upper and lower end
PolygonMesh frustum(int axis, double upper, double upper_radius, double lower, double lower_radius)
{
    const Vec3 along = Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
    PolygonMesh mesh = contact::grid(2, contact::around, false, true, [&](int row, int column) {
        const double angle = 2 * std::numbers::pi * column / contact::around;
        const double radius = row == 0 ? upper_radius : lower_radius;
        return Vec3((row == 0 ? upper : lower) * along +
                    radius * (std::cos(angle) * u + std::sin(angle) * v));
    });
    std::vector<int> top, bottom;
    for (int k = 0; k < contact::around; ++k) {
        top.push_back(k);
        bottom.push_back(2 * contact::around - 1 - k);
    }
    mesh.polygon.push_back(std::move(top));
    mesh.polygon.push_back(std::move(bottom));
    return mesh;
}

/// A capsule about coordinate axis `axis`
PolygonMesh capsule(int axis, double radius, double length)
{
    PolygonMesh mesh = contact::tessellate(contact::Polytope::capsule(length, radius), {});
    for (Vec3& x : mesh.point) {
        const Vec3 local = x;
        for (int k = 0; k < 3; ++k) x[(axis + 1 + k) % 3] = local[k];
    }
    return mesh;
}

PolygonMesh drawing(const dae::BodyShape& shape)
{
    const std::vector<double>& d = shape.dimensions;
    if (shape.type == "box") return box({d[0], d[1], d[2]}, Mat3::Identity());
    if (shape.type == "sphere") return contact::tessellate(contact::Sphere(d[0]), {});
    if (shape.type == "ellipsoid") return contact::tessellate(contact::Ellipsoid(Vec3(d[0], d[1], d[2])), {});
    if (shape.type == "cylinder") return frustum(shape.axis, 0.5 * d[1], d[0], -0.5 * d[1], d[0]);
    if (shape.type == "capsule") return capsule(shape.axis, d[0], d[1]);
    if (shape.type == "convex") return {.point = shape.vertices, .polygon = shape.faces};
    return frustum(shape.axis, 0.75 * d[1], 0, -0.25 * d[1], d[0]);  // cone
}

}  // namespace

bool has_equal_moments(const dae::Body& body)
{
    const Vec3 J = Eigen::SelfAdjointEigenSolver<Mat3>(body.J_bar, Eigen::EigenvaluesOnly).eigenvalues();
    return J[2] - J[0] <= 1e-9 * J[2];
}

PolygonMesh equivalent_solid(const dae::Body& body)
{
    constexpr double thinnest = 0.02;  // relative to the longest side
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(body.J_bar);
    const Vec3& J = principal.eigenvalues();
    if (has_equal_moments(body))
        return contact::tessellate(contact::Sphere(std::sqrt(2.5 * J[2] / body.m)), {});

    Mat3 axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    Vec3 side;
    for (int k = 0; k < 3; ++k) side[k] = std::sqrt(std::max(0., 6 * (J.sum() - 2 * J[k]) / body.m));
    return box(side.cwiseMax(thinnest * side.maxCoeff()), axes);
}

PolygonMesh body_drawing(const dae::Body& body)
{
    return body.shape ? drawing(*body.shape) : equivalent_solid(body);
}

}  // namespace hilda::run
