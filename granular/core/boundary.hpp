// SPDX-License-Identifier: GPL-3.0-or-later
/// Boundaries: planes, cylinders, cones, spheres, finite surfaces of revolution and triangle meshes, with
/// prescribed motion or moving as rigid bodies under their loads.

#pragma once

#include "granular/core/orientation.hpp"
#include "granular/core/surfaces/meridian.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace hilda::granular {

using Vec3 = Vec<double>;

/// Moments and products of inertia about the centre of mass, in the body frame [kg m²]
struct Inertia {
    double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

    Inertia() = default;
    /// The same moment of inertia about every axis
    Inertia(double same) : xx(same), yy(same), zz(same) {}
    Inertia(const std::array<double, 6>& J) : xx(J[0]), yy(J[1]), zz(J[2]), xy(J[3]), yz(J[4]), zx(J[5]) {}

    bool is_zero() const { return *this == Inertia{}; }
    /// J̄ a
    HILDA_HD Vec3 operator*(const Vec3& a) const
    {
        return {xx * a.x + xy * a.y + zx * a.z, xy * a.x + yy * a.y + yz * a.z,
                zx * a.x + yz * a.y + zz * a.z};
    }
    bool operator==(const Inertia&) const = default;
};

/// A boundary surface in rigid motion. Vectors are in the global frame.
///
/// With mass = 0 the motion is prescribed by v and omega. With mass > 0 the boundary is a rigid body boundary
/// (tool): it moves under its contact loads, gravity, the external force F and the external torque T. Its
/// centre of mass is r. See rigid_body.hpp for the equations of motion.
struct Boundary {
    enum class Shape : std::int32_t {
        plane,     ///< plane through r; its normal `axis` points to the particles
        cylinder,  ///< infinite cylinder; its axis is the line through r along `axis`
        cone,      ///< infinite cone with apex r that opens along `axis`; half angle by `cosine` and `sine`
        sphere,    ///< sphere with centre r
        mesh,      ///< triangles; see surfaces/surfaces.hpp
        frustum,   ///< finite cone or cylinder about the axis; see frustum()
        disk,      ///< disk about r with the normal `axis`
        torus,     ///< tube of `radius` around a circle of `second_radius` about r, normal to `axis`
        none       ///< no surface: a rigid body whose parts have the contacts
    } shape = Shape::plane;
    std::int32_t inside = 0;      ///< 1: particles are inside the surface of revolution; 0: outside
    Vec3 r = {0, 0, 0};           ///< reference point [m]
    Vec3 axis = {0, 0, 1};        ///< unit vector
    double radius = 0;            ///< of a cylinder, sphere, disk, tube, or of a frustum at `from` [m]
    double second_radius = 0;     ///< of a frustum at `to`, of the centre line of a torus [m]
    double from = 0, to = 0;      ///< ends of a frustum: their distances from r along the axis [m]
    double cosine = 1, sine = 0;  ///< of the half angle of a cone or frustum, negative if it becomes narrower
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};  ///< velocity of r [m/s], angular velocity [rad/s]
    /// Orientation of a mesh, and of the body frame of the inertia
    EulerParameters<double> p = {1, {0, 0, 0}};
    std::int32_t material = 0;
    std::int32_t flags = 0;  ///< of SurfaceFlag, for a frustum or disk
    /// Number of the boundary of which this one is a part: it moves rigidly with that boundary, and `mass` is
    /// that of the whole body; -1: none. Set by World::set_part().
    std::int32_t body = -1;

    // members of a rigid body boundary
    /// Whether it may translate along x, y, z and rotate about x, y, z. The velocities of the other freedoms
    /// are prescribed.
    std::array<bool, 6> free = {true, true, true, true, true, true};
    /// Explicit padding: the bytes of boundaries are compared and stored.
    std::array<bool, 6> unused{};
    double mass = 0;       ///< [kg]; 0: prescribed motion
    Inertia inertia = {};  ///< about r; zero: omega is prescribed
    Vec3 F = {0, 0, 0};    ///< external force [N]
    Vec3 T = {0, 0, 0};    ///< external torque about r [N m]

    /// Whether loads change omega
    bool rotates_freely() const
    {
        return mass > 0 && !inertia.is_zero() &&
               std::any_of(free.begin() + 3, free.end(), [](bool f) { return f; });
    }
    /// [1/kg]; 0 for prescribed motion
    HILDA_HD float inverse_mass() const { return mass > 0 ? static_cast<float>(1 / mass) : 0; }
};

