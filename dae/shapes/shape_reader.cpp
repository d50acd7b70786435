// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/shapes/shape_reader.hpp"

#include "dae/shapes/convex_hull.hpp"
#include "dae/shapes/point_reader.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::dae {

namespace {

const io::About about_convex = {
    "Convex polyhedron. Its centre of mass must be at the origin of the body frame unless the inertia is "
    "given.",
    R"({"vertices": [[0.1, 0.1, 0.1], [0.1, -0.1, -0.1], [-0.1, 0.1, -0.1], [-0.1, -0.1, 0.1]]})"};

/// The keys of which a shape has one, for the schema
void note_shapes(ObjectReader& o)
{
    constexpr const char* two = R"("$ref": "#/$defs/dimensions", "minItems": 2, "maxItems": 2)";
    constexpr const char* three = R"("$ref": "#/$defs/dimensions", "minItems": 3, "maxItems": 3)";
    o.note("box", three,
           {"Lengths of the sides along x, y and z of the body frame [m].", "[0.2, 0.1, 0.05]"});
    o.note("sphere", "positive", {"Radius [m].", "0.1"});
    o.note("ellipsoid", three, {"Semi-axes along x, y and z of the body frame [m].", "[0.3, 0.2, 0.1]"});
    o.note("cylinder", two, {"Radius and length [m].", "[0.05, 0.2]"});
    o.note("capsule", two,
           {"Radius, and length of the cylindrical part without the half spheres [m].", "[0.05, 0.2]"});
    o.note(
        "cone", two,
        {"Radius of the base and height [m]. The apex is at 3/4 of the height from the centre of mass, along "
         "the axis.",
         "[0.05, 0.2]"});
    o.note("convex", R"("$ref": "#/$defs/convex_shape")", about_convex);
}

/// The corners of the keys "vertices" or "file". A canonical form has "vertices".
std::vector<Vec3> read_corners(ObjectReader& o)
{
    note_mesh_keys(
        o,
        "Path of an OBJ or STL file (text or binary) with the corners, relative to the folder of the "
        "model file and below it, unless --allow-paths is given, instead of vertices. Corners are in a "
        "plane if they are closer to it than a millionth of the size.");
    if (o.find("file") != nullptr) {
        o.exclude("file", "vertices");
        const MeshKeys keys = read_mesh_keys(o);
        std::vector<Vec3> corners;
        try {
            corners = read_mesh_points(keys);
        } catch (const io::InvalidInput& e) {
            o.fail("file", e.what());
        }
        Json::List vertices;
        for (const Vec3& x : corners) vertices.push_back(json(x));
        o.record("vertices", std::move(vertices));
        return corners;
    }
    if (o.has("scale")) o.fail("scale", "scale is for a shape from a file");
    o.given("vertices");  // not required in the schema
    const Eigen::MatrixXd rows =
        read_rows(o, "vertices", 3,
                  {"Corners [m], in any order.",
                   "[[0.1, 0.1, 0.1], [0.1, -0.1, -0.1], [-0.1, 0.1, -0.1], [-0.1, -0.1, 0.1]]",
                   R"("minItems": 4, "items": {"$ref": "#/$defs/vector"})"});
    std::vector<Vec3> corners;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) corners.emplace_back(rows.row(k).transpose());
    return corners;
}

/// Twelve digits of a vector, relative to `size`
Json rounded(const Vec3& v, double size)
{
    const double unit = std::pow(10., 12 - std::ceil(std::log10(size)));
    return json(Vec3(v.unaryExpr([&](double x) { return std::round(x * unit) / unit + 0.; })));
}

/// Refuses a centroid that is not at the origin of the body frame.
void check_centre(const ObjectReader& o, const BodyShape& convex, const Vec3& position)
{
    constexpr double tolerance = 1e-6;
    const Vec3 c = convex.centroid();
    double size = 0;
    for (const Vec3& x : convex.vertices) size = std::max(size, (x - c).norm());
    if (!(c.norm() <= tolerance * size))
        o.fail("the centre of mass of a homogeneous body must be at the origin of the body frame, got " +
               described(rounded(c, size)) + " m; \"position\": " + described(rounded(position - c, size)) +
               " moves it there, which a contact surface with these corners needs as well");
}

BodyShape read_convex(ObjectReader& shape, bool gives_inertia)
{
    ObjectReader o = shape.object("convex", about_convex, "convex_shape");
    o.defines("convex_shape", "Convex shape",
              "Corners of a convex polyhedron, given by vertices or by a file. The keys are also keys of the "
              "contact surface convex.",
              R"("oneOf": [{"required": ["vertices"]}, {"required": ["file"]}], )"
              R"("dependentRequired": {"scale": ["file"]})");
    const bool from_file = o.has("file");
    std::vector<Vec3> corners = read_corners(o);
    const Vec3 position = o.vec3(
        "position", {"Origin of the coordinates of the corners [m], in the body frame.", "[0, 0, -0.1]"},
        Vec3::Zero());
    for (Vec3& x : corners) x += position;
    BodyShape convex;
    try {
        convex = BodyShape::convex(std::move(corners), from_file ? hull_tolerance_of_files : hull_tolerance);
    } catch (const io::InvalidInput& e) {
        o.fail(from_file ? "file" : "vertices", e.what());
    }
    shape.record("convex", o.finish());
    if (gives_inertia) check_centre(o, convex, position);
    return convex;
}

}  // namespace

BodyShape read_shape(ObjectReader& body, bool gives_inertia)
{
    ObjectReader o = body.object(
        "shape",
        {"Shape of the body, with the centre of mass at the origin of the body frame. It is used for the "
         "inertia if no inertia is given, for the mass if a density is given, and for pictures.",
         R"({"box": [0.2, 0.1, 0.05]})"},
        "shape");
    o.defines("shape", "Shape",
              "A solid, given by one of the keys box, sphere, ellipsoid, cylinder, capsule, cone and convex.",
              R"("oneOf": [{"required": ["box"]}, {"required": ["sphere"]}, {"required": ["ellipsoid"]}, )"
              R"({"required": ["cylinder"]}, {"required": ["capsule"]}, {"required": ["cone"]}, )"
              R"({"required": ["convex"]}], "if": {"required": ["axis"]}, "then": {"anyOf": [)"
              R"({"required": ["cylinder"]}, {"required": ["capsule"]}, {"required": ["cone"]}]})");
    note_shapes(o);
    BodyShape shape;
    for (const std::string& type : BodyShape::types())
        if (o.find(type) != nullptr) {
            if (!shape.type.empty()) o.exclude(shape.type, type);
            shape.type = type;
        }
    if (shape.type.empty()) {
        o.find("axis");
        o.finish();  // rejects an unknown type
        o.fail(
            "a shape must have one of the keys box, sphere, ellipsoid, cylinder, capsule, cone and "
            "convex");
    }
    const std::size_t count = BodyShape::count(shape.type);
    if (shape.type == "convex")
        shape = read_convex(o, gives_inertia);
    else if (count == 1)
        shape.dimensions = {o.number(shape.type)};
    else
        shape.dimensions = o.numbers(shape.type, count);
    for (const double x : shape.dimensions)
        if (!(x > 0)) o.fail(shape.type, shape.type + " must have positive dimensions, got " + shortest(x));
    if (BodyShape::has_axis(shape.type)) {
        const std::string axis = o.one_of(
            "axis", {"x", "y", "z"},
            {"Axis of the body frame that is the axis of a cylinder, a capsule or a cone.", R"("x")"}, "z");
        shape.axis = axis[0] - 'x';
    } else if (o.has("axis")) {
        o.find("axis");
        o.fail("axis", "axis is for a cylinder, a capsule or a cone, got a " + shape.type);
    }
    body.record("shape", o.finish());
    return shape;
}

}  // namespace hilda::dae
