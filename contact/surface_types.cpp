// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface_types.hpp"

#include "contact/contact_types.hpp"
#include "contact/tangent_basis.hpp"
#include "io/schema/schema_recorder.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <array>

namespace hilda::contact {

namespace {

const std::vector<std::string> orientations = {"A", "p", "axis_angle", "euler_angles"};

Mat3 read_axes(dae::ObjectReader& o, const std::string& z)
{
    const dae::AboutOrientation about = {
        .A = {"Orientation [-]: the rotation matrix from the surface frame to the body frame. The "
              "orientation may be given in one way only. By default the frames are parallel.",
              "[[0, 0, 1], [1, 0, 0], [0, 1, 0]]"},
        .p = {"Orientation as Euler parameters e0, e1, e2, e3 [-] of length 1, from the surface frame to the "
              "body frame.",
              "[0.8, 0, 0, 0.6]"},
        .axis_angle = {"Orientation as a rotation from the body frame: the components of a unit axis [-] "
                       "followed by the angle in rad.",
                       "[1, 0, 0, 0.5]"},
        .euler_angles = {"Orientation as Euler angles, from the surface frame to the body frame.",
                         R"({"sequence": "zyx", "angles": [0.5, 0, 0]})"}};
    note_orientation(o, about);
    if (z.empty() || o.find(z) == nullptr) return dae::read_orientation(o, about);
    for (const std::string& other : orientations)
        if (o.has(other)) o.fail(other, "the orientation must be given once, got " + z + " and " + other);
    const Vec3 n = o.direction(z).normalized();
    Mat3 axes;
    axes << tangent_basis(n), n;
    return axes + Mat3::Zero();  // turns -0 into 0 for the canonical text
}

void read_pose(dae::ObjectReader& o, const std::string& z, Shape& shape)
{
    shape.position = o.vec3(
        "position", {"Origin of the surface frame [m], in the body frame.", "[0, 0, -0.1]"}, Vec3::Zero());
    if (!z.empty())
        o.note(z, "direction",
               {z == "normal"
                    ? "Outward normal z of the surface frame [-], in the body frame. It replaces A, p, "
                      "axis_angle and euler_angles; the directions of x and y are then arbitrary."
                    : "Axis z of the surface frame [-], in the body frame. It replaces A, p, axis_angle and "
                      "euler_angles; the directions of x and y are then arbitrary.",
                z == "normal" ? "[0, 0, 1]" : "[0, 1, 0]"});
    for (const std::string& orientation : orientations)
        if (!z.empty()) o.note_exclusive(std::array{z, orientation});
    shape.orientation = read_axes(o, z);
}

std::string definition_of(const SurfaceType& type)
{
    std::string name = "surface_" + type.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

}  // namespace

void record_surfaces(io::SchemaRecorder& recorder)
{
    for (const SurfaceType& type : io::Registry<SurfaceType>::all())
        io::record_examples<dae::ObjectReader>(recorder, surface_kind, definition_of(type), type.name,
                                               type.schema, [&](dae::ObjectReader& o) {
                                                   try {
                                                       type.read(o);
                                                   } catch (const lie::InvalidInput&) {
                                                       if (!type.format_only) throw;
                                                   }
                                                   Shape shape;
                                                   read_pose(o, type.z, shape);
                                               });
    // A surface of a type that is not registered has the keys of the pose, and others.
    io::JsonSource source("{}", "pose");
    source.schema = &recorder;
    dae::ObjectReader o(source, source.root, "");
    o.defines("pose", "", "");
    Shape shape;
    read_pose(o, "", shape);
    o.finish();
    recorder.definition("pose")->open = true;
}

bool read_concave(dae::ObjectReader& o)
{
    return o.flag(
        "concave",
        {"If true, the material is outside of the surface and the other body touches it from inside.",
         "true"},
        false);
}

Shape read_shape(dae::ObjectReader& parent, std::string_view key, const io::About& about)
{
    io::Json canonical;
    Shape shape = read_shape(parent, key, about, canonical);
    parent.record(key, std::move(canonical));
    return shape;
}

Shape read_shape(dae::ObjectReader& parent, std::string_view key, const io::About& about, io::Json& canonical)
{
    dae::ObjectReader o = parent.object(key, about, "surface");
    using Types = io::Registry<SurfaceType>;
    const SurfaceType& type = *Types::find(o.one_of("type", Types::names()));
    io::defines_type(o, surface_kind, definition_of(type), type.name, type.schema);
    Shape shape;
    shape.surface = type.read(o);
    read_pose(o, type.z, shape);
    o.record("A", dae::json(shape.orientation));

    canonical = o.finish();
    std::erase_if(std::get<dae::Json::Object>(canonical.value), [&](const dae::Json::Member& k) {
        return k.key == "p" || k.key == "axis_angle" || k.key == "euler_angles" ||
               (k.key == type.z && !type.z.empty());
    });
    return shape;
}

Vec3 read_semi_axes(dae::ObjectReader& o)
{
    Vec3 semi_axes =
        Vec3::Map(o.numbers("semi_axes", 3,
                            {"Semi-axes along x, y and z of the surface frame [m].", "[2.5, 3, 2]",
                             R"("items": {"type": "number", "exclusiveMinimum": 0})"})
                      .data());
    if (!(semi_axes.minCoeff() > 0))
        o.fail("semi_axes", "semi_axes must be positive, got " + dae::described(*o.find("semi_axes")));
    return semi_axes;
}

}  // namespace hilda::contact

template class hilda::io::Registry<hilda::contact::SurfaceType>;