/// Signed distance of a point from a boundary [m], negative behind the surface, the unit normal at the
/// closest point, which points to the particles, and the mean curvature there [1/m]: half the divergence of
/// n, positive for a surface that is convex towards the particles
struct Nearest {
    double distance;
    Vec3 n;
    double curvature = 0;
};

/// Frustum from r to r + length axis, with the radii at its two ends [m]
inline Boundary frustum(const Vec3& r, const Vec3& axis, double length, double radius, double second_radius)
{
    Boundary b;
    b.shape = Boundary::Shape::frustum;
    b.r = r, b.axis = axis, b.to = length, b.radius = radius, b.second_radius = second_radius;
    const double slant = std::hypot(length, second_radius - radius);
    b.cosine = length / slant, b.sine = (second_radius - radius) / slant;
    return b;
}

namespace detail {

HILDA_HD inline MeridianFrustum meridian_frustum(const Boundary& b)
{
    return {b.radius, b.second_radius, b.from, b.to, b.cosine, b.sine, b.inside != 0, b.flags};
}

/// nearest() of a frustum, disk or torus
HILDA_HD inline Nearest nearest_of_revolution(const Boundary& b, const Vec3& d)
{
    const double z = d.dot(b.axis);
    const Vec3 across = d - z * b.axis;
    const double rho = across.norm();
    MeridianNearest near;
    if (b.shape == Boundary::Shape::frustum)
        near = meridian_frustum(b).nearest(rho, z);
    else if (b.shape == Boundary::Shape::disk)
        near = nearest_on_disk(b.radius, b.flags, rho, z);
    else
        near = nearest_on_torus(b.radius, b.second_radius, b.inside != 0 ? -1 : 1, rho, z);
    return {near.distance, (near.n_rho / (rho > 0 ? rho : 1)) * across + near.n_z * b.axis, near.curvature};
}

}  // namespace detail

/// Closest point of a boundary: point - distance n is on the surface, and n is the gradient of the distance.
///
/// On the axis of a cylinder or cone and at the centre of a sphere the distance is exact and |n| < 1, because
/// the closest point is not unique. Inside a cone, for points behind its apex, the distance is negative but
/// not the true distance. The curvature of a cone is cos(half angle)/(2 ρ) at the distance ρ of the closest
/// point from the axis, and infinite at the apex. For a mesh the distance is no_contact_distance: its
/// triangles are surfaces of their own. The same holds for a frustum or disk without a contact with the
/// point; see MeridianFrustum.
HILDA_HD inline Nearest nearest(const Boundary& b, const Vec3& point)
{
    const Vec3 d = point - b.r;
    const double sign = b.inside != 0 ? -1 : 1;
    switch (b.shape) {
        case Boundary::Shape::plane:
            return {d.dot(b.axis), b.axis};
        case Boundary::Shape::cylinder: {
            const Vec3 across = d - d.dot(b.axis) * b.axis;
            const double rho = across.norm();
            return {sign * (rho - b.radius), (sign / (rho > 0 ? rho : 1)) * across, sign / (2 * b.radius)};
        }
        case Boundary::Shape::cone: {
            const double along = d.dot(b.axis);
            const Vec3 across = d - along * b.axis;
            const double rho = across.norm();
            const Vec3 radial = (1 / (rho > 0 ? rho : 1)) * across;
            // The meridian plane has the generator (sine, cosine). The apex is closest if the projection on
            // it is negative.
            if (along * b.cosine + rho * b.sine < 0 && b.inside == 0) {
                const double from_apex = d.norm();
                return {from_apex, (1 / (from_apex > 0 ? from_apex : 1)) * d, infinite_curvature};
            }
            const double rho_at_surface = b.sine * (along * b.cosine + rho * b.sine);
            return {sign * (rho * b.cosine - along * b.sine), sign * (b.cosine * radial - b.sine * b.axis),
                    sign * (rho_at_surface > 0 ? b.cosine / (2 * rho_at_surface) : infinite_curvature)};
        }
        case Boundary::Shape::sphere:
            break;
        case Boundary::Shape::frustum:
        case Boundary::Shape::disk:
        case Boundary::Shape::torus:
            return detail::nearest_of_revolution(b, d);
        case Boundary::Shape::mesh:
        case Boundary::Shape::none:
            return {no_contact_distance, b.axis};
    }
    const double from_centre = d.norm();
    return {sign * (from_centre - b.radius), (sign / (from_centre > 0 ? from_centre : 1)) * d,
            sign / b.radius};
}

