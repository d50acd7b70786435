// SPDX-License-Identifier: GPL-3.0-or-later
/// The detectors that make_detector() chooses from.

#pragma once

#include "contact/detection/detector.hpp"

namespace hilda::contact {

/// Pose of a surface in the global frame: origin [m], and axes as the columns of a rotation matrix
struct PlacedShape {
    Vec3 origin;
    Mat3 axes;

    PlacedShape(const Shape& s, const Motion& b) : origin(b.r + b.A * s.position), axes(b.A * s.orientation)
    {}
};

/// The surface of a shape if it is of type S, else nullptr
template <class S>
const S* surface_as(const Shape& shape)
{
    return dynamic_cast<const S*>(shape.surface.get());
}

/// The contact point of bodies i and j from a detector made for the pair j, i: the results are exchanged and
/// n changes its sign. The numbers are bit-identical.
ContactPoint detect_exchanged(const Detector& ji, const Motion& bi, const Motion& bj,
                              const PreviousPoints* from);

/// Whether a surface is that of a bounded convex body without edges that has a support function
bool is_smooth_convex_body(const Surface& s);

// Each function returns a detector for the surfaces in its name, in this order, and nullptr for other
// surfaces.

/// A polytope and a plane. detect() returns the deepest vertex.
std::unique_ptr<Detector> polytope_plane(const Shape& i, const Shape& j);
/// Two polytopes, or a polytope and a ball. detect() returns the deepest point.
std::unique_ptr<Detector> polytope_polytope(const Shape& i, const Shape& j);
/// A polytope and a smooth convex body other than a ball, such as an ellipsoid
std::unique_ptr<Detector> polytope_smooth(const Shape& i, const Shape& j);
std::unique_ptr<Detector> sphere_plane(const Shape& i, const Shape& j);
/// Two spheres, of which one may be concave. InvalidInput unless the sphere is smaller than the concave one.
std::unique_ptr<Detector> sphere_sphere(const Shape& i, const Shape& j);
std::unique_ptr<Detector> foot_plane(const Shape& i, const Shape& j);
std::unique_ptr<Detector> disk_plane(const Shape& i, const Shape& j);
/// Two cylinders with crossing axes. detect() throws NoUniqueContactPoint if the axes are parallel and the
/// cylinders touch.
std::unique_ptr<Detector> cylinder_cylinder(const Shape& i, const Shape& j);
/// Any surface with a support function, and a plane
std::unique_ptr<Detector> support_plane(const Shape& i, const Shape& j);
/// Any two smooth surfaces, by Newton's method
std::unique_ptr<Detector> common_normal(const Shape& i, const Shape& j);

}  // namespace hilda::contact
