// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/body_reader.hpp"

#include <cmath>

namespace hilda::dae {

namespace {

/// The inertia of a body, given by three principal moments or by a full matrix
Mat3 inertia(ObjectReader& o)
{
    const Json* v = o.find("inertia");
    const bool full =
        v != nullptr && v->list() != nullptr && !v->list()->empty() && v->list()->front().list() != nullptr;
    return full ? o.matrix("inertia") : Mat3(o.vec3("inertia").asDiagonal());
}

/// The shape of a body: one key with the name of the type, and "axis" for a cylinder or a cone
BodyShape read_shape(ObjectReader& body)
{
    ObjectReader o = body.object("shape");
    BodyShape shape;
    for (const std::string& type : BodyShape::types())
        if (o.find(type) != nullptr) {
            if (!shape.type.empty()) o.exclude(shape.type, type);
            shape.type = type;
        }
    if (shape.type.empty()) {
        o.find("axis");
        o.finish();  // rejects an unknown type
        o.fail("a shape must have one of the keys box, sphere, ellipsoid, cylinder and cone");
    }
    const std::size_t count = BodyShape::count(shape.type);
    if (count == 1)
        shape.dimensions = {o.number(shape.type)};
    else
        shape.dimensions = o.numbers(shape.type, count);
    for (const double x : shape.dimensions)
        if (!(x > 0)) o.fail(shape.type, shape.type + " must have positive dimensions, got " + shortest(x));
    if (BodyShape::has_axis(shape.type)) {
        const std::string axis = o.one_of("axis", {"x", "y", "z"}, "z");
        shape.axis = axis[0] - 'x';
    } else if (o.has("axis")) {
        o.find("axis");
        o.fail("axis", "axis is for a cylinder or a cone, got a " + shape.type);
    }
    body.record("shape", o.finish());
    return shape;
}

}  // namespace

void read_mass(ObjectReader& o, Body& b)
{
    for (const char* key : {"mass", "inertia"}) o.record(key, {});  // their order in the canonical form
    if (o.find("density") != nullptr) {
        o.exclude("mass", "density");
        o.exclude("inertia", "density");
        if (!o.has("shape")) o.fail("density", "density needs a shape");
        const double density = o.positive("density");
        b.shape = read_shape(o);
        b.m = density * b.shape->volume();
        if (!(b.m > 0) || !std::isfinite(b.m))
            o.fail("density",
                   "the mass, density times volume, must be positive and finite, got " + shortest(b.m));
    } else {
        b.m = o.positive("mass");
        if (o.find("shape") != nullptr) b.shape = read_shape(o);
    }
    if (!b.shape || o.has("inertia"))
        b.J_bar = inertia(o);
    else
        b.J_bar = b.shape->inertia(b.m);
    if (!b.shape) return;
    // In the canonical form mass and inertia are given explicitly.
    o.record("mass", b.m);
    if (!o.has("inertia")) o.record("inertia", json(Vec3(b.J_bar.diagonal())));
}

}  // namespace hilda::dae
