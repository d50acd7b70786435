// SPDX-License-Identifier: GPL-3.0-or-later
/// Templates of clumps: spheres and mass properties.

#pragma once

#include "granular/clumps/sphere_union.hpp"
#include "granular/core/clump.hpp"

#include <array>
#include <string>
#include <vector>

namespace hilda::granular {

/// A rigid body of spheres, which may overlap, in a frame of its own
struct ClumpTemplate {
    static constexpr std::size_t most_spheres = 256;

    std::string name;
    std::vector<Sphere> spheres;
    int material = 0;         ///< index into the materials of the world
    double mass = 0;          ///< [kg]
    double volume = 0;        ///< of the union of the spheres [m³]; only fields use it
    Vec3 centre = {0, 0, 0};  ///< of mass [m]
    Inertia inertia = {};     ///< about the centre of mass [kg m²]

    /// Radius of the sphere around the centre of mass that contains all spheres [m]
    double bounding_radius() const;
    /// The spheres of a clump with the centre of mass r [m], the Euler parameters e of the rotation from the
    /// frame of the template, and all lengths multiplied by the scale
    std::vector<Sphere> placed(const Vec3& r, const std::array<double, 4>& e, double scale) const;
    /// Throws io::InvalidInput "clump 'NAME': ..." if there is no sphere or too many, for a sphere or mass
    /// properties that are not finite or not positive, and for an inertia that no body has.
    void check() const;
};

/// Throws io::InvalidInput if there is no sphere or too many, or if one is invalid.
void check_spheres(const std::vector<Sphere>& spheres, const std::string& where);

/// The template with mass, centre and inertia of a homogeneous body: the union of the spheres. Throws
/// io::InvalidInput.
ClumpTemplate solid_clump(const std::string& name, const std::vector<Sphere>& spheres, double density,
                          int material = 0);

/// Principal moments of inertia J_1, J_2, J_3, and the rotation from the principal frame to that of J. The
/// frame of J is kept if J is diagonal.
struct PrincipalInertia {
    Vec3 moment;  ///< [kg m²]
    EulerParameters<double> axes;
};
PrincipalInertia principal_inertia(const Inertia& J);

}  // namespace hilda::granular
