// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/body_reader.hpp"

#include "dae/shapes/shape_reader.hpp"

#include <cmath>

namespace hilda::dae {

namespace {

/// The inertia of a body, given by three principal moments or by a full matrix
Mat3 inertia(ObjectReader& o)
{
    o.note(
        "inertia",
        R"("anyOf": [{"type": "array", "items": {"type": "number", "exclusiveMinimum": 0}, "minItems": 3, )"
        R"("maxItems": 3}, {"$ref": "#/$defs/matrix"}])",
        {"Inertia tensor about the centre of mass [kg m^2], in the body frame: the three principal moments "
         "if the axes of the body frame are principal axes, otherwise the full symmetric matrix. The "
         "principal moments must satisfy the triangle inequality. It is required unless a shape is given; "
         "the inertia is then that of a homogeneous body of this shape.",
         "[0.4, 0.4, 0.1], [[0.4, 0.01, 0], [0.01, 0.4, 0], [0, 0, 0.1]]"});
    const Json* v = o.find("inertia");
    const bool full =
        v != nullptr && v->list() != nullptr && !v->list()->empty() && v->list()->front().list() != nullptr;
    return full ? o.matrix("inertia") : Mat3(o.vec3("inertia").asDiagonal());
}

}  // namespace

Motion read_motion(ObjectReader& o)
{
    Motion m;
    m.r = o.vec3("r", {"Initial position r of the centre of mass [m], in the global frame.", "[0, 0, 0.5]"});
    m.A = read_orientation(
        o,
        {.A = {"Initial orientation A [-]: the rotation matrix from the body frame to the global frame. "
               "At most one of A, p, axis_angle and euler_angles may be given. If none is given, the "
               "body frame is parallel to the global frame. The matrix must be orthogonal to within "
               "1e-6; smaller errors are corrected.",
               "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]"},
         .p = {"Initial orientation as Euler parameters e0, e1, e2, e3 [-] from the body frame to the "
               "global frame; e0 is the scalar part. The length must be 1 to within 1e-6.",
               "[0.8, 0, 0, 0.6]"},
         .axis_angle = {"Initial orientation as a rotation from the global frame: the components ux, uy, uz "
                        "of a unit axis [-] followed by the angle in rad. The length of the axis must be 1 "
                        "to within 1e-6.",
                        "[0, 0, 1, 1.5707963267948966]"},
         .euler_angles = {"Initial orientation as Euler angles, from the body frame to the global frame.",
                          R"({"sequence": "zxz", "angles": [0.5, 1.2, 0]})"}});
    o.record("A", json(m.A));
    m.rdot =
        o.vec3("r_dot", {"Initial velocity of the centre of mass [m/s], in the global frame.", "[0, 1, 0]"},
               Vec3::Zero());
    m.omega_bar = o.vec3("omega", {"Initial angular velocity [rad/s], in the body frame.", "[0, 0, 6.28]"},
                         Vec3::Zero());
    return m;
}

void read_mass(ObjectReader& o, Body& b)
{
    for (const char* key : {"mass", "inertia"}) o.record(key, {});  // their order in the canonical form
    if (o.find("density") != nullptr) {
        o.exclude("mass", "density");
        o.exclude("inertia", "density");
        if (!o.has("shape")) o.fail("density", "density needs a shape");
        const double density = o.positive(
            "density",
            {"Density [kg/m^3] of a homogeneous body, instead of mass and inertia. It needs a shape.",
             "7850"});
        b.shape = read_shape(o, true);
        b.m = density * b.shape->volume();
        if (!(b.m > 0) || !std::isfinite(b.m))
            o.fail("density",
                   "the mass, density times volume, must be positive and finite, got " + shortest(b.m));
    } else {
        b.m = o.positive("mass", {"Mass m [kg]. It is required unless shape and density are given.", "1.5"});
        if (o.find("shape") != nullptr) b.shape = read_shape(o, !o.has("inertia"));
    }
    if (!b.shape || o.has("inertia"))
        b.J_bar = inertia(o);
    else
        b.J_bar = b.shape->inertia(b.m);
    if (!b.shape) return;
    // In the canonical form mass and inertia are given explicitly.
    o.record("mass", b.m);
    if (o.has("inertia")) return;
    const Vec3 moments = b.J_bar.diagonal();
    o.record("inertia", b.J_bar == Mat3(moments.asDiagonal()) ? json(moments) : json(b.J_bar));
}

}  // namespace hilda::dae