/// Lower bound of the distance of a point from the places of contact with a boundary [m]. It changes by at
/// most 1 m per m, also where nearest() has no contact.
HILDA_HD inline double distance_bound(const Boundary& b, const Vec3& point)
{
    if (b.shape != Boundary::Shape::frustum && b.shape != Boundary::Shape::disk)
        return nearest(b, point).distance;
    const Vec3 d = point - b.r;
    const double z = d.dot(b.axis), rho = (d - z * b.axis).norm();
    return b.shape == Boundary::Shape::disk ? distance_from_disk(b.radius, rho, z)
                                            : detail::meridian_frustum(b).distance_bound(rho, z);
}

/// Whether a sphere of this radius is at least as large as the round boundary that contains it
HILDA_HD inline bool is_larger_than(const Boundary& b, double radius)
{
    if (b.inside == 0) return false;
    if (b.shape == Boundary::Shape::frustum) return !(radius < larger(b.radius, b.second_radius));
    const bool round = b.shape == Boundary::Shape::cylinder || b.shape == Boundary::Shape::sphere ||
                       b.shape == Boundary::Shape::torus;
    return round && !(radius < b.radius);
}

/// Effective radius R* of the contact of a sphere of this radius with a boundary [m]: 1/R* = 1/R + κ with the
/// mean curvature κ of the boundary at the closest point. is_larger_than() must be false.
///
/// At a cone κ is limited to -1/(2 R) ≤ κ ≤ 1/R: a sphere that touches the apex is in contact as with a
/// sphere of its own size, and one that touches the inside of the cone all around has κ = -1/(2 R). The lower
/// limit is also that of a frustum and of the hole of a torus, the upper one that of a frustum with a tip.
HILDA_HD inline double effective_radius(const Boundary& b, double radius, const Nearest& near)
{
    double curvature = near.curvature;
    const bool cone = b.shape == Boundary::Shape::cone, frustum = b.shape == Boundary::Shape::frustum,
               has_tip = cone || (frustum && !(b.radius > 0 && b.second_radius > 0));
    if (has_tip && curvature > 1 / radius) curvature = 1 / radius;
    if ((cone || frustum || b.shape == Boundary::Shape::torus) && curvature < -0.5 / radius)
        curvature = -0.5 / radius;
    return radius / (1 + radius * curvature);
}

/// Largest distance of a point of a finite surface from r [m]; 0 for the others
HILDA_HD inline double extent(const Boundary& b)
{
    switch (b.shape) {
        case Boundary::Shape::sphere:
        case Boundary::Shape::disk:
            return b.radius;
        case Boundary::Shape::torus:
            return b.radius + b.second_radius;
        case Boundary::Shape::frustum:
            return sqrt(larger(b.radius * b.radius + b.from * b.from,
                               b.second_radius * b.second_radius + b.to * b.to));
        default:
            return 0;
    }
}

/// Floor and four side walls of a box that is open at the top: planes through low and high
inline std::array<Boundary, 5> open_box(const Vec3& low, const Vec3& high)
{
    std::array<Boundary, 5> b;
    b[0].r = b[1].r = b[2].r = low, b[3].r = b[4].r = high;
    b[0].axis = {0, 0, 1}, b[1].axis = {1, 0, 0}, b[2].axis = {0, 1, 0};
    b[3].axis = {-1, 0, 0}, b[4].axis = {0, -1, 0};
    return b;
}

HILDA_HD inline bool turns(const Boundary& b) { return b.omega.dot(b.omega) > 0; }

/// Velocity of the point of the rigid boundary that is at `point` [m/s]
HILDA_HD inline Vec3 velocity(const Boundary& b, const Vec3& point)
{
    return b.v + b.omega.cross(point - b.r);
}

}  // namespace hilda::granular
