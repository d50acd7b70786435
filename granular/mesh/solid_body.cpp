// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/mesh/solid_body.hpp"

#include <numbers>

namespace hilda::granular {

namespace {

constexpr double pi = std::numbers::pi;

/// Inertia with the moment `along` about the unit vector `axis` and `across` about the normals to it
Inertia axial(const Vec3& axis, double along, double across)
{
    const double d = along - across;
    return Inertia(std::array{across + d * axis.x * axis.x, across + d * axis.y * axis.y,
                              across + d * axis.z * axis.z, d * axis.x * axis.y, d * axis.y * axis.z,
                              d * axis.z * axis.x});
}

/// A J̄ Aᵀ
Inertia rotated_inertia(const EulerParameters<double>& p, const Inertia& J)
{
    const auto column = [&](const Vec3& e) { return rotated(p, J * rotated_back(p, e)); };
    const Vec3 x = column({1, 0, 0}), y = column({0, 1, 0}), z = column({0, 0, 1});
    return Inertia(std::array{x.x, y.y, z.z, 0.5 * (x.y + y.x), 0.5 * (y.z + z.y), 0.5 * (z.x + x.z)});
}

}  // namespace

SolidBody solid_ball(double density, double radius)
{
    const double mass = 4. / 3 * pi * density * radius * radius * radius;
    return {mass, Inertia(0.4 * mass * radius * radius)};
}

SolidBody solid_frustum(double density, const Vec3& axis, double L, double a, double b)
{
    const double section = a * a + a * b + b * b, mass = pi * density * L / 3 * section,
                 z = L / 4 * (a * a + 2 * a * b + 3 * b * b) / section,
                 along = pi * density * L / 10 *
                         (a * a * a * a + a * a * a * b + a * a * b * b + a * b * b * b + b * b * b * b),
                 // ∫ z² dm from the first end
        second_moment = pi * density * L * L * L * (a * a / 30 + a * b / 10 + b * b / 5);
    return {mass, axial(axis, along, 0.5 * along + second_moment - mass * z * z), z * axis};
}

SolidBody solid_torus(double density, const Vec3& axis, double a, double A)
{
    const double mass = 2 * pi * pi * density * A * a * a;
    return {mass, axial(axis, mass * (A * A + 0.75 * a * a), mass * (0.5 * A * A + 0.625 * a * a))};
}

SolidBody sum(const std::vector<PlacedSolid>& all)
{
    SolidBody body{0, {}};
    for (const PlacedSolid& one : all) body.mass += one.solid.mass, body.centre += one.solid.mass * one.r;
    body.centre = (1 / body.mass) * body.centre;
    Inertia& J = body.inertia;
    for (const PlacedSolid& one : all) {
        const Inertia own = rotated_inertia(one.p, one.solid.inertia);
        const Vec3 d = one.r - body.centre;
        const double m = one.solid.mass;
        J.xx += own.xx + m * (d.y * d.y + d.z * d.z), J.yy += own.yy + m * (d.z * d.z + d.x * d.x);
        J.zz += own.zz + m * (d.x * d.x + d.y * d.y);
        J.xy += own.xy - m * d.x * d.y, J.yz += own.yz - m * d.y * d.z, J.zx += own.zx - m * d.z * d.x;
    }
    return body;
}

}  // namespace hilda::granular
