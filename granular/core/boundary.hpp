// SPDX-License-Identifier: GPL-3.0-or-later
/// What particles are held by or meet: planes, cylinders, cones, spheres, moved as told or by what they carry.

#pragma once

#include "granular/backend/real.hpp"

#include <array>
#include <cstdint>

namespace hilda::granular {

using Vec3 = Vec<double>;

/// A surface, at rest or in rigid motion. Particles are on the side that `side` says.
struct Boundary {
    enum class Shape : std::int32_t {
        plane,     ///< through r, with the normal `axis` into the particles
        cylinder,  ///< about the line through r along `axis`
        cone,  ///< with its tip at r, opening along `axis` with the half angle whose cosine and sine are given
        sphere  ///< about r
    } shape = Shape::plane;
    std::int32_t inside = 0;  ///< 1: particles are within a cylinder, cone or sphere; 0: around it
    Vec3 r = {0, 0, 0};       ///< [m]
    Vec3 axis = {0, 0, 1};    ///< unit
    double radius = 0;        ///< [m]
    double cosine = 1, sine = 0;
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};  ///< velocity of r [m/s], turning about it [rad/s]
    std::int32_t material = 0;

    // A tool: a body that moves by what touches it, its weight and F. A mass of 0 is one that moves as it is told.
    std::array<bool, 3> free = {true, true, true};  ///< along x, y, z
    bool unused = false;  ///< no byte is left to chance: boundaries are compared and written as they are
    double mass = 0;      ///< [kg]
    double inertia = 0;   ///< about r, whatever the axis [kg m²]; 0: does not turn
    Vec3 F = {0, 0, 0};   ///< [N]

    HILDA_HD float inverse_mass() const { return mass > 0 ? static_cast<float>(1 / mass) : 0; }
};

/// Distance of a point from a boundary [m], negative beyond it, and the unit normal there, towards the particles
struct Nearest {
    double distance;
    Vec3 n;
};
HILDA_HD inline Nearest nearest(const Boundary& b, const Vec3& at)
{
    const Vec3 d = at - b.r;
    const double sign = b.inside != 0 ? -1 : 1;
    switch (b.shape) {
        case Boundary::Shape::plane:
            return {d.dot(b.axis), b.axis};
        case Boundary::Shape::cylinder: {
            const Vec3 out = d - d.dot(b.axis) * b.axis;
            const double far = out.norm();
            return {sign * (far - b.radius), (sign / (far > 0 ? far : 1)) * out};
        }
        case Boundary::Shape::cone: {
            const double along = d.dot(b.axis);
            const Vec3 out = d - along * b.axis;
            const double far = out.norm();
            const Vec3 radial = (1 / (far > 0 ? far : 1)) * out;
            // across the slant line (sine, cosine) in the plane of the axis and the point; the tip where that is nearest
            if (along * b.cosine + far * b.sine < 0 && b.inside == 0) {
                const double from_tip = d.norm();
                return {from_tip, (1 / (from_tip > 0 ? from_tip : 1)) * d};
            }
            return {sign * (far * b.cosine - along * b.sine), sign * (b.cosine * radial - b.sine * b.axis)};
        }
        case Boundary::Shape::sphere:
            break;
    }
    const double far = d.norm();
    return {sign * (far - b.radius), (sign / (far > 0 ? far : 1)) * d};
}

/// Floor and four walls of a box without a lid
inline std::array<Boundary, 5> open_box(const Vec3& low, const Vec3& high)
{
    std::array<Boundary, 5> b;
    b[0].r = b[1].r = b[2].r = low, b[3].r = b[4].r = high;
    b[0].axis = {0, 0, 1}, b[1].axis = {1, 0, 0}, b[2].axis = {0, 1, 0};
    b[3].axis = {-1, 0, 0}, b[4].axis = {0, -1, 0};
    return b;
}

/// Velocity of the boundary at a point [m/s]
HILDA_HD inline Vec3 velocity(const Boundary& b, const Vec3& at) { return b.v + b.omega.cross(at - b.r); }

}  // namespace hilda::granular
